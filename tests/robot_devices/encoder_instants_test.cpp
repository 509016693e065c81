// How far off a camera's pose is where a position counts as of the cycle in which it was looked at, and where it counts
// as of its own instant. The head of emulated drives pans at 1 rad/s.
#include <cstdio>

#include "session/encoder_poses.hpp"
#include "sim/synth_run.hpp"
#include "tests/robot_devices/live_robot.hpp"

namespace foresight::encoder_instants_test {
namespace {

using namespace std::chrono_literals;

constexpr double kSpeed = 1;  // rad/s

class EncoderInstants : public testing::TestWithParam<const char*> {
 protected:
  /// Pans from -1.2 rad on, all else at rest, for `time`; hands every cycle to `take`.
  template <typename Take>
  void pan(Duration time, Take take) {
    const std::size_t joint = live_.joint("pan");
    MotionCommand command = live_.command();
    for (std::size_t i = 0; i < live_.rig().joints.size(); ++i) command.position[i] = live_.shaft(i).position;
    auto cycles = live_.robot().cycles();
    const auto go = [&](double target, Duration moment) {
      const MotionCommand fresh = live_.command();  // its number and time
      command.sequence = fresh.sequence, command.time = fresh.time;
      command.position[joint] = target;
      live_.robot().submit(command);
      live_.run(moment);
    };
    for (int i = 0; i < 400; ++i) go(-1.2, 8ms);
    ASSERT_NEAR(live_.shaft(joint).position, -1.2, 0.01);
    while (cycles.take()) {
    }
    const RobotTime start = live_.clock().now();
    while (live_.clock().now() - start < time) {
      go(-1.2 + kSpeed * to_seconds(live_.clock().now() - start), 8ms);
      while (const auto cycle = cycles.take()) take(*cycle);
    }
    EXPECT_NEAR(live_.shaft(joint).velocity, kSpeed, 0.05);
    EXPECT_EQ(cycles.dropped(), 0u);
  }

  /// RMS over the image of how far points 1 m away are off.
  double error_px(const JointTracks& joints, RobotTime time) {
    const JointState state = joints.at(time);
    if (state.status == StateStatus::invalid) return 1e3;
    const auto names = live_.rig().joint_names();
    const Pose found = sim::LiveLab::T_world_left_modelled(
        [&](std::string_view name) { return state.positions[live_.joint(std::string(name))]; });
    const Pose truth = sim::LiveLab::T_world_left_modelled(
        [&](std::string_view name) { return live_.devices().shaft_at(name, time); });
    double square = 0;
    int count = 0;
    for (int v = 40; v < lens_.height(); v += 80)
      for (int u = 40; u < lens_.width(); u += 80, ++count)
        square +=
            (*lens_.project(found.inverse() * truth * *lens_.unproject({u, v})) - Eigen::Vector2d(u, v)).squaredNorm();
    return std::sqrt(square / count);
  }

  LiveRobot live_{GetParam()};
  Lens lens_ = [] {
    sim::SynthOptions usual;
    usual.width = 640, usual.height = 480;
    return sim::synth_lens(usual, false);
  }();
};

TEST_P(EncoderInstants, PutTheCameraWhereItWas) {
  ASSERT_NO_FATAL_FAILURE(live_.get_moving());
  JointTracks of_cycles(live_.rig().joints.size()), own(live_.rig().joints.size());
  double oldest_ms = 0;
  const std::size_t pan_joint = live_.joint("pan");
  ASSERT_NO_FATAL_FAILURE(pan(2200ms, [&](const RobotCycle& cycle) {
    own.add(cycle);
    RobotCycle as_if_now = cycle;
    for (std::size_t i = 0; i < cycle.joints; ++i) as_if_now.joint[i].time = cycle.time;
    of_cycles.add(as_if_now);
    oldest_ms = std::max(oldest_ms, 1e3 * to_seconds(cycle.time - cycle.joint[pan_joint].time));
  }));
  double before = 0, after = 0, worst = 0;
  int count = 0;
  const RobotTime end = live_.clock().now();
  for (RobotTime t = end - 1500ms; t < end - 100ms; t = t + 7ms, ++count) {
    const double now = error_px(own, t);
    before += std::pow(error_px(of_cycles, t), 2);
    after += now * now;
    worst = std::max(worst, now);
  }
  before = std::sqrt(before / count), after = std::sqrt(after / count);
  std::printf(
      "%s at %g rad/s, 640 x 480: RMS %.2f px by the cycles' time, %.2f px (worst %.2f) by the joints' own; "
      "positions up to %.1f ms old\n",
      live_.rig().name.c_str(), kSpeed, before, after, worst, oldest_ms);
  EXPECT_LT(after, 0.8) << "what a bus and a drive's own cycle of 1 ms cost";
  EXPECT_LT(worst, 1.2);
  EXPECT_GT(before, 2 * after) << "or there is nothing to mend";
}

INSTANTIATE_TEST_SUITE_P(Rigs, EncoderInstants, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

}  // namespace
}  // namespace foresight::encoder_instants_test
