// Damaged messages, for fuzzing.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

namespace foresight {

/// Inputs of each kind: FORESIGHT_FUZZ_RUNS.
inline int fuzz_runs() {
  const char* set = std::getenv("FORESIGHT_FUZZ_RUNS");
  return set ? std::atoi(set) : 1000;
}

/// One bit, byte, count, length or stretch of it is another.
inline void mutate(std::vector<std::uint8_t>& bytes, std::mt19937& random) {
  const auto at = [&] { return bytes.empty() ? 0 : random() % bytes.size(); };
  if (bytes.empty()) return;
  switch (random() % 6) {
    case 0: bytes[at()] ^= static_cast<std::uint8_t>(1u << random() % 8); break;
    case 1: bytes[at()] = static_cast<std::uint8_t>(random()); break;
    case 2: bytes.resize(at()); break;
    case 3:
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at()), random() % 16, std::uint8_t(random()));
      break;
    case 4: {  // a count or a number of its own
      const std::uint32_t values[] = {
          0, 1, 0xFFFFFFFF, 0x7FFFFFFF, 0x10000000, 0x7FF00000, static_cast<std::uint32_t>(random())};
      const std::size_t place = at() / 4 * 4;
      if (place + 4 <= bytes.size()) std::memcpy(&bytes[place], &values[random() % std::size(values)], 4);
      break;
    }
    case 5: std::swap(bytes[at()], bytes[at()]); break;
  }
}

}  // namespace foresight
