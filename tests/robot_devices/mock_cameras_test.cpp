// What mock cameras see of a robot in motion, against where its emulated shafts truly were.
#include <map>

#include "scene/run_folder.hpp"
#include "session/robot_cameras.hpp"
#include "sim/picture.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::mock_cameras_test {
namespace {

using namespace std::chrono_literals;

class MockCameras : public HeadlessTest {
 protected:
  /// The rig, with small and quick cameras.
  static Rig small(Rig rig) {
    for (CameraConfig& camera : rig.cameras->cameras) {
      camera.settings.width = 160;
      camera.settings.height = 120;
      camera.settings.rate = 10;
    }
    return rig;
  }

  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    context_.reset();
    live_.get_moving();
    // Beside the rack's own memory, once per millisecond, at the instants of the racks' steps.
    live_.clock().sleep_until(RobotTime{(live_.clock().now().ns / 1'000'000 + 1) * 1'000'000});
    live_.clock().every(1ms, [this](RobotTime now) {
      for (std::size_t i = 0; i < rig_.joints.size(); ++i) seen_[now].push_back(live_.shaft(i).position);
    });
  }

  double shaft(std::size_t joint, RobotTime time) const {
    const auto after = seen_.upper_bound(time);
    const auto before = std::prev(after);
    const double share = to_seconds(time - before->first) / to_seconds(after->first - before->first);
    return std::lerp(before->second[joint], after->second[joint], share);
  }
  sim::ShaftPositions shafts_at(RobotTime time) const {
    return [this, time](std::string_view name) -> std::optional<double> {
      const std::size_t joint = live_.joint(std::string(name));
      return joint < rig_.joints.size() ? std::optional(shaft(joint, time)) : std::nullopt;
    };
  }

  LiveRobot live_{"minerva.yaml"};
  Rig rig_ = small(live_.rig());
  std::map<RobotTime, std::vector<double>> seen_;
  TempFolder folder_;
};

TEST_F(MockCameras, SeeTheShaftsWhereTheyWereInTheMiddleOfTheExposure) {
  {
    RobotCameras cameras(rig_, live_.devices(), live_.robot(), live_.clock(),
                         {.mock = true, .record = folder_ / "run"});
    bool on = true;
    live_.clock().every(10ms, [&](RobotTime) {
      if (on) cameras.step();
    });
    live_.move(1s);
    on = false;
    EXPECT_THAT(cameras.finish(), testing::HasSubstr("pairs"));
    live_.move(20ms);
  }
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_GE(run.frames().size(), 9u);
  const sim::LiveLab world(sim::LiveLab::Options{});
  const sim::LightMap light(world.lab(), 4);
  const auto irradiance = light.lit(world.true_state(sim::shafts_at_rest, 0));
  const sim::Renderer renderer(world.lab(), light);
  const RobotTime epoch = run.frames()[0].left.time - 100ms + 4ms;  // its exposure ended a period after the start
  double moved = 0;
  for (const std::size_t i : {std::size_t{2}, std::size_t{7}}) {
    const RunFrame& frame = run.frames()[i];
    const RobotTime time = frame.left.time;
    const auto psnr = [&](Duration late) {
      const auto truth =
          renderer.render(sim::RayTable(run.lens_left()), world.T_world_left(shafts_at(time + late)),
                          world.true_state(shafts_at(time + late), to_seconds(time - epoch)), irradiance);
      return cv::PSNR(sim::Sensor{.noise = 0}.develop(truth.light, 0, 0), read_run_image(frame.left, run.lens_left()));
    };
    const double now = psnr(0ms);
    EXPECT_GT(now, 25) << "frame " << i;
    EXPECT_GT(now, psnr(30ms) + 0.5) << "frame " << i;
    EXPECT_GT(now, psnr(-30ms) + 0.5) << "frame " << i;
    // What was written down as the encoders' word.
    const Pose T = sim::LiveLab::T_world_left_modelled(shafts_at(time));
    // A millisecond from shaft to stamp, at up to 1.5 rad/s.
    EXPECT_LT((T.translation() - frame.left.T_world_camera.translation()).norm(), 1e-3);
    EXPECT_LT((T.linear() - frame.left.T_world_camera.linear()).norm(), 4e-3);
    moved += (T.linear() - run.frames()[i - 1].left.T_world_camera.linear()).norm();
  }
  EXPECT_GT(moved, 0.01) << "the head moves";
}

TEST_F(MockCameras, WithPhysicsThingsAreInTheSceneAndWhereTheWorldHasThem) {
  std::shared_ptr<sim::PhysicalLab> physics;
  {
    RobotCameras cameras(rig_, live_.devices(), live_.robot(), live_.clock(),
                         {.mock = true, .record = folder_ / "run", .physics = true, .physics_seed = 3});
    bool on = true;
    live_.clock().every(10ms, [&](RobotTime) {
      if (on) cameras.step();
    });
    live_.move(500ms);
    on = false;
    physics = cameras.physics();
    ASSERT_TRUE(physics);
    const auto brick = static_cast<std::size_t>(physics->lab().lab().find("brick_red"));
    const RobotTime now = live_.clock().now();
    const double off =
        (physics->thing_at("brick_red", now).translation() - physics->lab().modelled_rest()[brick].translation())
            .norm();
    EXPECT_GT(off, 1e-4) << "truth and model differ";
    EXPECT_LT(off, 5e-3);
    const sim::LabState state = physics->state_at(now);
    const auto finger = static_cast<std::size_t>(physics->lab().lab().find("finger_left"));
    const sim::LabState by_shafts = physics->lab().true_state(shafts_at(now - 1ms), 0);
    EXPECT_LT((state[finger].translation() - by_shafts[finger].translation()).norm(), 5e-3) << "driven by the shafts";
    cameras.finish();
    live_.move(20ms);
  }
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  EXPECT_GE(run.frames().size(), 4u);
  for (const char* name : {"brick_red", "brick_blue", "tray"}) EXPECT_TRUE(run.scene()->find(name)) << name;
}

TEST_F(MockCameras, PhysicsIsForMockCameras) {
  for (CameraConfig& camera : rig_.cameras->cameras) camera.driver = CameraDriver::v4l2;
  EXPECT_THROW(RobotCameras(rig_, live_.devices(), live_.robot(), live_.clock(), {.physics = true}), InputError);
}

/// The lab's head by its drawing, as a result of `calibrate pan-tilt`.
std::filesystem::path drawn_head(const TempFolder& folder) {
  return folder.write(
      "head.yaml",
      "kind: pan-tilt\ndate: 2026-01-01T00:00:00Z\nscore: {name: loo_mrad, value: 0.5}\nresult:\n"
      "  T_world_pan: {xyz: [-0.82, 0.04, 0.48], quaternion: [0, 0, 0, 1]}\n"
      "  length_m: 0\n  twist_rad: -1.5707963267948966\n"
      "  T_tilt_camera: {xyz: [0.03, 0, 0.0325], quaternion: [0, 0.70710678118654752, 0, 0.70710678118654752]}\n"
      "  gain: [1, 1]\n  backlash_rad: [0, 0]\n");
}

TEST_F(MockCameras, ACalibratedHeadGivesThePosesOfARecording) {
  rig_.calibration =
      RigCalibration{drawn_head(folder_), {}, folder_.write("map.txt", "1 0 0 0 0\n1 1 1 0 0\n1 2 1 1 0\n1 3 0 1 0\n")};
  {
    RobotCameras cameras(rig_, live_.devices(), live_.robot(), live_.clock(),
                         {.mock = true, .record = folder_ / "run"});
    bool on = true;
    live_.clock().every(10ms, [&](RobotTime) {
      if (!on) return;
      cameras.step();
    });
    live_.move(1s);
    on = false;
    cameras.finish();
    live_.move(20ms);
  }
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_GE(run.frames().size(), 8u);
  double moved = 0;
  for (std::size_t i = 2; i < run.frames().size(); ++i) {
    const RunImage& image = run.frames()[i].left;
    ASSERT_TRUE(image.predicted_px);
    EXPECT_LT(*image.predicted_px, 2);
    const Pose T = sim::LiveLab::T_world_left_modelled(shafts_at(image.time));
    EXPECT_LT((T.linear() - image.T_world_camera.linear()).norm() +
                  (T.translation() - image.T_world_camera.translation()).norm(),
              4e-3)
        << i;
    moved += (image.T_world_camera.linear() - run.frames()[i - 1].left.T_world_camera.linear()).norm();
  }
  EXPECT_GT(moved, 0.01) << "the head moves";
  EXPECT_THAT(folder_.read("run/registration.txt"), testing::HasSubstr(" encoders "));
  EXPECT_EQ(folder_.read("run/tags.txt"), folder_.read("map.txt"));
}

TEST_F(MockCameras, ARigWithoutMotionKnowsItsShafts) {
  const RobotTime now = live_.clock().now();
  live_.move(100ms);
  for (std::size_t i = 0; i < rig_.joints.size(); ++i) {
    const auto name = rig_.joint_names()[i];
    EXPECT_NEAR(live_.devices().shaft_at(name, now + 50500us).value(), shaft(i, now + 50500us), 1e-9) << name;
  }
  EXPECT_FALSE(live_.devices().shaft_at("tail", now));
}

}  // namespace
}  // namespace foresight::mock_cameras_test
