#include "calibration/robot/joint_chain.hpp"

#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::filesystem::path arm() {
  return std::filesystem::path(FORESIGHT_SOURCE_DIR) / "configs/arm.urdf";
}

// A fixed camera before an arm whose joints stand `offsets` away from what they report.
struct JointRig {
  HandEyeRig rig;
  std::vector<std::vector<double>> rows;
};

JointRig make_joint_rig(JointChain& chain, const std::vector<double>& offsets, Random& random) {
  JointRig out{make_rig(random, {.views = 1}), {}};
  HandEyeRig& rig = out.rig;
  rig.data.corners.views.clear(), rig.data.poses.clear();
  const std::size_t n = chain.joints.size();
  const auto true_pose = [&](std::vector<double> q) {
    for (std::size_t i = 0; i < n; ++i) q[i] += offsets[i];
    return flange_pose(chain, q, "test");
  };
  const std::vector<double> home(n, 0.4);
  Pose T_camera_board = Pose::Identity();
  T_camera_board.translation() = Eigen::Vector3d(-0.07, -0.05, 0.8);
  rig.X = true_pose(home) * rig.Y * T_camera_board.inverse();
  std::uniform_real_distribution<double> step(-0.5, 0.5);
  for (int tries = 0; tries < 20000 && out.rows.size() < 25; ++tries) {
    std::vector<double> q = home;
    for (double& value : q) value += step(random);
    const Pose T = rig.X.inverse() * true_pose(q) * rig.Y;
    BoardView view{"view" + std::to_string(out.rows.size()), {}};
    for (std::size_t i = 0; i < rig.data.corners.p_board.size(); ++i) {
      Eigen::Vector2d pixel(-1, -1);
      project<double>(rig.camera.distortion, rig.camera.lens.data(), T * rig.data.corners.p_board[i], pixel);
      if (pixel.minCoeff() < 0 || pixel.x() > 1280 || pixel.y() > 960) break;
      const double x = normal(random, 0.1), y = normal(random, 0.1);
      view.corners.push_back({static_cast<int>(i), pixel + Eigen::Vector2d(x, y), 1});
    }
    if (view.corners.size() < rig.data.corners.p_board.size() || T.linear()(2, 2) < 0.6) continue;
    rig.data.corners.views.push_back(view);
    out.rows.push_back(q);
  }
  return out;
}

TEST(JointChain, RecoversJointOffsets) {
  JointChain chain = read_joint_chain(arm(), "", "");
  ASSERT_GE(chain.joints.size(), 5u);
  std::vector<double> offsets(chain.joints.size(), 0.0);
  for (std::size_t i = 1; i + 1 < offsets.size(); ++i) offsets[i] = i % 2 == 0 ? 0.012 : -0.008;
  Random random(51);
  const JointRig made = make_joint_rig(chain, offsets, random);
  ASSERT_EQ(made.rows.size(), 25u);
  HandEyeOptions options;
  options.score = false;
  options.mount = CameraMount::fixed;
  options.board_sigma = 0;
  const HandEyeSummary summary = solve_with_joints(chain, made.rows, made.rig.data, options);
  ASSERT_EQ(summary.joint_offsets.size(), offsets.size());
  EXPECT_EQ(summary.joint_offsets.front(), 0);
  EXPECT_EQ(summary.joint_offsets.back(), 0);
  for (std::size_t i = 1; i + 1 < offsets.size(); ++i) {
    EXPECT_NEAR(summary.joint_offsets[i], offsets[i], 4 * summary.joint_offset_sigma[i] + 1e-5) << i;
    EXPECT_LT(summary.joint_offset_sigma[i], 4e-3) << i;
  }
}

TEST(JointChain, DerivativesAgreeWithDifferences) {
  JointChain chain = read_joint_chain(arm(), "", "");
  const std::size_t n = chain.joints.size();
  const std::vector<double> q(n, 0.3), none(n, 0.0);
  const RobotPose robot = jointed_pose(chain, q, none, "test");
  for (std::size_t i = 1; i + 1 < n; ++i) {
    std::vector<double> offset = none;
    offset[i] = 1e-3;
    const Vector6 step = step_between(robot.T_base_flange, jointed_pose(chain, q, offset, "test").T_base_flange);
    EXPECT_LT((step - 1e-3 * robot.flange_per_joint.col(static_cast<Eigen::Index>(i) - 1)).norm(), 3e-6) << i;
  }
}

TEST(JointChain, NamesWhatIsWrong) {
  EXPECT_THAT(input_error([] { read_joint_chain(arm(), "nowhere", ""); }),
              AllOf(HasSubstr("no link 'nowhere'"), HasSubstr("did you mean")));
  JointChain chain = read_joint_chain(arm(), "", "");
  EXPECT_THAT(input_error([&] { flange_pose(chain, {0.1}, "row 3"); }),
              AllOf(HasSubstr("row 3"), HasSubstr("has 1 joint positions")));
}

}  // namespace
}  // namespace foresight
