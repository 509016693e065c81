// What goes on beside the control loop of `foresight robot`: operators, the terminal, logs, the service's watchdog.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/robot/keyboard.hpp"
#include "apps/robot/robot_news.hpp"
#include "apps/robot/service_notify.hpp"
#include "apps/robot/session_record.hpp"
#include "operators/follow_operator.hpp"
#include "operators/key_operator.hpp"
#include "rig/mock_faults.hpp"
#include "session/joint_log.hpp"
#include "session/robot_cameras.hpp"

namespace foresight {

struct ConsoleOptions {
  std::string follow;                 ///< file with a motion, or "": then the keyboard drives
  bool may_home = false;              ///< consent, with `follow`
  std::string joints;                 ///< file for all joints over time, or ""
  std::string session;                ///< page about the session, or ""
  std::vector<std::string> faults;    ///< of mock drives (parse_mock_faults)
  bool mock = false;                  ///< all drives are mock ones, whatever the rig says
  Commander* commander = nullptr;     ///< somebody else who may command, beside the keyboard; null: nobody
  std::function<std::string()> line;  ///< how the line to others is, in one line; empty: there is none
  std::function<std::string(RobotTime)> line_news;  ///< what has happened on it since; mostly ""; empty as `line`
  std::function<std::string()> line_stopper;        ///< who asked over it for the newest stop; empty as `line`
  std::function<void(RobotTime)> give_control;      ///< to who asks for it over the line; empty as `line`
};

/// One line for whoever started the program.
void say_robot(const std::string& line);

/// One thread. Everything that it is made of must outlive it.
class Console {
 public:
  /// `cameras`: may be null. Throws what FollowFile, JointLog and parse_mock_faults do.
  Console(const Rig& rig, const RobotDevices& devices, Robot& robot, RobotCameras* cameras,
          const ConsoleOptions& options);

  /// To be called about every 10 ms. False: the program shall end.
  bool tick(RobotTime now);
  /// How the motion of the file ended, where it did not end well.
  std::string trouble() const;
  /// After the loop has ended: the last words, the report, and the exit code.
  int finish();

 private:
  std::string outcome() const;
  std::string log_fault();
  std::string finish_recording();
  std::string view(const RobotStatus& status, int selected) const;
  std::string line_stopper() const { return line_stopper_ ? line_stopper_() : ""; }
  void report();
  void show(RobotTime now, const RobotStatus& status);
  void take_keys(RobotTime now);
  void notify(RobotTime now, const RobotStatus& status);

  const Rig& rig_;
  const RobotDevices& devices_;
  Robot& robot_;
  RobotCameras* cameras_;
  std::optional<JointLog> joints_;
  std::optional<SessionRecord> session_;
  std::filesystem::path report_;
  MockFaults faults_;
  Keyboard keyboard_;
  KeyOperator keys_;
  std::optional<FollowOperator> follow_;
  std::vector<Commander*> commanders_;
  std::function<std::string()> line_;
  std::function<std::string(RobotTime)> line_news_;
  std::function<std::string()> line_stopper_;
  std::function<void(RobotTime)> give_control_;
  RobotNews news_;
  LoopLife life_;
  RobotTime shown_, notified_;
  bool told_of_recording_ = false;  // that it ended
};

}  // namespace foresight
