#include "operators/robot_start.hpp"

#include <utility>

namespace foresight {
namespace {

constexpr Duration kEnabledWithin = std::chrono::seconds(20);

}  // namespace

RobotStart::Progress RobotStart::ask(RobotRequest request) {
  return {.request = std::exchange(asked_, true) ? RobotRequest::none : request};
}

RobotStart::Progress RobotStart::tick(RobotTime now, const RobotStatus& status) {
  if (!since_) since_ = now;
  if (status.phase == RobotPhase::ready) {
    if (status.all_homed) return {.ready = true};
    if (step_ == Step::enable) {
      step_ = Step::home;
      asked_ = false;
      return {};
    }
  }
  if (step_ == Step::home) {
    if (!may_home_) return {.failure = "not all joints are homed; give --home to let them look for home, slowly"};
    return ask(RobotRequest::home);
  }
  if (now - *since_ > kEnabledWithin) return {.failure = "the drives were not enabled in time"};
  return ask(RobotRequest::enable);
}

}  // namespace foresight
