// What the gate remembers of each operator.
#pragma once

#include <array>
#include <cstdint>

namespace foresight {

/// One operator: what was last heard of it, and whether its switch was seen open.
struct OperatorRecord {
  std::uint64_t id = 0;       ///< 0: none
  std::uint64_t session = 0;  ///< the newest
  std::uint64_t sequence = 0;
  bool released = false;    ///< its deadman was seen open since it last had to let go
  std::uint64_t heard = 0;  ///< grows; the least recently heard is forgotten first
};

/// Of the last few operators. One thread; does not allocate.
class OperatorRecords {
 public:
  static constexpr std::size_t kMost = 8;
  /// That of operator `id`, a new one if there is none: then the least recently heard is forgotten, but never `keep`.
  OperatorRecord& of(std::uint64_t id, std::uint64_t keep) noexcept;
  /// All must show their switch open anew.
  void forget_released() noexcept;

 private:
  std::array<OperatorRecord, kMost> records_{};
  std::uint64_t heard_ = 0;
};

}  // namespace foresight
