// Frames for tests.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <random>
#include <string>

#include "drivers/can/can_frame.hpp"

namespace foresight {

inline CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes = {}) {
  CanFrame out;
  out.id = id;
  for (const std::uint8_t b : bytes) out.data[out.size++] = b;
  return out;
}

inline std::uint32_t below(std::mt19937& random, std::uint32_t limit) {
  return random() % limit;
}

/// Any frame that can be on a bus: classic or FD, remote, 11 or 29 bits. Half of them with data that needs many stuff
/// bits.
inline CanFrame random_frame(std::mt19937& random) {
  constexpr std::uint8_t kSizes[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  CanFrame out;
  out.extended = below(random, 2) != 0;
  out.id = random() & (out.extended ? 0x1fffffff : 0x7ff);
  out.fd = below(random, 2) != 0;
  out.remote = !out.fd && below(random, 5) == 0;
  out.bit_rate_switch = out.fd && below(random, 2) != 0;
  out.size = kSizes[below(random, out.fd ? 16 : 9)];
  if (out.remote) return out;
  const bool runs = below(random, 2) != 0;
  for (std::size_t i = 0; i < out.size; ++i)
    out.data[i] = static_cast<std::uint8_t>(!runs ? random() : below(random, 2) ? 0x00 : 0xff);
  return out;
}

inline bool same(const CanFrame& a, const CanFrame& b) {
  return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.error == b.error && a.fd == b.fd &&
         a.bit_rate_switch == b.bit_rate_switch && a.size == b.size && a.data == b.data;
}

/// A file in the system's folder for such, removed with its life's end.
class TempFile {
 public:
  explicit TempFile(const std::string& text = {}) {
    std::string name = (std::filesystem::temp_directory_path() / "foresight-can-XXXXXX").string();
    const int fd = mkstemp(name.data());
    if (fd >= 0) close(fd);
    path_ = name;
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TempFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string read() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  std::filesystem::path path_;
};

}  // namespace foresight
