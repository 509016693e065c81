// The robot's side of control over the line: who may command, and what the robot is to do now.
//
// One operator at a time holds the lease. Another one that asks is told who; it gets the lease when the holder gives it
// back or hands it over, when somebody beside the robot says so, or when the holder has not been heard for two seconds.
// The lease alone moves nothing: see MotionPermit.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "link/control/desk_peers.hpp"
#include "link/control/messages.hpp"
#include "link/control/motion_permit.hpp"

namespace foresight {

struct ControlDeskOptions {
  Identity identity;  ///< the robot's
  SetPointLifeOptions life;
  Duration state_every = std::chrono::milliseconds(20);  ///< and at once when consent changes
  DrawNonce draw;
};

/// What has come, and what of it was not followed.
struct DeskCounts {
  std::uint64_t followed = 0;
  std::array<std::uint64_t, 11> faults{};  ///< by SetPointFault
  std::uint64_t strangers = 0;             ///< messages of nobody known: an earlier start, a recording
};

/// Pure logic: does not wait, speaks to no device. One thread. Whatever comes may be wrong, old, or somebody else's.
class ControlDesk {
 public:
  static constexpr Duration kLease = std::chrono::seconds(2);        ///< without a word of the holder
  static constexpr Duration kRequestLife = std::chrono::seconds(1);  ///< beside a slow line's allowed delay

  explicit ControlDesk(ControlDeskOptions options);

  void receive(const FromOperator& message, RobotTime now);
  /// Every 10 ms or so, with the robot as it is; a hundred milliseconds without count as a loss.
  void advance(RobotTime now, const RobotView& robot);
  /// This host was suspended: its clock stood still, and what comes next looks younger than it is. A loss.
  void stood_still();
  /// What to send, oldest first; each once.
  std::vector<FromRobot> take_outgoing();
  /// On a thin line: a state that says nothing new only this often, at most as often as `state_every`.
  void repeat_states_every(Duration every) { repeat_every_ = every; }

  /// What the robot is to do, now; asked after advance().
  LineMotion motion(RobotTime now) const { return permit_.motion(now); }
  /// The next request that is to be executed; each comes once. An emergency stop goes before all others.
  LineRequest take_request();
  /// The name of who asked for the newest emergency stop, or "".
  const std::string& stopper() const { return stopper_; }

  /// Somebody beside the robot gives the lease to who asks for it. False: nobody does.
  bool consent_to_asking(RobotTime now);
  /// Somebody beside the robot takes the lease back.
  void end_lease(RobotTime now);

  /// "" where nobody holds the lease.
  std::string holder_name() const { return holder_name_; }
  std::string asking_name(RobotTime now);
  const MotionPermit& permit() const { return permit_; }
  const DeskCounts& counts() const { return counts_; }
  /// The newest set-point that was not refused, pressed or open.
  const TakenSetPoint& taken() const { return taken_; }
  Nonce session() const { return session_; }
  std::vector<DeskPeer>& peers() { return peers_.all(); }

 private:
  struct Queued {
    LineRequest what = LineRequest::none;
    Nonce consent = 0;  // when it was taken
  };
  void take(DeskPeer& from, const ClockPing& ping, RobotTime now);
  void take(DeskPeer& from, const ClockPong& pong, RobotTime now);
  void take(DeskPeer& from, const Ask& ask, RobotTime now);
  void take(DeskPeer& from, const GiveBack& back, RobotTime now);
  void take(DeskPeer& from, const HandOver& over, RobotTime now);
  void take(DeskPeer& from, const SetPoint& set_point, RobotTime now);
  void take(DeskPeer& from, const Request& request, RobotTime now);
  void forget_clocks();
  void greet(Nonce theirs, const Hello& hello, RobotTime now);
  RequestOutcome judge(const DeskPeer& from, const Request& request, RobotTime now) const;
  void queue(const DeskPeer& from, const Request& request);
  void grant(DeskPeer& to, RobotTime now);
  void answer(const DeskPeer& to, LeaseVerdict verdict);
  std::string refusal(const DeskPeer& to) const;
  DeskPeer* asking(RobotTime now);
  void tell_state(RobotTime now);
  template <typename Body>
  void send(const DeskPeer& to, Body body);

  ControlDeskOptions options_;
  Nonce session_;
  DeskPeers peers_;
  MotionPermit permit_;
  Nonce holder_ = 0;  // its `theirs`
  std::string holder_name_;
  RobotView robot_;
  SetPointFault fault_ = SetPointFault::none;
  DeskCounts counts_;
  TakenSetPoint taken_;
  std::vector<Queued> requests_;
  StopLedger stops_;
  std::string stopper_;
  std::vector<FromRobot> out_;
  std::uint64_t states_ = 0;
  Duration repeat_every_{0};
  RobotTime told_, advanced_;
  struct Told {
    Nonce consent = 0, holder = 0;
    RestCause cause = RestCause::nobody;
    SetPointFault fault = SetPointFault::none;
    bool ready = false;
    bool operator==(const Told&) const = default;
  } told_state_;
};

}  // namespace foresight
