#include "calibration/robot/hand_eye.hpp"

#include "calibration/robot/hand_eye_start.hpp"
#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::hand_eye_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

HandEyeOptions quick() {
  HandEyeOptions options;
  options.score = false;
  return options;
}

// Without noise nothing but rounding may be left.
TEST(HandEye, RecoversARigWithoutNoise) {
  Random random(1);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    const HandEyeRig rig = make_rig(random, {.mount = mount, .noise_px = 1e-6, .noise_rad = 0, .noise_m = 0});
    const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
    EXPECT_EQ(summary.mount, mount);
    EXPECT_LT(step_between(summary.X, rig.X).norm(), 1e-5);
    EXPECT_LT(step_between(summary.Y, rig.Y).norm(), 1e-5);
    EXPECT_NEAR(summary.camera.lens[0], rig.camera.lens[0], 0.01);
    EXPECT_NEAR(summary.board_scale, 1, 1e-5);
    EXPECT_EQ(summary.rejected_points, 0);
  }
}

TEST(HandEye, FindsNoiseAndBoardSize) {
  Random random(2);
  HandEyeRig rig =
      make_rig(random, {.views = 30, .cols = 8, .rows = 6, .noise_px = 0.3, .noise_rad = 1e-3, .noise_m = 5e-4});
  for (Eigen::Vector3d& p : rig.data.corners.p_board) p /= 1.006;  // the print is larger than it says
  const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
  EXPECT_NEAR(summary.board_scale, 1.006, 3 * summary.board_scale_sigma);
  EXPECT_LT(summary.board_scale_sigma, 0.002);
  EXPECT_NEAR(summary.sigma_px, 0.3, 0.03);
  EXPECT_NEAR(summary.sigma_robot_rad, 1e-3, 3e-4);
  EXPECT_NEAR(summary.sigma_robot_m, 5e-4, 2e-4);
}

// Of a small board far away: what one image says of its tilt and distance is far worse than an exact robot.
TEST(HandEye, DoesNotTakeTheCamerasNoiseForTheRobots) {
  for (const std::uint64_t seed : {21u, 22u, 23u}) {
    Random random(seed);
    const HandEyeRigOptions exact{.views = 13, .cols = 6, .rows = 5, .size_m = 0.02, .noise_rad = 0, .noise_m = 0};
    const HandEyeSummary summary = solve_hand_eye(make_rig(random, exact).data, quick());
    EXPECT_LT(summary.sigma_robot_m, 1e-4) << seed;
    EXPECT_LT(summary.sigma_robot_rad, 2e-4) << seed;
    EXPECT_NEAR(summary.sigma_px, 0.2, 0.03) << seed;
  }
}

// What is left out is predicted about as well as the noise of robot and corners allows, and worse than in sample.
TEST(HandEye, LeftOutErrorIsAboveInSampleError) {
  Random random(3);
  const HandEyeSummary summary = solve_hand_eye(make_rig(random, {}).data, {});
  EXPECT_GT(summary.loo_px, summary.in_sample_px);
  EXPECT_GT(summary.loo_px, summary.uncorrected_px);
  EXPECT_LT(summary.loo_px, 3 * summary.uncorrected_px);
  EXPECT_GT(summary.loo_mm, summary.loo_across_mm);
}

TEST(HandEye, LeavesOutAWrongRobotPoseByName) {
  Random random(4);
  HandEyeRig rig = make_rig(random, {});
  rig.data.poses[5].T_base_flange = rig.data.poses[5].T_base_flange * random_pose(random, 0.3, 0.05);
  const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
  EXPECT_FALSE(summary.views[5].used);
  EXPECT_THAT(summary.notes, testing::Contains(HasSubstr("view5")));
  EXPECT_LT(in_sigmas(summary.X, rig.X, summary.X_sigma).cwiseAbs().maxCoeff(), 5);
}

// Two poses that changed places draw a least-squares hand-eye so far that neither stands out from it.
TEST(HandEye, NamesPosesThatChangedPlaces) {
  Random random(14);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    HandEyeRig rig = make_rig(random, {.mount = mount});
    EXPECT_TRUE(solve_hand_eye(rig.data, quick()).verdict.usable());
    std::swap(rig.data.poses[3], rig.data.poses[9]);
    const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
    for (std::size_t v = 0; v < summary.views.size(); ++v) EXPECT_EQ(summary.views[v].used, v != 3 && v != 9) << v;
    EXPECT_LT(in_sigmas(summary.X, rig.X, summary.X_sigma).cwiseAbs().maxCoeff(), 5);
    EXPECT_FALSE(summary.verdict.usable());
    EXPECT_THAT(summary.verdict.text(), HasSubstr("robot poses of views view3 and view9 are exchanged"));
    EXPECT_THAT(summary.notes, testing::Contains(AllOf(HasSubstr("view view3 is left out"), HasSubstr(" mm and "))));
  }
}

TEST(HandEye, ObjectsToManyWrongPosesAndToRowsThatSlipped) {
  Random random(15);
  const HandEyeRig rig = make_rig(random, {.views = 15});
  HandEyeData wrong = rig.data;
  for (const std::size_t v : {1u, 4u, 8u, 11u})
    wrong.poses[v].T_base_flange = wrong.poses[v].T_base_flange * random_pose(random, 0.5, 0.1);
  const HandEyeSummary four = solve_hand_eye(wrong, quick());
  EXPECT_THAT(four.verdict.text(), HasSubstr("4 of 15 robot poses contradict the others"));
  EXPECT_LT(in_sigmas(four.X, rig.X, four.X_sigma).cwiseAbs().maxCoeff(), 5);

  HandEyeData late = rig.data;
  std::rotate(late.poses.begin(), late.poses.begin() + 1, late.poses.end());
  HandEyeOptions fixed = quick();
  fixed.mount = CameraMount::fixed;
  const HandEyeSummary slipped = solve_hand_eye(late, fixed);
  EXPECT_THAT(slipped.verdict.text(), HasSubstr("each image fits the pose before its own"));
}

TEST(HandEye, RejectsWrongCornersAndCountsThem) {
  Random random(5);
  HandEyeRig rig = make_rig(random, {});
  for (const std::size_t v : {1u, 4u, 9u}) rig.data.corners.views[v].corners[7].pixel += Eigen::Vector2d(6, -4);
  const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
  EXPECT_GE(summary.rejected_points, 3);
  EXPECT_LE(summary.rejected_points, 5);
  for (const std::size_t v : {1u, 4u, 9u}) EXPECT_GE(summary.views[v].rejected, 1);
}

// A grid that looks the same when turned: each view may come in any of the orders.
TEST(HandEye, ResolvesTheOrderOfSymmetricBoardsByTheRobot) {
  Random random(6);
  for (const auto& [cols, rows] : {std::pair{6, 4}, std::pair{5, 5}}) {
    HandEyeRig rig = make_rig(random, {.mount = CameraMount::moving, .cols = cols, .rows = rows});
    const auto turns = board_turns(rig.data.corners.p_board, cols, rows);
    ASSERT_EQ(turns.size(), cols == rows ? 4u : 2u);
    for (std::size_t v = 0; v < rig.data.corners.views.size(); v += 3) {
      auto& corners = rig.data.corners.views[v].corners;
      const auto& order = turns[1 + v % (turns.size() - 1)].order;
      for (Corner& corner : corners) corner.index = order[static_cast<std::size_t>(corner.index)];
      std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.index < b.index; });
    }
    rig.data.cols = cols, rig.data.rows = rows;
    const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
    EXPECT_LT(summary.uncorrected_px, 5);
    // All views may be turned alike: that moves the board's frame in itself, not the camera.
    EXPECT_LT(in_sigmas(summary.X, rig.X, summary.X_sigma).cwiseAbs().maxCoeff(), 4);
  }
}

// The mount that the user forces must not be the one that the images contradict; poses the other way round look the
// same.
TEST(HandEye, RefusesAForcedMountThatContradictsTheImages) {
  Random random(10);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    const CameraMount other = mount == CameraMount::fixed ? CameraMount::moving : CameraMount::fixed;
    HandEyeRig rig = make_rig(random, {.mount = mount});
    HandEyeOptions options = quick();
    options.mount = mount;
    EXPECT_LT(step_between(solve_hand_eye(rig.data, options).X, rig.X).norm(), 0.02);
    options.mount = other;
    EXPECT_THAT(input_error([&] { solve_hand_eye(rig.data, options); }),
                AllOf(HasSubstr("--camera-mount " + to_string(other)), HasSubstr("contradicts"),
                      HasSubstr("say --camera-mount " + to_string(mount)), HasSubstr("--invert-poses")));
    for (RobotPose& pose : rig.data.poses) pose.T_base_flange = pose.T_base_flange.inverse();
    EXPECT_LT(solve_hand_eye(rig.data, options).uncorrected_px, 5);
    EXPECT_THAT(solve_hand_eye(rig.data, quick()).notes, testing::Contains(HasSubstr("from flange to base")));
  }
}

TEST(HandEye, NamesTheReadingOfThePosesThatWasMeant) {
  Random random(11);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    const HandEyeRig rig = make_rig(random, {.mount = mount});
    HandEyeData w_first = rig.data, transposed = rig.data;
    for (std::size_t v = 0; v < rig.data.poses.size(); ++v) {
      const Eigen::Quaterniond q(rig.data.poses[v].T_base_flange.linear());
      w_first.poses[v].T_base_flange.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
      transposed.poses[v].T_base_flange.linear().transposeInPlace();
    }
    EXPECT_THAT(input_error([&] { solve_hand_eye(w_first, quick()); }), HasSubstr("qw qx qy qz"));
    EXPECT_THAT(input_error([&] { solve_hand_eye(transposed, quick()); }), HasSubstr("transposed"));
  }
}

// A board of squares is found in a mirrored picture as well: its points then come in the order of one that is turned
// over.
TEST(HandEye, NamesMirroredPictures) {
  Random random(15);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    const HandEyeRigOptions options{.mount = mount};
    HandEyeRig rig = make_rig(random, options);
    for (BoardView& view : rig.data.corners.views) {
      for (Corner& corner : view.corners) {
        corner.pixel.x() = rig.camera.width - 1 - corner.pixel.x();
        corner.index += options.cols - 1 - 2 * (corner.index % options.cols);
      }
      std::ranges::sort(view.corners, {}, &Corner::index);
    }
    EXPECT_THAT(input_error([&] { solve_hand_eye(rig.data, quick()); }), HasSubstr("mirrored"));
  }
}

TEST(HandEye, NamesTheOtherUnit) {
  Random random(12);
  HandEyeRig rig = make_rig(random, {});
  HandEyeData millimetres = rig.data;
  for (RobotPose& pose : millimetres.poses) pose.T_base_flange.translation() *= 1000;
  EXPECT_THAT(input_error([&] { solve_hand_eye(millimetres, quick()); }), HasSubstr("--pose-unit mm"));
  for (Eigen::Vector3d& p : rig.data.corners.p_board) p *= 1000;
  EXPECT_THAT(input_error([&] { solve_hand_eye(rig.data, quick()); }), HasSubstr("--board"));
}

TEST(HandEye, NamesABoardOfAnotherSize) {
  Random random(14);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    HandEyeRig rig = make_rig(random, {.mount = mount});
    for (Eigen::Vector3d& p : rig.data.corners.p_board) p *= 1.05;
    EXPECT_THAT(solve_hand_eye(rig.data, quick()).notes, testing::Contains(HasSubstr("the board has 0.95")));
    for (Eigen::Vector3d& p : rig.data.corners.p_board) p *= 1.5 / 1.05;
    EXPECT_THAT(input_error([&] { solve_hand_eye(rig.data, quick()); }),
                AllOf(HasSubstr("--board"), HasSubstr("it has 0.66"), HasSubstr("measure")));
  }
}

// Two of 16 poses are 8 times as noisy: too little to be thrown out by name, too much for a normal noise.
TEST(HandEye, WildRobotPosesCountLess) {
  Random random(13);
  HandEyeRig rig = make_rig(random, {.views = 16});
  for (const std::size_t v : {3u, 9u})
    rig.data.poses[v].T_base_flange = noisy(rig.data.poses[v].T_base_flange, random, 4e-3, 2e-3);
  const HandEyeSummary summary = solve_hand_eye(rig.data, quick());
  for (std::size_t v = 0; v < 16; ++v) {
    if (!summary.views[v].used) continue;
    EXPECT_EQ(summary.views[v].trust < 0.5, v == 3 || v == 9) << v << " " << summary.views[v].trust;
  }
  const HandEyeSummary usual = solve_hand_eye(make_rig(random, {.views = 16}).data, quick());
  for (const HandEyeView& view : usual.views) EXPECT_EQ(view.trust, 1);
}

TEST(HandEye, NamesTheMissingMotion) {
  Random random(7);
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving})
    EXPECT_THAT(
        input_error([&] { solve_hand_eye(make_rig(random, {.mount = mount, .one_axis = true}).data, quick()); }),
        AllOf(HasSubstr("the wrist turned about one axis only"), HasSubstr("2 of 12"),
              HasSubstr("about another axis")));
  HandEyeRig still = make_rig(random, {});
  for (RobotPose& pose : still.data.poses) pose.T_base_flange.linear().setIdentity();
  EXPECT_THAT(input_error([&] { solve_hand_eye(still.data, quick()); }), HasSubstr("without turns"));
}

TEST(HandEye, RefusesTooLittle) {
  Random random(8);
  const HandEyeRig few = make_rig(random, {.views = 4});
  EXPECT_THAT(input_error([&] { solve_hand_eye(few.data, quick()); }), HasSubstr("found in 4 views only"));
  HandEyeRig uneven = make_rig(random, {});
  uneven.data.poses.pop_back();
  EXPECT_THAT(input_error([&] { solve_hand_eye(uneven.data, quick()); }), HasSubstr("13 robot poses for 14 views"));
  EXPECT_THAT(solve_hand_eye(make_rig(random, {.views = 8}).data, quick()).notes,
              testing::Contains(HasSubstr("only 8 views")));
}

// Moving the robot's base, or the flange's frame, moves X and Y with it and changes no residual.
TEST(HandEye, ResidualsDoNotDependOnTheFramesOfTheRobot) {
  Random random(9);
  const HandEyeRig rig = make_rig(random, {});
  const Pose base = random_pose(random, 3, 0.5);
  HandEyeData moved_base = rig.data;
  for (RobotPose& pose : moved_base.poses) pose.T_base_flange = base * pose.T_base_flange;
  const HandEyeSummary a = solve_hand_eye(rig.data, quick()), b = solve_hand_eye(moved_base, quick());
  EXPECT_NEAR(a.in_sample_px, b.in_sample_px, 1e-6);
  EXPECT_LT(step_between(base * a.X, b.X).norm(), 1e-5);
  EXPECT_LT(step_between(a.Y, b.Y).norm(), 1e-5);
}

}  // namespace
}  // namespace foresight::hand_eye_test
