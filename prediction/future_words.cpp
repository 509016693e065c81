// Names and sentences of what robot_future.hpp says.
#include <fmt/core.h>

#include "prediction/robot_future.hpp"

namespace foresight {

const char* to_string(HistoryFault fault) {
  switch (fault) {
    case HistoryFault::none: return "none";
    case HistoryFault::wrong_joint_count: return "not as many joints as the robot has";
    case HistoryFault::not_finite: return "a position, velocity or speed that is no finite number";
    case HistoryFault::out_of_order: return "not later than the one before";
    case HistoryFault::other_clock: return "an instant far from now: of another clock, or of another day";
  }
  return "";
}

std::string to_rig_key(const ResponseFigures& figures) {
  return fmt::format("response: {{dead_time_s: {:.4f}, lag_s: {:.4f}, sigma_s: {:.4f}}}", figures.dead_time,
                     figures.lag, figures.delay_sigma);
}

std::string to_words(const PredictedRobot& robot, std::span<const std::string> names) {
  const auto index = static_cast<std::size_t>(robot.joint);
  const std::string joint = robot.joint >= 0 && index < names.size() ? "joint '" + names[index] + "'" : "the robot";
  switch (robot.reason) {
    case FutureReason::none: return "";
    case FutureReason::no_state: return "nothing came of the robot yet: what is shown is no robot";
    case FutureReason::stale:
      return fmt::format("nothing new comes of {}: shown as last measured; look at the line", joint);
    case FutureReason::not_ready:
      return "the robot does not follow set-points (disabled, enabling or homing): shown as last measured";
    case FutureReason::strangers: return "the robot follows somebody else's set-points: shown as last measured";
    case FutureReason::too_far:
      return fmt::format("what is sent now acts earlier than the instant asked for: {} is shown as last measured",
                         joint);
    case FutureReason::hole: return "no state came about that instant: shown as last measured";
    case FutureReason::astray:
      return fmt::format(
          "{} is not where its set-points put it (contact, load, drift): shown as last measured; let go, "
          "and look",
          joint);
    case FutureReason::unsure:
      return fmt::format("{} cannot be predicted well enough to be of use yet: shown as last measured", joint);
  }
  return "";
}

}  // namespace foresight
