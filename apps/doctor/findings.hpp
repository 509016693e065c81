// What `foresight doctor` looks at. Each check is a function that changes nothing on the machine.
#pragma once

#include <string>
#include <vector>

#include "common/clock.hpp"
#include "rig/rig.hpp"

namespace foresight::doctor {

enum class Verdict : std::uint8_t { good, absent, poor, bad };  ///< absent: not there, and not needed by the rig

/// One line of the report.
struct Finding {
  Verdict verdict = Verdict::good;
  std::string subject;  ///< "bus arm"
  std::string what;     ///< what was found
  std::string cure;     ///< what to type or do; empty where nothing is wrong
};
using Findings = std::vector<Finding>;

Findings check_can();                   ///< sockets in the kernel, interfaces and their state
Findings check_buses(const Rig& rig);   ///< the rig's interfaces, bit rates and planned load
Findings check_drives(const Rig& rig);  ///< identifies every drive; moves nothing
/// Format, rate and capture times of one of the rig's cameras, over two seconds of `clock`, which may be a stepped one.
Findings check_camera(const StereoConfig& config, Side side, Clock& clock);
/// Formats, rates, capture times and bandwidth of the rig's cameras, each alone and as a pair; takes some seconds.
Findings check_rig_cameras(const StereoConfig& config);
Findings check_groups(const Rig& rig);  ///< joints that are in the wrong group; nothing where none is
Findings check_home(const Rig& rig);    ///< links that are too close to something with every joint at home
Findings check_link(const Rig& rig);    ///< interface, peers and keys of its `link:` section; others see it come and go
Findings check_cameras();               ///< takes ten images of each that V4L2 knows; lists those that libcamera knows
Findings check_real_time();
Findings check_graphics();
Findings check_network();

}  // namespace foresight::doctor
