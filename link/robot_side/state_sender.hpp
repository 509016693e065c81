// What the robot does onto the line: joints, transforms, states.
#pragma once

#include <thread>

#include "link/robot_side/command_history.hpp"
#include "link/robot_side/frame_sender.hpp"
#include "link/robot_side/line_share.hpp"
#include "session/robot_cameras.hpp"

namespace foresight::link {

/// What the gate did, joint states, set-points and transforms at `joint_rate_hz`; the robot's state at `state_rate_hz`,
/// and at once when its phase, gate or reason changes; diagnostics once a second. On a thin
/// line they go less often. It takes the control loop's cycles
/// from a ring of its own: the loop knows nothing of it. start() gives it a thread; step() does the same in the
/// caller's.
class StateSender {
 public:
  /// `cameras` may be null, and so may `taken`: then nobody commands over the line; and `line`: then it is never thin.
  /// All that is pointed at must outlive this.
  StateSender(Participant& participant, SenderName name, const Rig& rig, const Robot& robot,
              const RobotCameras* cameras, WallClock& wall, Clock& clock, const CommandHistory* taken = nullptr,
              const LineCapacity* line = nullptr);
  ~StateSender() { stop(); }

  void start();
  void stop() noexcept;
  const SenderName& name() const { return name_; }
  /// Sends what is due at `now`.
  void step(RobotTime now) noexcept;

 private:
  void listen();
  void send_motion();
  void send_joints();
  void send_state(RobotTime now);
  Duration thinned_for_line(Duration asked, const LineShare& share) const;

  const SenderName name_;
  const Rig& rig_;
  const Robot& robot_;
  const RobotCameras* cameras_;
  WallClock& wall_;
  Clock& clock_;
  const CommandHistory* taken_;
  const LineCapacity* line_;
  const Duration joint_period_, state_period_;

  BroadcastRing<RobotCycle>::Reader cycles_;
  JointTracks joints_;
  std::optional<RobotCycle> newest_;
  bool changed_ = true;                                 // since the last state that was sent
  RobotTime joints_due_, state_due_, diagnostics_due_;  // by the clock
  RobotTime sent_joints_;                               // the instant that they were of
  std::uint64_t number_ = 0, motions_ = 0;

  Writer motion_, joint_states_, set_points_, transforms_, static_transforms_, states_, diagnostics_;
  std::jthread thread_;
};

}  // namespace foresight::link
