// What a program has to do when an OpenXR runtime says that its session is in another state: pure logic.
//
//   idle -> ready --begin--> synchronized <-> visible <-> focused
//    ^                            |
//    '---- (ended) <--end-- stopping        from anywhere: loss_pending --> leave;  from idle: exiting --> quit
//
// After the OpenXR 1.0 specification, section 9.3 (session lifecycle).
#pragma once

#include <cstdint>

namespace foresight::head {

enum class SessionState : std::uint8_t {
  unknown,
  idle,          ///< the headset lies on the table, or the runtime is not ready yet
  ready,         ///< wants frames
  synchronized,  ///< takes frames, and shows nothing of them
  visible,       ///< shows them; controllers are somebody else's: a menu of the runtime's
  focused,       ///< shows them, and controllers are ours
  stopping,      ///< wants no more frames
  loss_pending,  ///< the runtime or the headset goes away
  exiting,       ///< somebody ended us in the runtime's menu
};
inline constexpr int kSessionStates = 9;
const char* to_string(SessionState state) noexcept;

enum class SessionStep : std::uint8_t {
  none,
  begin,  ///< xrBeginSession, frames from now on
  end,    ///< xrEndSession, no frames from now on
  leave,  ///< destroy the session; another may be made
  quit    ///< destroy the session; nobody wants another
};

/// One thread.
class SessionSteps {
 public:
  /// The runtime says so. What is to be done now: never `begin` twice without an `end` between, nor the other way
  /// round, whatever the runtime says.
  SessionStep take(SessionState next) noexcept;

  SessionState state() const noexcept { return state_; }
  /// Between begin and end: xrWaitFrame is to be called.
  bool running() const noexcept { return running_; }
  bool visible() const noexcept { return state_ == SessionState::visible || state_ == SessionState::focused; }
  bool focused() const noexcept { return state_ == SessionState::focused; }

 private:
  SessionState state_ = SessionState::unknown;
  bool running_ = false;
};

}  // namespace foresight::head
