#include "calibration/placement/placement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::placement_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Example {
  Pose T_world_model = Pose::Identity();
  std::vector<PointPair> points;
};

Example example(int count, double noise, unsigned seed, bool flat = false) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Example out;
  out.T_world_model.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                                   .normalized()
                                   .toRotationMatrix();
  out.T_world_model.translation() = Eigen::Vector3d(3 * normal(random), 3 * normal(random), normal(random));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(normal(random), normal(random), flat ? 0 : 0.5 * normal(random));
    const Eigen::Vector3d n(normal(random), normal(random), normal(random));
    out.points.push_back({"point " + std::to_string(i + 1), p, out.T_world_model * p + noise * n, 0});
  }
  return out;
}

std::string refusal(const std::vector<PointPair>& points, const PlacementOptions& options = {}) {
  try {
    place_model(points, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Placement, IsExactWithoutNoise) {
  for (unsigned seed = 1; seed < 20; ++seed)
    for (const bool flat : {false, true}) {
      const Example e = example(3 + static_cast<int>(seed) % 5, 0, seed, flat);
      const PlacementSummary summary = place_model(e.points);
      EXPECT_LT((summary.T_world_model.matrix() - e.T_world_model.matrix()).norm(), 1e-9);
      EXPECT_LT(summary.rms_m, 1e-9);
    }
}

TEST(Placement, TheErrorLiesWithinItsSigma) {
  int position_inside = 0, rotation_inside = 0;
  constexpr int kRuns = 100;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Example e = example(8, 0.005, seed);
    const PlacementSummary s = place_model(e.points);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const PointPair& p : e.points) centre += p.p_model / 8;
    position_inside += (s.T_world_model * centre - e.T_world_model * centre).norm() < 2 * s.sigma_position_m;
    rotation_inside += Eigen::AngleAxisd(s.T_world_model.linear().transpose() * e.T_world_model.linear()).angle() <
                       2 * s.sigma_rotation_rad;
    EXPECT_GT(s.loo_m, s.rms_m);
  }
  // Two root-sums of three axes hold more than 95 %; half of them, as with a factor of two too small, would not pass.
  EXPECT_GE(position_inside, 93);
  EXPECT_GE(rotation_inside, 93);
  const PlacementSummary one = place_model(example(8, 0.005, 1).points);
  EXPECT_LT(one.sigma_position_m, 0.006);
  EXPECT_GT(one.sigma_position_m, 0.002);
}

TEST(Placement, NamesThePointThatIsOff) {
  Example e = example(6, 0.001, 4);
  e.points[2].p_world += Eigen::Vector3d(0.041, 0, 0);
  EXPECT_THAT(refusal(e.points, {.sigma_m = 0.002}), AllOf(HasSubstr("point 3 is 4"), HasSubstr("again")));
  e.points.erase(e.points.begin() + 2);
  EXPECT_EQ(refusal(e.points, {.sigma_m = 0.002}), "");
}

TEST(Placement, SuspectsTheUnit) {
  Example e = example(5, 0.001, 5);
  for (PointPair& p : e.points) p.p_model *= 1000;
  EXPECT_THAT(refusal(e.points), AllOf(HasSubstr("scale 0.0010 suspected"), HasSubstr("millimetres")));
  for (PointPair& p : e.points) p.p_model /= 25.4;
  EXPECT_THAT(refusal(e.points), HasSubstr("inches"));
  Example larger = example(5, 0.001, 6);
  for (PointPair& p : larger.points) p.p_model *= 1.4;
  EXPECT_THAT(refusal(larger.points), HasSubstr("0.714 times"));
}

TEST(Placement, RefusesMirroredModels) {
  Example e = example(7, 0.001, 7);
  for (PointPair& p : e.points) p.p_model.y() *= -1;
  EXPECT_THAT(refusal(e.points), HasSubstr("mirror"));
}

TEST(Placement, RefusesTooFewAndCollinearPoints) {
  Example e = example(2, 0, 8);
  EXPECT_THAT(refusal(e.points), HasSubstr("there are 2"));
  e = example(6, 0.001, 9);
  for (std::size_t i = 0; i < 6; ++i) {
    e.points[i].p_model = Eigen::Vector3d(0.3, 0.2, 0.1) * double(i);
    e.points[i].p_world = e.T_world_model * e.points[i].p_model;
  }
  EXPECT_THAT(refusal(e.points), HasSubstr("on a line"));
  for (PointPair& p : e.points) p.p_model.setZero();
  EXPECT_THAT(refusal(e.points), HasSubstr("one place"));
}

TEST(Placement, RefusesPointsInAnotherOrder) {
  Example e = example(6, 0.001, 10);
  std::rotate(e.points.begin(), e.points.begin() + 1, e.points.end());
  std::vector<PointPair> shifted = e.points;
  for (std::size_t i = 0; i < 6; ++i) shifted[i].p_world = e.points[(i + 1) % 6].p_world;
  EXPECT_NE(refusal(shifted), "");
}

TEST(Placement, ReadsPointsAndTags) {
  const TempFolder folder;
  const auto points =
      read_point_pairs(folder.write("p.txt", "# model world sigma\n0 0 0 1 0 0 0.002\n1 0 0 2 0 0 0.004\n"));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].sigma_m, 0.004);
  EXPECT_EQ(points[1].name, "point 2");
  EXPECT_EQ(read_point_pairs(folder.write("q.txt", "0 0 0 1 0 0\n")).at(0).sigma_m, 0);
  EXPECT_THROW(read_point_pairs(folder.write("r.txt", "0 0 0 1 0\n")), InputError);
  EXPECT_THROW(read_point_pairs(folder.write("s.txt", "0 0 0 1 0 x\n")), InputError);
  const auto tags = read_tag_pairs(folder.write("m.txt", "7 0 0 0 0\n7 1 1 0 0\n8 0 5 5 5\n"),
                                   folder.write("w.txt", "7 1 2 0 0\n7 0 1 0 0\n9 0 0 0 0\n"));
  ASSERT_EQ(tags.size(), 2u);
  EXPECT_EQ(tags[1].name, "tag 7 corner 1");
  EXPECT_EQ(tags[1].p_world.x(), 2);
  EXPECT_THROW(read_tag_pairs(folder / "m.txt", folder.write("v.txt", "9 0 0 0 0\n")), InputError);
  EXPECT_THROW(read_tag_pairs(folder / "m.txt", folder.write("u.txt", "7 4 0 0 0\n")), InputError);
}

}  // namespace
}  // namespace foresight::placement_test
