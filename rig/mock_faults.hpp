// What goes wrong with mock drives, at instants that the user names: to see what the safety gate does about it.
#pragma once

#include <string>
#include <vector>

#include "rig/robot_devices.hpp"

namespace foresight {

/// One of them.
struct MockFault {
  std::size_t joint = 0;  ///< index into Rig::joints
  std::string kind;       ///< "stuck", "following_error", "lost_node", "noisy_encoder" or "lost_power"
  double time_s = 0;      ///< after the control loop began; >= 0
};

/// Each of `texts` is "JOINT:KIND@TIME", such as "elbow:stuck@3.5". `all_mock`: the rig runs with mock drives on every
/// bus. Throws InputError that names the text: another form, a joint that the rig does not have or that has a real
/// drive, a kind that there is not (with those that there are), a time that is none.
std::vector<MockFault> parse_mock_faults(const std::vector<std::string>& texts, const Rig& rig, bool all_mock);

/// Lets them happen. One thread; `rig` and `devices` outlive it.
class MockFaults {
 public:
  MockFaults(std::vector<MockFault> faults, const Rig& rig, const RobotDevices& devices);
  /// What is due at `now` happens, and gets a line to say so; time begins with the first call.
  std::vector<std::string> step(RobotTime now);
  /// A line for each whose instant never came.
  std::vector<std::string> missed() const;

 private:
  std::vector<MockFault> waiting_;  // the last one is due first
  const Rig& rig_;
  const RobotDevices& devices_;
  RobotTime start_;
};

}  // namespace foresight
