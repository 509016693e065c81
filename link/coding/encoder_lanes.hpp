// Which lane (pair_coder.hpp) each pair goes into, and what it builds on there.
#pragma once

#include <array>

#include "link/coding/pair_coder.hpp"

namespace foresight {

/// A lane is given up once another has a pair that was captured so much later: one that was needed once takes 20 MB at
/// 640x480 at the robot's side and 5 MB at the operator's, and would be kept for good. Longer than pairs are on any
/// line's way.
constexpr Duration kLaneRests = std::chrono::seconds(4);

/// Whether a lane whose newest pair was captured at `own` is given up, the newest of all at `newest`. Of any instants.
constexpr bool lane_rests(RobotTime own, RobotTime newest) {
  return newest > own && static_cast<std::uint64_t>(newest.ns) - static_cast<std::uint64_t>(own.ns) >
                             static_cast<std::uint64_t>(kLaneRests.count());
}

/// A plain value; one thread.
class EncoderLanes {
 public:
  struct Place {
    std::size_t lane = 0;         ///< below kMostLanes
    std::uint32_t reference = 0;  ///< the pair that it builds on; 0: the lane begins anew
  };
  /// The lane of the newest pair that may be built on, else one that has to begin anyway, else that of the newest that
  /// is on its way.
  Place place(const PairWish& wish) const;
  /// It has to begin anew, as it rests: what codes it is not needed any more.
  bool rests(std::size_t lane) const { return lane_rests(lanes_[lane].captured, newest_); }
  /// This pair is the lane's newest now.
  void coded(std::size_t lane, std::uint32_t number, RobotTime captured);
  void arrived(std::uint32_t number);  ///< as of PairEncoder
  void gone(std::uint32_t number);     ///< as of PairEncoder
  void begin_anew();                   ///< as of PairEncoder

 private:
  struct Lane {
    std::uint32_t number = 0;  // of the last pair
    RobotTime captured;
    bool arrived = false;  // the receiver has it
    bool broken = true;    // has to begin anew
  };
  std::array<Lane, kMostLanes> lanes_;
  RobotTime newest_;  // captured, of all
};

}  // namespace foresight
