// The camera of images that are still to come.
#include "seat/predicted_place.hpp"

#include "seat/predicted_source.hpp"
#include "sim/live_lab.hpp"
#include "tests/support/folders.hpp"

namespace foresight::predicted_place_test {
namespace {

class Places : public testing::Test {
 protected:
  Places() : lab_(std::make_shared<const sim::LiveLab>(sim::LiveLab::Options{.texel = 0.02})) {
    scene_ = std::make_shared<const LiveScene>(lab_, StereoLenses{});
    robot_.status = StateStatus::predicted;
    robot_.time = {5'000'000'000};
    robot_.joints = rig_.joints.size();
  }
  double& joint(std::string_view name) {
    for (std::size_t i = 0; i < rig_.joints.size(); ++i)
      if (rig_.joints[i].drive.name == name) return robot_.position[i];
    throw std::out_of_range("no such joint");
  }
  Pose by_head(double pan, double tilt) const {
    return sim::LiveLab::T_world_left_modelled([&](std::string_view name) -> std::optional<double> {
      return name == "pan" ? pan : name == "tilt" ? std::optional(tilt) : std::nullopt;
    });
  }

  const Rig rig_ = read_rig(source_folder() / "configs" / "minerva.yaml");
  std::shared_ptr<const sim::LiveLab> lab_;
  std::shared_ptr<const LiveScene> scene_;
  PredictedRobot robot_;
};

TEST_F(Places, TheCameraIsWhereTheHeadWillBe) {
  const PredictedPlaces places(rig_, scene_);
  EXPECT_TRUE(places.knows_camera());
  joint("pan") = 0.4;
  joint("tilt") = -0.2;
  EXPECT_TRUE(places.place(robot_).T_world_camera.isApprox(by_head(0.4, -0.2), 1e-12));
}

TEST_F(Places, WhatImagesShowedOfTheHeadsErrorGoesAlong) {
  PredictedPlaces places(rig_, scene_);
  Pose off = Pose::Identity();
  off.translate(Eigen::Vector3d(0.002, -0.001, 0.003));
  off.rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()));
  PosedImage image;
  image.T_world_camera = by_head(0.1, 0) * off;
  places.saw(image, [](std::string_view name) { return std::optional(name == "pan" ? 0.1 : 0.0); });
  joint("pan") = 0.5;
  EXPECT_TRUE(places.place(robot_).T_world_camera.isApprox(by_head(0.5, 0) * off, 1e-12));
}

TEST_F(Places, AnInvalidRobotStandsAsItWasMeasured) {
  const PredictedPlaces places(rig_, scene_);
  robot_.status = StateStatus::invalid;
  joint("pan") = 0.2;
  const ViewPlace place = places.place(robot_);
  EXPECT_EQ(place.scene.status, StateStatus::invalid);
  EXPECT_TRUE(place.T_world_camera.isApprox(by_head(0.2, 0), 1e-12));
}

TEST_F(Places, PositionsThatAreNoNumbersAreNotKnown) {
  joint("tilt") = std::nan("");
  EXPECT_FALSE(positions_of(rig_, robot_.position)("tilt"));
  EXPECT_FALSE(positions_of(rig_, robot_.position)("no such joint"));
  EXPECT_EQ(positions_of(rig_, robot_.position)("pan"), 0.0);
}

TEST(WhyNoPose, TellsWhoseDriveIsSilentAndWhatIsToBeHomed) {
  constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
  link::LineJoints joints{StateStatus::predicted, {"elbow", "pan", "tilt"}, {0.1, 0.2, 0.3}, {true, true, true}};
  EXPECT_EQ(why_no_pose(joints, false), "");
  joints.known[1] = false;
  EXPECT_EQ(why_no_pose(joints, false), ": pan tells no position any more") << "homing it would not help";
  joints.known[2] = false;
  EXPECT_EQ(why_no_pose(joints, false), ": pan, tilt tell no position any more");
  joints.positions[1] = joints.positions[2] = kNever;
  EXPECT_EQ(why_no_pose(joints, false), ": 2 of 3 joints tell no position; home them (H)");
  EXPECT_EQ(why_no_pose(joints, true), ": it was taken before all joints were homed; later ones are on their way");
  joints.positions[1] = 0.2;
  EXPECT_EQ(why_no_pose(joints, true), ": pan tells no position any more") << "which homing did not end";
}

}  // namespace
}  // namespace foresight::predicted_place_test
