#include "calibration/placement/tag_views.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::tag_views_test {
namespace {

using testing::HasSubstr;

constexpr const char* kModel = "7 0 0 0 0\n7 1 0.2 0 0\n7 2 0.2 0.2 0\n7 3 0 0.2 0\n9 0 0.5 0.1 0.3\n";

struct Lab {
  Lens lens{{LensModel::plumb_bob, 640, 480, 530, 531, 320, 241, {-0.2, 0.05, 0, 0, 0}}};
  std::map<std::string, Pose> poses;
  Pose T_world_model = Pose::Identity();

  Lab() {
    T_world_model.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    T_world_model.translation() = Eigen::Vector3d(0.1, -0.1, 2);
    for (int i = 0; i < 4; ++i) {
      Pose T = Pose::Identity();
      T.translation() = Eigen::Vector3d(0.3 * i - 0.5, 0.1 * (i % 2), 0);
      poses["im" + std::to_string(i) + ".png"] = T;
    }
  }

  std::vector<SeenCorner> seen(double noise) const {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, noise);
    std::vector<SeenCorner> out;
    const std::pair<long long, Eigen::Vector3d> corners[] = {
        {0, {0, 0, 0}}, {1, {0.2, 0, 0}}, {2, {0.2, 0.2, 0}}, {3, {0, 0.2, 0}}};
    for (const auto& [name, T] : poses) {
      for (const auto& [corner, p] : corners)
        out.push_back(
            {name, 7, corner,
             *lens.project(T.inverse() * (T_world_model * p)) + Eigen::Vector2d(normal(random), normal(random))});
      out.push_back({name, 9, 0,
                     *lens.project(T.inverse() * (T_world_model * Eigen::Vector3d(0.5, 0.1, 0.3))) +
                         Eigen::Vector2d(normal(random), normal(random))});
    }
    return out;
  }
};

TEST(TagViews, RaysMeetAtTheCorners) {
  const TempFolder folder;
  const Lab lab;
  const auto points = triangulate_tags(folder.write("m.txt", kModel), lab.seen(0), lab.poses, lab.lens, 0.5);
  ASSERT_EQ(points.size(), 5u);
  for (const PointPair& p : points) {
    EXPECT_LT((lab.T_world_model * p.p_model - p.p_world).norm(), 1e-6) << p.name;
    EXPECT_GT(p.sigma_m, 5e-4);
    EXPECT_LT(p.sigma_m, 1e-2);
  }
}

TEST(TagViews, NoisyCornersPlaceTheModel) {
  const TempFolder folder;
  const Lab lab;
  const auto points = triangulate_tags(folder.write("m.txt", kModel), lab.seen(0.3), lab.poses, lab.lens, 0.3);
  const PlacementSummary summary = place_model(points);
  EXPECT_LT(
      (summary.T_world_model * Eigen::Vector3d(0.1, 0.1, 0) - lab.T_world_model * Eigen::Vector3d(0.1, 0.1, 0)).norm(),
      3 * summary.sigma_position_m);
}

TEST(TagViews, ReadsItsFilesAndNamesWhatIsWrong) {
  const TempFolder folder;
  const Lab lab;
  EXPECT_EQ(read_seen_corners(folder.write("s.txt", "im0.png 7 3 10.5 20\n")).at(0).pixel.x(), 10.5);
  EXPECT_THROW(read_seen_corners(folder.write("t.txt", "im0.png 7 4 10.5 20\n")), InputError);
  EXPECT_EQ(read_image_poses(folder.write("p.txt", "im0.png 1 2 3 0 0 0 1\n")).at("im0.png").translation().z(), 3);
  const auto refusal = [&](std::vector<SeenCorner> seen) -> std::string {
    try {
      triangulate_tags(folder.write("m.txt", kModel), seen, lab.poses, lab.lens, 0.5);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  auto seen = lab.seen(0);
  EXPECT_THAT(refusal({seen[0]}), HasSubstr("two places"));
  EXPECT_THAT(refusal({seen[0], seen[0]}), HasSubstr("two places")) << "parallel rays meet nowhere";
  seen[0].image = "im0.jpg";
  EXPECT_THAT(refusal(seen), HasSubstr("'im0.png'"));
}

}  // namespace
}  // namespace foresight::tag_views_test
