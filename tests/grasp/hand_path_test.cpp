#include "prediction/grasp/hand_path.hpp"

#include "common/error.hpp"
#include "tests/support/folders.hpp"

namespace foresight::hand_path_test {
namespace {

const InverseKinematics& arm() {
  static const InverseKinematics kinematics(read_arm_chain(source_folder() / "configs/arm.urdf", "arm_7"));
  return kinematics;
}

JointVector bent() {
  JointVector q(7);
  q << -0.1, 0.9, 0.4, 1.2, -0.6, 0.7, 0.3;
  return q;
}

Pose moved(const Pose& from, double x, double y, double z) {
  Pose out = from;
  out.pretranslate(Eigen::Vector3d(x, y, z));
  return out;
}

TEST(HandPath, GoesStraightFromStopToStopAndRestsThere) {
  const Pose start = arm().chain().tip_pose(bent());
  const HandStop stops[] = {{"there", moved(start, 0.05, -0.1, 0.02), 0.01, 1.5},
                            {"grip", moved(start, 0.05, -0.1, 0.02), 0.03, 1}};
  const HandPath path(arm(), bent(), 0.02, stops);
  EXPECT_NEAR(path.seconds(), 2.5, 1e-9);
  EXPECT_NEAR(path.reached(0), 1.5, 1e-9);
  EXPECT_TRUE(path.joints(-1) == bent());
  EXPECT_TRUE(arm().chain().tip_pose(path.joints(1.5)).isApprox(stops[0].T_base_tip, 1e-6));
  const Eigen::Vector3d line = (stops[0].T_base_tip.translation() - start.translation()).normalized();
  for (double t = 0; t <= 1.5; t += 0.05) {
    const Eigen::Vector3d off = arm().chain().tip_pose(path.joints(t)).translation() - start.translation();
    EXPECT_LT((off - off.dot(line) * line).norm(), 1e-5) << t;
    EXPECT_LT((path.joints(t + 0.004) - path.joints(t)).cwiseAbs().maxCoeff(), 0.01) << t;
  }
  EXPECT_NEAR(path.grip(1.5), 0.01, 1e-12);
  EXPECT_NEAR(path.grip(99), 0.03, 1e-12);
  EXPECT_TRUE(path.joints(1.5).isApprox(path.joints(99), 1e-9)) << "only the grip goes on";
}

TEST(HandPath, GoesByJointsWhereThatIsAskedFor) {
  const Pose start = arm().chain().tip_pose(bent());
  const HandStop stop{"far", moved(start, -0.2, 0.3, 0.1), 0.01, 2, true};
  const HandPath path(arm(), bent(), 0.02, {&stop, 1});
  EXPECT_TRUE(arm().chain().tip_pose(path.joints(2)).isApprox(stop.T_base_tip, 1e-6));
}

TEST(HandPath, SaysWhichStopCannotBeReached) {
  const Pose start = arm().chain().tip_pose(bent());
  const auto refuse = [&](const HandStop& stop) {
    try {
      const HandPath path(arm(), bent(), 0, {&stop, 1});
      ADD_FAILURE() << stop.name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(stop.name), std::string::npos) << error.what();
    }
  };
  refuse({"on the moon", moved(start, 5, 0, 0), 0, 1, true});
  refuse({"on mars", moved(start, 5, 0, 0), 0, 1});
  refuse({"at once", moved(start, 0.1, 0, 0), 0, 0.01});
  refuse({"never", start, 0, 0});
  refuse({"nowhere", start, 0, std::nan("")});
}

}  // namespace
}  // namespace foresight::hand_path_test
