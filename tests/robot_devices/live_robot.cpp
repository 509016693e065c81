#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/folders.hpp"

#include <cmath>

namespace foresight {

using namespace std::chrono_literals;

LiveRobot::LiveRobot(const std::string& rig_file) : LiveRobot(read_rig(source_folder() / "configs" / rig_file)) {}

LiveRobot::LiveRobot(Rig rig, std::map<std::string, double> start) : rig_(std::move(rig)) {
  RobotDeviceOptions options;
  options.mock = true;
  options.mock_without_limits = true;
  options.mock_start = std::move(start);
  devices_ = std::make_unique<RobotDevices>(rig_, clock_, options);
  shape_ = rig_.shape();
  robot_ = std::make_unique<Robot>(rig_.gate_options(), shape_.get(), devices_->networks(), devices_->drives());
  for (const RigJoint& joint : rig_.joints)
    place_.emplace_back(joint.bus, devices_->rack(joint.bus)->find(joint.drive.name).value());
  devices_->bring_up([](const std::string&) {});
  next_ = clock_.now();
}

void LiveRobot::run(Duration time, bool frozen) {
  const RobotTime until = clock_.now() + time;
  while (clock_.now() < until) {
    next_ = std::max(next_ + 4ms, clock_.now());
    clock_.sleep_until(next_);
    if (!frozen) robot_->cycle(clock_.now());
  }
}

MotionCommand LiveRobot::command(bool deadman) {
  MotionCommand out{1, ++sequence_, clock_.now(), deadman, rig_.joints.size(), {}};
  // Each joint to and fro over a part of its range, upright enough to stay clear of the table.
  for (std::size_t i = 0; i < rig_.joints.size(); ++i) {
    const DriveConfig& d = rig_.joints[i].drive;
    const double middle = i == 7 ? 0.02 : 0, reach = 0.25 * std::min(d.max_position - middle, middle - d.min_position);
    out.position[i] = middle + reach * std::sin(phase_ * (1 + 0.1 * static_cast<double>(i)));
  }
  return out;
}

void LiveRobot::move(Duration time) {
  for (const RobotTime until = clock_.now() + time; clock_.now() < until;) {
    phase_ += 1.6 * 0.008;
    robot_->submit(command());
    run(8ms);
  }
}

void LiveRobot::get_moving() {
  robot_->ask(RobotRequest::enable);
  run(1s);
  ASSERT_EQ(robot_->status().phase, RobotPhase::ready)
      << robot_->status().refused << ", joint " << robot_->status().waiting_for;
  if (!robot_->status().all_homed) robot_->ask(RobotRequest::home);
  for (int i = 0; i < 400 && (robot_->status().phase != RobotPhase::ready || !robot_->status().all_homed); ++i)
    run(100ms);
  ASSERT_TRUE(robot_->status().all_homed) << "joint " << robot_->status().waiting_for;
  for (std::size_t i = 0; i < place_.size(); ++i) devices_->rack(place_[i].first)->forget_extremes(place_[i].second);
  robot_->submit(command(false));
  run(8ms);
  move(4s);
  for (int i = 0; i < 100 && fastest() < 0.3; ++i) move(40ms);
  ASSERT_EQ(robot_->status().gate.state, GateState::following) << to_string(robot_->status().gate.reason);
  ASSERT_GE(fastest(), 0.3);
}

std::size_t LiveRobot::joint(const std::string& name) const {
  const auto names = rig_.joint_names();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

sim::ShaftState LiveRobot::shaft(std::size_t joint) const {
  return devices_->rack(place_[joint].first)->shaft(place_[joint].second);
}

void LiveRobot::inject(const std::string& name, sim::DriveFault fault, double value) {
  const auto [bus, place] = place_[joint(name)];
  devices_->rack(bus)->inject(place, fault, value);
}

double LiveRobot::fastest() const {
  double out = 0;
  for (std::size_t i = 0; i < place_.size(); ++i)
    out = std::max(out, std::abs(shaft(i).velocity) / rig_.joints[i].drive.max_velocity);
  return out;
}

void LiveRobot::expect_limits_kept(const char* when, bool accelerations) {
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const DriveConfig& d = rig_.joints[i].drive;
    const sim::ShaftState s = shaft(i);
    const double range = d.max_position - d.min_position;
    // The servo loop swings a little around its set-points.
    EXPECT_LE(s.most_positive, d.max_position + 1e-3 * range) << d.name << ", " << when;
    EXPECT_GE(s.most_negative, d.min_position - 1e-3 * range) << d.name << ", " << when;
    EXPECT_LE(s.largest_velocity, 1.02 * d.max_velocity) << d.name << ", " << when;
    if (accelerations) {
      EXPECT_LE(s.largest_acceleration, 1.05 * d.max_acceleration + 0.15) << d.name << ", " << when;
    }
  }
}

void LiveRobot::expect_at_rest(const char* when) {
  for (std::size_t i = 0; i < place_.size(); ++i)
    EXPECT_LT(std::abs(shaft(i).velocity), 1e-3) << rig_.joints[i].drive.name << ", " << when;
}

}  // namespace foresight
