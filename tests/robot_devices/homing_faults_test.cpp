// Everything that may go wrong while a joint looks for home, moved by its drive's own orders. Wanted each time: the
// reason visible, no shaft goes on, and no torque is taken from a shaft that still moves.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/folders.hpp"

namespace foresight::homing_faults_test {
namespace {

using namespace std::chrono_literals;
using sim::DriveFault;

constexpr std::size_t kJoints = 10;

/// What goes wrong, beside faults of the joint's own drive.
enum class Event { bus_off, other_bus_off, second_master, emergency_stop, killed, other_faults, other_restarts };

/// Both protocols, a joint each.
class HomingFaults : public testing::TestWithParam<std::tuple<const char*, std::size_t>> {
 protected:
  std::size_t joint() const { return std::get<1>(GetParam()); }
  bool is_cia402() const { return std::string(std::get<0>(GetParam())) == "cia402.yaml"; }
  /// Only the joint has a way to go, of 2 % of its range, in `length_s`; all others are at home.
  Rig rig(double length_s) const {
    Rig out = read_rig(source_folder() / "configs" / std::get<0>(GetParam()));
    for (RigJoint& other : out.joints) other.absolute = true;
    RigJoint& j = out.joints[joint()];
    j.absolute = false;
    if (is_cia402()) j.homing_method = 17;
    j.drive.homing_velocity = 0.02 * (j.drive.max_position - j.drive.min_position) / length_s;
    return out;
  }
  void start(double length_s = 4) {
    stranger_.reset();
    live_.reset();
    live_ = std::make_unique<LiveRobot>(rig(length_s));
    live_->robot().ask(RobotRequest::enable);
    for (int i = 0; i < 300 && live_->robot().status().phase != RobotPhase::ready; ++i) live_->run(10ms);
    ASSERT_EQ(live_->robot().status().phase, RobotPhase::ready) << live_->robot().status().refused;
    live_->robot().ask(RobotRequest::home);
    for (int i = 0; i < 1000 && !moves(); ++i) live_->run(10ms);
    ASSERT_TRUE(moves()) << live_->robot().status().waiting_for;
    live_->run(100ms);
    ASSERT_EQ(live_->robot().status().phase, RobotPhase::homing);
    ASSERT_EQ(live_->robot().status().waiting_for, static_cast<int>(joint()));
  }
  double speed(std::size_t i) const { return std::abs(live_->shaft(i).velocity); }
  bool moves() const {
    const RigJoint& j = live_->rig().joints[joint()];
    return live_->robot().status().waiting_for == static_cast<int>(joint()) &&
           speed(joint()) > 0.9 * j.drive.homing_velocity;
  }
  const std::string& name(std::size_t i) const { return live_->rig().joints[i].drive.name; }
  std::size_t other() const { return (joint() + 1) % kJoints; }

  void happen(Event event) {
    const std::size_t bus = live_->rig().joints[joint()].bus;
    switch (event) {
      case Event::bus_off:
      case Event::other_bus_off: {
        const std::size_t at = event == Event::bus_off ? bus : 1 - bus;
        return live_->devices().medium(at)->force_bus_off(live_->devices().master_end(at));
      }
      case Event::second_master: {
        CanFrame frame;
        frame.id = is_cia402() ? 0x080 : 0x0C0 + 1;  // SYNC, or a question
        frame.size = is_cia402() ? 0 : 2;
        if (!is_cia402()) frame.data = {0x0A, 0x3C};
        stranger_ = live_->devices().medium(bus)->attach();
        stranger_->send(frame);
        return;
      }
      case Event::emergency_stop: return live_->robot().ask(RobotRequest::emergency_stop);
      case Event::killed: return live_->run(2s, true);
      case Event::other_faults: return live_->inject(name(other()), DriveFault::overcurrent);
      case Event::other_restarts: return live_->inject(name(other()), DriveFault::reset);
    }
  }
  void expect_stopped(const std::string& what) {
    live_->run(2s);
    const RobotStatus status = live_->robot().status();
    EXPECT_EQ(status.phase, RobotPhase::stopped) << what;
    EXPECT_NE(status.gate.reason, GateReason::none) << what;
    EXPECT_EQ(status.waiting_for, static_cast<int>(joint())) << what << ": which joint it was";
    live_->expect_at_rest(what.c_str());
    std::vector<double> stood;
    for (std::size_t i = 0; i < kJoints; ++i) stood.push_back(live_->shaft(i).position);
    live_->run(1s);
    for (std::size_t i = 0; i < kJoints; ++i)
      EXPECT_NEAR(live_->shaft(i).position, stood[i], 1e-4) << what << ": " << name(i) << " goes on";
    EXPECT_FALSE(live_->robot().status().all_homed) << what;
  }
  std::unique_ptr<LiveRobot> live_;
  std::unique_ptr<CanBus> stranger_;
};

TEST_P(HomingFaults, OfItsOwnDriveStopIt) {
  for (const auto& [what, fault] : {std::pair{"overcurrent", DriveFault::overcurrent},
                                    {"tow error", DriveFault::tow_error},
                                    {"EMCY", DriveFault::emergency},
                                    {"reset", DriveFault::reset},
                                    {"silent", DriveFault::silent},
                                    {"frozen", DriveFault::frozen},
                                    {"garbage", DriveFault::garbage},
                                    {"jam", DriveFault::jam}}) {
    if (fault == DriveFault::emergency && !is_cia402()) continue;  // PowerCube has no emergency messages
    start();
    if (HasFatalFailure()) return;
    live_->inject(name(joint()), fault, 0x4310);
    expect_stopped(what);
    if (fault == DriveFault::garbage) continue;  // some of its positions would be taken for rest
    EXPECT_TRUE(live_->robot().status().gate.joint == static_cast<int>(joint())) << what;
  }
}

TEST_P(HomingFaults, OfAllElseStopIt) {
  for (const auto& [what, event] : {std::pair{"bus-off", Event::bus_off},
                                    {"bus-off of the other bus", Event::other_bus_off},
                                    {"second master", Event::second_master},
                                    {"emergency stop", Event::emergency_stop},
                                    {"killed", Event::killed},
                                    {"another drive's fault", Event::other_faults},
                                    {"another drive's restart", Event::other_restarts}}) {
    start();
    if (HasFatalFailure()) return;
    happen(event);
    expect_stopped(what);
  }
}

TEST_P(HomingFaults, DisableIsRefusedInMotion) {
  start();
  if (HasFatalFailure()) return;
  live_->robot().ask(RobotRequest::disable);
  live_->run(40ms);
  EXPECT_EQ(live_->robot().status().phase, RobotPhase::homing);
  EXPECT_THAT(live_->robot().status().refused, testing::HasSubstr("rest"));
  EXPECT_TRUE(moves());
}

// As SIGTERM asks for it: first rest, then the brakes.
TEST_P(HomingFaults, TheEndOfTheProgramTakesNoTorqueFromAShaftInMotion) {
  start(1);
  if (HasFatalFailure()) return;
  double fastest = 0;  // of a shaft without torque
  int watched = 0;
  live_->clock().every(1ms, [&](RobotTime) {
    ++watched;
    for (std::size_t i = 0; i < kJoints; ++i)
      if (!live_->shaft(i).powered) fastest = std::max(fastest, speed(i) / live_->rig().joints[i].drive.max_velocity);
  });
  std::stop_source stop;
  stop.request_stop();
  ASSERT_TRUE(moves());
  live_->robot().run(live_->clock(), stop.get_token());
  EXPECT_GT(watched, 50) << "rest is measured over 0.1 s, of which the last of a slow motion may be a part";
  EXPECT_LT(fastest, 0.02) << "brakes closed at once by PowerCubes below 1 mrad/s, or mm/s";
  EXPECT_STREQ(to_string(live_->robot().status().phase), "disabled");
  live_->expect_at_rest("ended");
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (live_->rig().joints[i].group == JointGroup::gripper) continue;
    EXPECT_FALSE(live_->shaft(i).powered) << name(i);
  }
}

TEST_P(HomingFaults, NoneEndsAtHome) {
  start(1);
  if (HasFatalFailure()) return;
  for (int i = 0; i < 100 && live_->robot().status().phase == RobotPhase::homing; ++i) live_->run(100ms);
  EXPECT_EQ(live_->robot().status().phase, RobotPhase::ready) << to_string(live_->robot().status().gate.reason);
  EXPECT_TRUE(live_->robot().status().all_homed);
}

INSTANTIATE_TEST_SUITE_P(Rigs, HomingFaults,
                         testing::Combine(testing::Values("minerva.yaml", "cia402.yaml"),
                                          testing::Range<std::size_t>(0, kJoints)),
                         [](const auto& i) {
                           const std::string file = std::get<0>(i.param);
                           return file.substr(0, file.find('.')) + "_joint_" + std::to_string(std::get<1>(i.param));
                         });

}  // namespace
}  // namespace foresight::homing_faults_test
