#include "operators/line_operator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight {
namespace {

static_assert(kMostLineJoints >= kMostJoints);

constexpr double kReach = 0.25;  // seconds at the joint's largest velocity: what a line may lose of a motion's begin

RobotRequest request_of(LineRequest request) {
  switch (request) {
    case LineRequest::none: return RobotRequest::none;
    case LineRequest::enable: return RobotRequest::enable;
    case LineRequest::disable: return RobotRequest::disable;
    case LineRequest::home: return RobotRequest::home;
    case LineRequest::reset: return RobotRequest::reset;
    case LineRequest::set_up: return RobotRequest::set_up;
    case LineRequest::emergency_stop: return RobotRequest::emergency_stop;
  }
  return RobotRequest::none;
}

/// What ended the motion is that the lease began or ended.
bool is_of_lease(RestCause cause) {
  return cause == RestCause::granted || cause == RestCause::nobody;
}

}  // namespace

LineOperator::LineOperator(const GateOptions& options, ControlDeskOptions desk)
    : joints_(options.joints), command_age_(seconds(options.command_age_s)), desk_(std::move(desk)) {}

RobotView LineOperator::view(const RobotStatus& status) const {
  RobotView out;
  out.joints = joints_.size();
  out.ready = status.phase == RobotPhase::ready && status.all_homed && status.gate.state == GateState::idle;
  out.follows = status.gate.state == GateState::following && status.gate.operator_id == kId;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    out.measured[i] = status.feedback[i].position;
    out.set_point[i] = status.set_point[i].position;
    // A gripper stands where what it holds stops it: its grip is in the set-point.
    out.begin[i] = joints_[i].keeps_grip || !std::isfinite(out.measured[i]) ? out.set_point[i] : out.measured[i];
    out.reach[i] = kReach * joints_[i].limits.velocity;
  }
  return out;
}

MotionCommand LineOperator::command(RobotTime now, bool deadman, const LinePositions& position) {
  JointValues values{};
  std::copy_n(position.begin(), joints_.size(), values.begin());
  return counter_.command(now, deadman, joints_.size(), values);
}

/// As if the switch were held: the gate stops, and wants to see it open. What came before is of an older session.
MotionCommand LineOperator::begin_session(RobotTime now, const RobotStatus& status) {
  counter_ = CommandCounter(kId);
  return command(now, true, view(status).set_point);
}

OperatorWish LineOperator::tick(RobotTime now, const RobotStatus& status) {
  const RobotView robot = view(status);
  desk_.advance(now, robot);
  OperatorWish wish;
  wish.request = request_of(desk_.take_request());
  const LineMotion motion = desk_.motion(now);
  const bool lost = motion.what == LineMotion::What::nothing && robot.follows;
  if (std::exchange(round_, motion.round) != motion.round || lost) {
    wish.command = begin_session(now, status);
    wish.command->handed_over = is_of_lease(desk_.permit().cause());
  } else if (motion.what == LineMotion::What::open) {
    wish.command = command(now, false, robot.set_point);
  } else if (motion.what == LineMotion::What::follow) {
    wish.command = command(now, true, motion.position);
    wish.command->time = std::min(now, motion.until - command_age_);
  }
  return wish;
}

}  // namespace foresight
