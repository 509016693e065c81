// What can go wrong on an in-process CAN bus, from a seed.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace foresight {

/// Probabilities are per frame, and where noted per frame and receiver, 0 .. 1. The default is a perfect bus.
struct CanFaults {
  std::uint64_t seed = 1;  ///< same seed, same frames, same clock: same faults
  double loss = 0;         ///< a receiver never sees the frame (its buffer was full)
  double duplicate = 0;    ///< a receiver sees it twice, as after an error in the last bit of the frame's end
  double reorder = 0;      ///< a receiver sees it `reorder_by` late, after frames that were sent later
  double error_frame = 0;  ///< the frame is destroyed on the wire, all get an error frame, it is sent again
  double bus_off = 0;      ///< its sender goes bus-off, and the frame is lost
  Duration delay_min{0}, delay_max{0};                 ///< per receiver, uniform between the two; keeps the order
  Duration reorder_by = std::chrono::milliseconds(2);  ///< > 0
  Duration recovery = std::chrono::milliseconds(100);  ///< from bus-off to active again; 0: only by restart()

  bool any() const;
  /// Throws InputError naming the field and its value.
  void validate() const;
};

/// Small, fast and the same everywhere (SplitMix64, Steele, Lea and Flood 2014).
class FaultDice {
 public:
  explicit FaultDice(std::uint64_t seed) : state_(seed) {}
  /// 0 <= value < 1.
  double roll() noexcept {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  /// Does not roll where it cannot happen, so that adding a kind of fault leaves the others' sequence alone.
  bool happens(double probability) noexcept { return probability > 0 && roll() < probability; }

 private:
  std::uint64_t state_;
};

}  // namespace foresight
