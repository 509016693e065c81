#include "operators/key_operator.hpp"

#include <algorithm>
#include <utility>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kKeyHeldFor = 600ms;  // terminals begin to repeat a key after up to half a second
constexpr double kJogSpeed = 0.3;        // share of the joint's velocity

}  // namespace

KeyOperator::KeyOperator(std::vector<GateJoint> joints, Rights rights) : joints_(std::move(joints)), rights_(rights) {}

const char* KeyOperator::help() {
  return "e enable  h home  1-9 0 joint  +/- move (hold)  space STOP  r reset  c configure anew  d disable  q quit";
}

RobotRequest KeyOperator::request_for(char key) {
  const bool consents = std::exchange(consent_, key == 'h');
  switch (key) {
    case 'e': return RobotRequest::enable;
    case 'd': return RobotRequest::disable;
    case 'r': return RobotRequest::reset;
    case 'c': return RobotRequest::set_up;
    case ' ': return RobotRequest::emergency_stop;
    case 'y': return consents ? RobotRequest::home : RobotRequest::none;
    default: return RobotRequest::none;
  }
}

void KeyOperator::jog(int direction, RobotTime now) {
  direction_ = direction;
  jogged_ = now;
}

void KeyOperator::press_one(char key, RobotTime now, OperatorWish& wish) {
  if (rights_ == Rights::only_stops && key != ' ' && key != 'q') return;
  if (const RobotRequest request = request_for(key);
      request != RobotRequest::none && wish.request != RobotRequest::emergency_stop)
    wish.request = request;
  if (key == 'q') wish.quit = true;
  if (key == '+' || key == '=') jog(1, now);
  if (key == '-') jog(-1, now);
  if (key < '0' || key > '9') return;
  const std::size_t joint = key == '0' ? 9 : static_cast<std::size_t>(key - '1');
  if (joint >= joints_.size()) return;
  selected_ = joint;
  direction_ = 0;
}

OperatorWish KeyOperator::tick(RobotTime now, const RobotStatus& status) {
  OperatorWish wish;
  for (const char key : std::exchange(keys_, {})) press_one(key, now, wish);
  if (rights_ == Rights::drives && status.phase == RobotPhase::ready)
    wish.command = command(now, status);
  else
    engaged_ = false;
  last_tick_ = now;
  return wish;
}

MotionCommand KeyOperator::command(RobotTime now, const RobotStatus& status) {
  const bool held = direction_ != 0 && now - jogged_ < kKeyHeldFor;
  // Starts from where the robot stands, each time anew.
  if (!held || !engaged_)
    for (std::size_t i = 0; i < joints_.size(); ++i) target_[i] = status.set_point[i].position;
  if (held && engaged_) {
    const JointLimits& limits = joints_[selected_].limits;
    const double step = direction_ * kJogSpeed * limits.velocity * std::min(0.1, to_seconds(now - last_tick_));
    // Not far ahead of the robot: it must stop soon after the key is released.
    const double ahead = 0.2 * limits.velocity, here = status.set_point[selected_].position;
    target_[selected_] = std::clamp(std::clamp(target_[selected_] + step, here - ahead, here + ahead),
                                    limits.min_position, limits.max_position);
  }
  const bool was_engaged = std::exchange(engaged_, held);  // the switch is seen open for a tick first
  return counter_.command(now, held && was_engaged, joints_.size(), target_);
}

}  // namespace foresight
