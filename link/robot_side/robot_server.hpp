// The robot's end of the line: everything that `foresight robot --serve` publishes.
#pragma once

#include "link/control/lease_news.hpp"
#include "link/dds/refusal_watch.hpp"
#include "link/robot_side/served_operator.hpp"
#include "link/robot_side/state_sender.hpp"

namespace foresight::link {

/// Nothing in it ever holds up the control loop, the cameras or the console: it takes the loop's cycles from a ring and
/// pairs from a queue, each in a thread of its own. A reader that is slow, stopped or strange costs at most samples of
/// its own.
class RobotServer {
 public:
  /// `cameras`: null, or with frames(). `identity`: rig_identity(), whose scene is that of `cameras`. `line`: null, or
  /// as of Participant. All references must outlive this. Throws what Participant does.
  RobotServer(const Rig& rig, const Robot& robot, RobotCameras* cameras, Identity identity, Clock& clock,
              std::shared_ptr<PretendedLine> line = nullptr);
  /// What a start of the program has that no other has. Seeded and stepped, a session repeats itself byte by byte.
  struct Start {
    DrawNonce draw = machine_nonces();  ///< names of the start itself, of leases and consents
    WallClock::Now wall = WallClock::machine_unix_ns;
  };
  /// The same with a participant that somebody else has; it must outlive this.
  RobotServer(Participant& participant, const Rig& rig, const Robot& robot, RobotCameras* cameras, Identity identity,
              Clock& clock, const Start& start);

  /// Whoever commands over the line; to be asked in one thread, that of all commanders.
  Commander& commander() { return operator_; }

  /// Somebody beside the robot gives control to who asks for it over the line; in commander()'s thread.
  void give_control(RobotTime now) { operator_.desk().consent_to_asking(now); }

  void start();
  void step(RobotTime now);  ///< in stepped time, in place of start()
  void stop() noexcept;

  /// One line for people: who listens, commands and asks to, what goes out, what is wrong with the line.
  std::string line() const;
  /// What has happened on the line since it was asked the last time, for the log; mostly "". In commander()'s thread.
  std::string news(RobotTime now);
  /// Who asked over the line for the newest stop; "" where nobody did.
  std::string stopper() const { return operator_.taken().stopper(); }
  std::string robot_beside() const { return link::robot_beside(participant_); }
  FrameCounts counts() const noexcept { return frames_ ? frames_->counts() : FrameCounts{}; }

 private:
  RobotServer(std::unique_ptr<Participant> own, Participant* others, const Rig& rig, const Robot& robot,
              RobotCameras* cameras, Identity identity, Clock& clock, const Start& start);

  std::unique_ptr<Participant> own_;
  Participant& participant_;
  RefusalWatch refusals_;
  LeaseNews lease_;
  std::string beside_;  // as it was told
  RobotTime look_due_;  // for it
  WallClock wall_;
  LineCapacity capacity_;
  ServedOperator operator_;
  StateSender states_;
  std::unique_ptr<FrameSender> frames_;
};

}  // namespace foresight::link
