#include "display/head/session_steps.hpp"

#include <utility>

namespace foresight::head {

const char* to_string(SessionState state) noexcept {
  switch (state) {
    case SessionState::unknown: return "unknown";
    case SessionState::idle: return "idle";
    case SessionState::ready: return "ready";
    case SessionState::synchronized: return "synchronized";
    case SessionState::visible: return "visible";
    case SessionState::focused: return "focused";
    case SessionState::stopping: return "stopping";
    case SessionState::loss_pending: return "loss pending";
    case SessionState::exiting: return "exiting";
  }
  return "";
}

SessionStep SessionSteps::take(SessionState next) noexcept {
  state_ = next;
  switch (next) {
    case SessionState::ready: return std::exchange(running_, true) ? SessionStep::none : SessionStep::begin;
    case SessionState::stopping: return std::exchange(running_, false) ? SessionStep::end : SessionStep::none;
    case SessionState::loss_pending: running_ = false; return SessionStep::leave;
    case SessionState::exiting: running_ = false; return SessionStep::quit;
    default: return SessionStep::none;
  }
}

}  // namespace foresight::head
