#include "link/control/control_words.hpp"

namespace foresight {

ControlWords words_for(RestCause cause) {
  constexpr const char* kAnew = "let go of the switch and press it again";
  switch (cause) {
    case RestCause::none: return {"", ""};
    case RestCause::nobody: return {"nobody commands over the line", "ask for control"};
    case RestCause::granted: return {"control was granted", "press the switch"};
    case RestCause::let_go: return {"the switch is open", "press the switch"};
    case RestCause::expired: return {"no set-point came in time", kAnew};
    case RestCause::paused: return {"the robot's program stood still for a moment", kAnew};
    case RestCause::clock_jumped: return {"the clock of one of the hosts has jumped", kAnew};
    case RestCause::blind: return {"the operator's side has not seen the robot for a while", kAnew};
    case RestCause::robot_stopped: return {"the robot no longer follows", "see its state; then press the switch again"};
  }
  return {"", ""};
}

ControlWords words_for(SetPointFault fault) {
  switch (fault) {
    case SetPointFault::none: return {"", ""};
    case SetPointFault::no_lease: return {"a set-point came without the lease", "ask for control"};
    case SetPointFault::out_of_order: return {"a set-point came out of order", ""};
    case SetPointFault::malformed:
      return {"a set-point has too few joints, or no numbers", "give both sides the same rig file"};
    case SetPointFault::clock_unknown: return {"the operator's clock is not known yet", "wait for a round trip"};
    case SetPointFault::from_the_future: return {"a set-point came from the future", "wait until the clocks agree"};
    case SetPointFault::expired: return {"a set-point came too late", "see the line's delay"};
    case SetPointFault::no_consent:
      return {"the switch was pressed before the stop was known", "let go of the switch and press it again"};
    case SetPointFault::not_let_go: return {"the switch was not seen open", "let go of the switch for a moment"};
    case SetPointFault::elsewhere:
      return {"the set-point is not where the robot stands", "begin where it stands, and press the switch again"};
    case SetPointFault::robot_is_busy: return {"the robot is not ready to follow", "see its state"};
  }
  return {"", ""};
}

ControlWords words_for(RequestOutcome outcome) {
  switch (outcome) {
    case RequestOutcome::taken: return {"taken", ""};
    case RequestOutcome::expired: return {"the request came too late, and was not followed", "ask again"};
    case RequestOutcome::overtaken: return {"a later request came first; this one was not followed", "ask again"};
    case RequestOutcome::not_holder: return {"only who holds the lease may ask that", "ask for control"};
    case RequestOutcome::before_stop:
      return {"the request was made before the robot's stop was known", "look at its state, and ask again"};
  }
  return {"", ""};
}

const char* to_string(LineRequest request) {
  switch (request) {
    case LineRequest::none: return "none";
    case LineRequest::enable: return "enable";
    case LineRequest::disable: return "disable";
    case LineRequest::home: return "home";
    case LineRequest::reset: return "reset";
    case LineRequest::set_up: return "set up";
    case LineRequest::emergency_stop: return "emergency stop";
  }
  return "";
}

}  // namespace foresight
