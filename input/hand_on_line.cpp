#include "input/hand_on_line.hpp"

#include <algorithm>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kSeenWithin = 500ms;  // a state, or nothing is known of the robot

}  // namespace

HandRobot hand_robot(const ControlSeat& seat, OperatorTime now) {
  using Phase = ControlSeatStatus::Phase;
  const ControlSeatStatus status = seat.status(now);
  const ControlState& state = seat.state();
  HandRobot out;
  const bool seen = status.phase != Phase::connecting && status.state_age && *status.state_age <= kSeenWithin;
  if (!seen || state.joints > kMostJoints) return out;
  out.joints = state.joints;
  std::copy_n(seat.begin().begin(), out.joints, out.begin.begin());
  out.ready = status.phase == Phase::holding && state.ready;
  out.follows = status.follows;
  out.must_let_go = status.must_let_go;
  return out;
}

}  // namespace foresight
