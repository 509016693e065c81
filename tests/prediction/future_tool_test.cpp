#include "prediction/future_tool.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/error.hpp"
#include "tests/prediction/sample_arms.hpp"

namespace foresight::future_tool_test {
namespace {

std::vector<std::string> names_of(const ArmChain& arm) {
  std::vector<std::string> out{"finger"};  // one that does not move the tool
  for (const ArmJoint& joint : arm.joints()) out.push_back(joint.name);
  return out;
}

PredictedRobot robot_at(const ArmChain& arm, const JointVector& q, double sigma, RobotTime time) {
  PredictedRobot out;
  out.time = time;
  out.status = StateStatus::predicted;
  out.joints = arm.size() + 1;
  for (std::size_t i = 0; i < arm.size(); ++i) {
    out.position[i + 1] = q[static_cast<Eigen::Index>(i)];
    out.sigma[i + 1] = sigma;
  }
  return out;
}

// Errors of the joints that are their own, and errors that are alike in all of them: the told sigma fits both.
TEST(FutureTool, ItsUncertaintyIsThatOfItsJoints) {
  const ArmChain arm = lab_arm();
  for (const double alike : {0.0, 0.9}) {
    FutureTool tool(arm, names_of(arm), "test");
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    constexpr double kSigma = 1e-3;
    std::size_t inside = 0, count = 0;
    for (int i = 0; i < 4000; ++i) {
      const RobotTime time{1'000'000'000 + 20'000'000LL * i};
      const JointVector q = any_joints(arm, random);
      ScoredRobot scored{robot_at(arm, q, kSigma, time), {}};
      const PredictedTool shown = tool.show(scored.shown);
      EXPECT_EQ(shown.T_base_tip.translation(), arm.tip_pose(q).translation());
      const double common = normal(random);
      scored.truth = scored.shown.position;
      for (std::size_t k = 1; k <= arm.size(); ++k)
        scored.truth[k] += kSigma * (std::sqrt(alike) * common + std::sqrt(1 - alike) * normal(random));
      const auto error = tool.score(scored);
      ASSERT_TRUE(error);
      EXPECT_EQ(error->sigma, shown.sigma);
      if (i < 1000) continue;
      ++count;
      inside += error->position <= 2 * error->sigma ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(count), 0.95, 0.02) << alike;
  }
}

// What is told too wide on purpose is always right, and that must not make it too narrow once it is not.
TEST(FutureTool, NothingIsLearntWhileItsJointsUncertaintySettles) {
  const ArmChain arm = lab_arm();
  FutureTool tool(arm, names_of(arm), "test");
  const JointVector q = arm.middle();
  double first = 0;
  for (int i = 0; i < 500; ++i) {
    ScoredRobot scored{robot_at(arm, q, 1e-3, RobotTime{1'000'000'000 + 20'000'000LL * i}), {}};
    scored.shown.settling = i < 400;
    scored.truth = scored.shown.position;
    const double sigma = tool.show(scored.shown).sigma;
    tool.score(scored);
    if (i == 0) first = sigma;
    if (i == 400) {
      EXPECT_EQ(sigma, first);
    } else if (i == 499) {
      EXPECT_LT(sigma, first) << "now it is learnt that all was exact";
    }
  }
}

TEST(FutureTool, OnlyWhatWasShownIsScored) {
  const ArmChain arm = lab_arm();
  FutureTool tool(arm, names_of(arm), "test");
  const PredictedRobot robot = robot_at(arm, arm.middle(), 1e-3, RobotTime{5'000'000});
  EXPECT_FALSE(tool.score({robot, robot.position}));
  PredictedRobot invalid = robot;
  invalid.status = StateStatus::invalid;
  EXPECT_TRUE(std::isinf(tool.show(invalid).sigma));
  EXPECT_FALSE(tool.score({robot, robot.position}));
  tool.show(robot);
  const auto error = tool.score({robot, robot.position});
  ASSERT_TRUE(error);
  EXPECT_EQ(error->position, 0);
  EXPECT_EQ(error->rotation, 0);
  EXPECT_FALSE(tool.score({robot, robot.position})) << "once";
  EXPECT_THROW(FutureTool(arm, std::vector<std::string>{"finger"}, "test"), InputError);
}

TEST(FutureTool, PixelsAreThoseOfTheCamera) {
  const Lens lens({LensModel::plumb_bob, 640, 480, 500, 500, 319.5, 239.5, {}});
  Pose T_camera_base = Pose::Identity();
  T_camera_base.translation() = Eigen::Vector3d(0, 0, 2);
  Pose shown = Pose::Identity(), seen = Pose::Identity();
  seen.translation() = Eigen::Vector3d(0.004, 0, 0);
  EXPECT_NEAR(pixel_error(lens, T_camera_base, shown, seen).value(), 1, 1e-9);
  T_camera_base.translation() = Eigen::Vector3d(0, 0, -2);
  EXPECT_FALSE(pixel_error(lens, T_camera_base, shown, seen)) << "behind the camera";
}

}  // namespace
}  // namespace foresight::future_tool_test
