#include "input/hand_watch.hpp"

#include <algorithm>

#include "common/rotation.hpp"
#include "prediction/arm_chain.hpp"

namespace foresight {
namespace {

constexpr double kRigid = 3e-3;  // of a rotation matrix whose quaternion has the three decimals of recordings

}  // namespace

HandFault HandWatch::of_time(OperatorTime now, const TrackerState& state) noexcept {
  if (!state.connected) {
    newest_.reset();
    return HandFault::device_gone;
  }
  // Compared, not subtracted: an instant of another clock may be any number.
  if (state.time > now + options_.ahead || state.time < now - options_.other_clock) return HandFault::wrong_clock;
  // What comes out of order tells nothing new.
  newest_ = newest_ ? std::max(*newest_, state.time) : state.time;
  return now - *newest_ > options_.frozen_after ? HandFault::frozen : HandFault::none;
}

bool HandWatch::jumps(OperatorTime time, const Pose& pose) const noexcept {
  if (!seen_) return false;
  const Vector6 step = pose_difference(seen_->pose, pose);
  const double way = step.head<3>().norm(), turn = step.tail<3>().norm(), passed = to_seconds(time - seen_->time);
  return (way > options_.least_jump && way > options_.fastest * passed) ||
         (turn > 4 * options_.least_jump && turn > options_.fastest_turn * passed);
}

HandWatch::Verdict HandWatch::judge(OperatorTime now, const TrackerState& state) noexcept {
  Verdict out;
  out.buttons = out.pose = of_time(now, state);
  if (out.pose == HandFault::none && !state.tracked) out.pose = HandFault::tracking_lost;
  if (out.pose == HandFault::none && !is_rigid(state.T_space_hand, kRigid)) out.pose = HandFault::bad_pose;
  if (out.pose != HandFault::none) return out;
  const bool later = !seen_ || state.time > seen_->time;
  if (!later) return out;
  if (jumps(state.time, state.T_space_hand)) out.pose = HandFault::jumped;
  out.news = out.pose == HandFault::none;
  seen_ = Seen{state.time, state.T_space_hand};
  return out;
}

}  // namespace foresight
