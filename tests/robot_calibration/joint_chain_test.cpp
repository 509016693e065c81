#include "calibration/robot/joint_chain.hpp"

#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::joint_chain_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::filesystem::path arm() {
  return source_folder() / "configs/arm.urdf";
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
    const Vector6d step = step_between(robot.T_base_flange, jointed_pose(chain, q, offset, "test").T_base_flange);
    EXPECT_LT((step - 1e-3 * robot.flange_per_joint.col(static_cast<Eigen::Index>(i) - 1)).norm(), 3e-6) << i;
  }
}

TEST(JointChain, NamesWhatIsWrong) {
  EXPECT_THAT(input_error([] { read_joint_chain(arm(), "nowhere", ""); }),
              AllOf(HasSubstr("no link 'nowhere'"), HasSubstr("known are stand, arm_1")));
  JointChain chain = read_joint_chain(arm(), "", "");
  EXPECT_THAT(input_error([&] { flange_pose(chain, {0.1}, "row 3"); }),
              AllOf(HasSubstr("row 3"), HasSubstr("has 1 joint position;")));
}

}  // namespace
}  // namespace foresight::joint_chain_test
