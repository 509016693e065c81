#include "calibration/robot/robot_poses.hpp"

#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::robot_poses_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kMatrix = "0 -1 0 0.1\n1 0 0 0.2\n0 0 1 0.3\n0 0 0 1\n";

RobotPoses read(const TempFolder& folder, const std::string& text) {
  return read_robot_poses(folder.write("poses.txt", text), PoseUnit::automatic);
}

TEST(RobotPoses, ReadsEveryForm) {
  TempFolder folder;
  const Pose expected = read(folder, kMatrix).poses.at(0).pose;
  EXPECT_TRUE(expected.translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_TRUE((expected.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  for (const std::string& text :
       {"2\n" + kMatrix + "\n" + kMatrix,
        std::string(
            "0,-1,0,0.1,1,0,0,0.2,0,0,1,0.3,0,0,0,1\r\n# a remark\n[0 -1 0 0.1; 1 0 0 0.2; 0 0 1 0.3; 0 0 0 1]\n"),
        std::string(
            "x y z qx qy qz qw\n0.1 0.2 0.3 0 0 0.70710678 0.70710678\n0.1 0.2 0.3 0 0 -0.70710678 -0.70710678"),
        std::string("a.png 0.1 0.2 0.3 0 0 0.70710678 0.70710678\n7,0.1,0.2,0.3,0,0,0.70710678,0.70710678")}) {
    const RobotPoses poses = read(folder, text);
    ASSERT_EQ(poses.poses.size(), 2u) << text;
    for (const NamedPose& named : poses.poses) EXPECT_LT(step_between(named.pose, expected).norm(), 1e-7) << text;
  }
}

TEST(RobotPoses, ReadsAFolderInNaturalOrder) {
  TempFolder folder;
  for (const int i : {10, 2, 1})
    folder.write("poses/" + std::to_string(i) + ".yaml",
                 "x: " + std::to_string(i) + "\ny: 0\nz: 0\nqx: 0\nqy: 0\nqz: 0\nqw: 1\n");
  const RobotPoses poses = read_robot_poses(folder / "poses", PoseUnit::automatic);
  ASSERT_EQ(poses.poses.size(), 3u);
  EXPECT_EQ(poses.poses[1].pose.translation().x(), 2);
  EXPECT_EQ(poses.poses[2].name, "10");
}

TEST(RobotPoses, TakesMillimetresAndSaysSo) {
  TempFolder folder;
  const std::string row = "500 200 300 0 0 0 1\n";
  const RobotPoses poses = read(folder, row + row);
  EXPECT_NEAR(poses.poses[0].pose.translation().x(), 0.5, 1e-12);
  EXPECT_THAT(poses.notes, testing::Contains(HasSubstr("millimetres")));
  EXPECT_EQ(read_robot_poses(folder / "poses.txt", PoseUnit::metre).poses[0].pose.translation().x(), 500);
}

TEST(RobotPoses, RefusesMetresThatAreSaidToBeMillimetres) {
  TempFolder folder;
  folder.write("poses.txt", "0.5 0.2 0.3 0 0 0 1\n0.5 0.2 0.3 0 0 0 1\n");
  EXPECT_THAT(input_error([&] { read_robot_poses(folder / "poses.txt", PoseUnit::millimetre); }),
              AllOf(HasSubstr("poses.txt"), HasSubstr("--pose-unit m")));
}

TEST(RobotPoses, NamesFileAndLineOfWhatIsWrong) {
  TempFolder folder;
  const auto error = [&](const std::string& text) { return input_error([&] { read(folder, text); }); };
  EXPECT_THAT(error("1 2 3 0 0 0 1\n1 2 3 0 0 0\n"), AllOf(HasSubstr("poses.txt:2"), HasSubstr("has 6 fields")));
  EXPECT_THAT(error("1 0 0 0\n0 1 0 0\n0 0 1 0\n"), HasSubstr("the last matrix has 3 rows"));
  EXPECT_THAT(error("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"),
              AllOf(HasSubstr("poses.txt:1"), HasSubstr("no rotation and translation")));
  EXPECT_THAT(error("-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), HasSubstr("it mirrors"));
  EXPECT_THAT(error("1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n"), HasSubstr("last row"));
  EXPECT_THAT(error("1 2 3 0 0 0 0.5\n"), HasSubstr("quaternion has length 0.5"));
  EXPECT_THAT(error("1 2 nan 0 0 0 1\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(error("# nothing\n"), HasSubstr("holds no pose"));
  EXPECT_THAT(read(folder, "1 2 3 0.99 0.1 0.1 0\n1 2 3 0.99 0 0.1 0.1\n1 2 3 0.98 0.1 0 0.17\n").notes,
              testing::Contains(HasSubstr("qw qx qy qz")));
}

TEST(RobotPoses, MatchesByNameNumberAndOrder) {
  const auto named = [](const std::string& name, double x) {
    NamedPose pose{name, "", Pose::Identity()};
    pose.pose.translation().x() = x;
    return pose;
  };
  const std::vector<NamedPose> poses{named("0", 0), named("1", 1), named("2", 2), named("10", 10)};
  MatchedPoses match = match_poses(poses, {"1", "10"}, {"10", "1"});
  EXPECT_EQ(match.how, "by name");
  EXPECT_EQ(match.poses[0].translation().x(), 10);
  match = match_poses(poses, {"img_01.png", "img_02.png"}, {"img_02.png"});
  EXPECT_EQ(match.how, "by number");
  EXPECT_EQ(match.poses[0].translation().x(), 2);
  const std::vector<NamedPose> unnamed{named("", 5), named("", 6), named("", 7)};
  match = match_poses(unnamed, {"a", "b", "c"}, {"c", "a"});
  EXPECT_EQ(match.how, "by order");
  EXPECT_EQ(match.poses[0].translation().x(), 7);
  EXPECT_THAT(input_error([&] { match_poses(unnamed, {"a", "b"}, {"a"}); }), HasSubstr("3 poses for 2 images"));
}

}  // namespace
}  // namespace foresight::robot_poses_test
