// Everything that may go wrong while the robot moves. Wanted each time: no shaft beyond its limits, all at
// rest soon, the reason visible, and nothing moves again before a person has asked for it.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/robot_devices/live_robot.hpp"

namespace foresight::faults_test {
namespace {

using namespace std::chrono_literals;
using sim::DriveFault;

class Faults : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { live_.get_moving(); }
  bool is_cia402() const { return live_.rig().buses[0].protocol == DriveProtocol::cia402; }

  void expect_stopped(const char* what, std::initializer_list<GateReason> reasons, const std::string& joint = "") {
    live_.move(2s);
    const RobotStatus status = live_.robot().status();
    EXPECT_EQ(status.phase, RobotPhase::stopped) << what;
    EXPECT_THAT(std::vector<GateReason>(reasons), testing::Contains(status.gate.reason))
        << what << ": " << to_string(status.gate.reason);
    if (!joint.empty()) {
      EXPECT_EQ(status.gate.joint, static_cast<int>(live_.joint(joint))) << what;
    }
    live_.expect_at_rest(what);
    live_.expect_limits_kept(what);
  }
  /// The fault is gone: asked to, the robot goes on.
  void expect_recovery(const char* what) {
    std::vector<double> stood;
    for (std::size_t i = 0; i < live_.rig().joints.size(); ++i) stood.push_back(live_.shaft(i).position);
    live_.robot().ask(RobotRequest::reset);
    live_.move(3s);
    const RobotStatus status = live_.robot().status();
    EXPECT_EQ(status.phase, RobotPhase::ready)
        << what << ": " << to_string(status.gate.reason) << ", " << status.refused << ", joint " << status.waiting_for;
    for (std::size_t i = 0; i < stood.size(); ++i)
      EXPECT_NEAR(live_.shaft(i).position, stood[i], 0.01)
          << what << ": the operator has not engaged again, joint " << i;
    live_.robot().submit(live_.command(false));
    live_.run(8ms);
    live_.move(4s);
    EXPECT_EQ(live_.robot().status().gate.state, GateState::following) << what;
    EXPECT_GT(live_.fastest(), 0.05) << what;
    live_.expect_limits_kept(what);
  }
  LiveRobot live_{GetParam()};
};

TEST_P(Faults, NoneKeepsAllLimits) {
  live_.move(10s);
  EXPECT_EQ(live_.robot().status().gate.state, GateState::following);
  live_.expect_limits_kept("without a fault", true);
}

TEST_P(Faults, ADriveFault) {
  live_.inject("elbow", DriveFault::overcurrent);
  expect_stopped("overcurrent", {GateReason::drive_fault}, "elbow");
  EXPECT_STRNE(live_.robot().status().gate.detail, "");
  expect_recovery("overcurrent");
}

TEST_P(Faults, AShaftThatLagsTooFarBehind) {
  live_.inject("pan", DriveFault::tow_error);
  expect_stopped("tow error", {GateReason::drive_fault}, "pan");
  expect_recovery("tow error");
}

TEST_P(Faults, AnEmergencyMessage) {
  if (!is_cia402()) GTEST_SKIP() << "PowerCube has no emergency messages";
  live_.inject("elbow", DriveFault::emergency, 0x4310);
  expect_stopped("EMCY", {GateReason::drive_fault}, "elbow");
  EXPECT_THAT(live_.robot().status().gate.detail, testing::HasSubstr("temperature"));
}

TEST_P(Faults, ADriveThatFallsSilent) {
  live_.inject("elbow", DriveFault::silent);
  expect_stopped("silence", {GateReason::drive_offline, GateReason::feedback_lost, GateReason::drive_fault}, "elbow");
}

TEST_P(Faults, AJammedJoint) {
  live_.inject("elbow", DriveFault::jam);
  expect_stopped("jam", {GateReason::following_error, GateReason::drive_fault, GateReason::feedback_frozen}, "elbow");
}

TEST_P(Faults, FrozenFeedback) {
  live_.inject("elbow", DriveFault::frozen);
  expect_stopped("frozen", {GateReason::following_error, GateReason::feedback_frozen}, "elbow");
}

TEST_P(Faults, FeedbackThatIsGarbage) {
  live_.inject("elbow", DriveFault::garbage);
  expect_stopped("garbage",
                 {GateReason::following_error, GateReason::feedback_not_finite, GateReason::feedback_lost,
                  GateReason::drive_fault},
                 "elbow");
}

TEST_P(Faults, ANodeThatRestartsInMotion) {
  live_.inject("elbow", DriveFault::reset);
  expect_stopped(
      "node reset",
      {GateReason::drive_fault, GateReason::drive_offline, GateReason::drive_not_enabled, GateReason::feedback_lost},
      "elbow");
}

// It has forgotten all: configured anew, it goes on.
TEST_P(Faults, ANodeThatRestartedIsSetUpAgain) {
  live_.inject("elbow", DriveFault::reset);
  live_.move(2s);
  ASSERT_EQ(live_.robot().status().phase, RobotPhase::stopped);
  live_.robot().ask(RobotRequest::set_up);
  live_.run(8ms);
  std::stop_source stop;
  int asked = 0;
  live_.clock().every(8ms, [&](RobotTime) {
    if (asked++ == 500) stop.request_stop();
  });
  std::string error = "not set up";
  live_.robot().run(live_.clock(), stop.get_token(), [&] {
    try {
      live_.devices().bring_up([](const std::string&) {});
      error.clear();
    } catch (const std::exception& what) {
      error = what.what();
    }
    live_.robot().ask(RobotRequest::enable);
  });
  EXPECT_EQ(error, "");
  EXPECT_STREQ(to_string(live_.robot().status().phase), "disabled") << "run() has ended";
  live_.robot().ask(RobotRequest::enable);
  live_.run(2s);
  EXPECT_STREQ(to_string(live_.robot().status().phase), "ready")
      << live_.robot().status().waiting_for << " " << live_.robot().status().refused;
}

TEST_P(Faults, BusOff) {
  live_.devices().medium(0)->force_bus_off(live_.devices().master_end(0));
  expect_stopped("bus-off", {GateReason::bus_fault});
  EXPECT_STRNE(live_.robot().status().gate.detail, "");
}

TEST_P(Faults, ASecondMaster) {
  const auto other = live_.devices().medium(0)->attach();
  CanFrame frame;
  if (is_cia402()) {
    frame.id = 0x080;  // SYNC
  } else {
    frame.id = 0x0C0 + 4;
    frame.size = 2;
    frame.data = {0x0A, 0x3C};
  }
  other->send(frame);
  expect_stopped("second master", {GateReason::bus_fault, GateReason::drive_fault, GateReason::drive_not_enabled});
  EXPECT_THAT(live_.robot().status().bus_reason, testing::HasSubstr("master"));
}

TEST_P(Faults, AProcessThatIsKilled) {
  live_.run(2s, true);
  live_.expect_at_rest("killed");
  live_.expect_limits_kept("killed");
  const double stood = live_.shaft(3).position;
  live_.run(1s, true);
  EXPECT_NEAR(live_.shaft(3).position, stood, 1e-4) << "it stays there";
}

TEST_P(Faults, AnOperatorWhoIsLostForASecond) {
  live_.run(1s);
  EXPECT_EQ(live_.robot().status().gate.state, GateState::idle);
  EXPECT_EQ(live_.robot().status().gate.reason, GateReason::operator_lost);
  live_.expect_at_rest("lost");
  const double stood = live_.shaft(3).position;
  live_.move(1s);
  EXPECT_NEAR(live_.shaft(3).position, stood, 1e-3) << "back, but not engaged";
  live_.robot().submit(live_.command(false));
  live_.run(8ms);
  live_.move(4s);
  EXPECT_EQ(live_.robot().status().gate.state, GateState::following);
  live_.expect_limits_kept("back", true);
}

TEST_P(Faults, CommandsThatAreWrong) {
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    MotionCommand bad = live_.command();
    const auto joint = random() % bad.joints;
    switch (random() % 5) {
      case 0: bad.position[joint] = std::nan(""); break;
      case 1: bad.position[joint] = 10; break;
      case 2: bad.time = bad.time - 1s; break;
      case 3: bad.operator_id = 9; break;
      default: bad.sequence = 1;
    }
    live_.robot().submit(bad);
    live_.run(4ms);
    if (i % 5 == 0) live_.move(8ms);
  }
  EXPECT_GT(live_.robot().status().gate.dropped, 900u);
  live_.expect_limits_kept("wrong commands", true);
}

TEST_P(Faults, ABurstOfOldCommands) {
  std::vector<MotionCommand> held;
  for (int i = 0; i < 125; ++i) {
    held.push_back(live_.command());
    for (double& q : held.back().position) q = 0.03;
    live_.run(8ms);
  }
  const double stood = live_.shaft(3).position;
  for (const MotionCommand& old : held) {
    live_.robot().submit(old);
    live_.run(4ms);
  }
  EXPECT_NEAR(live_.shaft(3).position, stood, 1e-3);
}

/// Frames of any kind. `to_drives`: those too that a drive takes for a master's.
class RandomFrames {
 public:
  RandomFrames(LiveRobot& live, bool to_drives)
      : live_(live), to_drives_(to_drives), end_(live.devices().medium(0)->attach()) {}
  void send(int count) {
    for (int i = 0; i < count;) {
      CanFrame frame;
      frame.extended = random_() % 10 == 0;
      frame.id = static_cast<std::uint32_t>(random_()) & (frame.extended ? 0x1fffffffu : 0x7ffu);
      frame.remote = random_() % 20 == 0;
      frame.size = static_cast<std::uint8_t>(random_() % 9);
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random_());
      if (!to_drives_ && !frame.extended && is_a_masters(frame.id)) continue;
      end_->send(frame);
      if (++i % 4 == 0) live_.move(8ms);
    }
  }

 private:
  bool is_a_masters(std::uint32_t id) const {
    if (live_.rig().buses[0].protocol == DriveProtocol::powercube) return id >= 0x0C0 && id <= 0x100;
    const std::uint32_t function = id >> 7;  // CiA 301, 7.3.5: NMT, SYNC, RPDO 1 to 4, SDO requests
    return id == 0 || id == 0x080 || function == 4 || function == 6 || function == 8 || function == 10 ||
           function == 12;
  }
  LiveRobot& live_;
  bool to_drives_;
  std::unique_ptr<CanBus> end_;
  std::mt19937 random_{6};
};

TEST_P(Faults, TenThousandRandomFrames) {
  RandomFrames(live_, false).send(10'000);
  live_.expect_limits_kept("random frames");
  live_.move(3s);
  if (live_.robot().status().phase == RobotPhase::ready) return;
  EXPECT_NE(live_.robot().status().gate.reason, GateReason::none);
  live_.expect_at_rest("random frames");
}

// No gate keeps a drive from what somebody else on its bus tells it. It must be noticed.
TEST_P(Faults, RandomFramesThatDrivesTakeForAMasters) {
  RandomFrames(live_, true).send(10'000);
  live_.move(3s);
  EXPECT_EQ(live_.robot().status().phase, RobotPhase::stopped);
  EXPECT_NE(live_.robot().status().gate.reason, GateReason::none);
}

INSTANTIATE_TEST_SUITE_P(Rigs, Faults, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

}  // namespace
}  // namespace foresight::faults_test
