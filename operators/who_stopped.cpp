#include "operators/who_stopped.hpp"

#include "common/text.hpp"
#include "operators/follow_operator.hpp"
#include "operators/key_operator.hpp"
#include "operators/line_operator.hpp"
#include "operators/station_operator.hpp"

namespace foresight {

std::string who_stopped(const RobotStatus& status, const std::string& line_stopper) {
  const bool stopped = status.phase == RobotPhase::stopped && status.gate.reason == GateReason::emergency_stop;
  if (!stopped || status.last_request.what != RobotRequest::emergency_stop) return "";
  switch (status.last_request.operator_id) {
    case KeyOperator::kId: return "asked for by a key of the robot's console";
    case LineOperator::kId:
      return "asked for over the line" + (line_stopper.empty() ? "" : " by " + in_quotes(line_stopper));
    case FollowOperator::kId: return "asked for by what follows a file";
    case StationOperator::kId: return "asked for by a calibration";
  }
  return "";
}

std::string name_and_who(const std::string& name, const RobotStatus& status, const std::string& line_stopper) {
  const std::string who = who_stopped(status, line_stopper);
  return who.empty() ? name : name + " (" + who + ")";
}

}  // namespace foresight
