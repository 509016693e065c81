#include "prediction/sighting/tag_fit.hpp"

#include <numeric>
#include <random>

#include "common/statistics.hpp"
#include "prediction/arm_chain.hpp"

namespace foresight::tag_fit_test {
namespace {

const Lens& lens() {
  static const Lens built({LensModel::plumb_bob, 640, 480, 525, 525, 320, 240, {-0.2, 0.05, 0.001, 0, 0}});
  return built;
}

Pose pose(const Eigen::Vector3d& p, double angle, const Eigen::Vector3d& axis) {
  Pose out = Pose::Identity();
  out.translation() = p;
  out.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return out;
}

/// A tag on the front of a box, before two cameras 65 mm apart.
struct Room {
  ThingTag tag{5, 0.036, pose({0.02, 0.01, 0.03}, 0.7, {1, 0.4, 0.2})};
  Pose T_world_camera[2] = {pose({1, 2, 0.5}, 2.1, {1, 0.1, 0}), Pose::Identity()};
  Pose T_world_thing;
  std::mt19937 random{11};

  Room() {
    T_world_camera[1] = T_world_camera[0];
    T_world_camera[1].translate(Eigen::Vector3d(0.065, 0, 0));
    // The print faces the cameras, a little aslant.
    Pose T_camera_tag = pose({0.03, -0.04, 0.7}, 2.6, {1, 0.1, 0.2});
    T_world_thing = T_world_camera[0] * T_camera_tag * tag.T_thing_tag.inverse();
  }
  std::vector<DetectedTag> seen(int camera, double noise_px) {
    std::normal_distribution<double> noise(0, noise_px);
    DetectedTag out;
    out.id = tag.id;
    const double h = tag.side / 2;
    const Eigen::Vector3d corners[] = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto pixel =
          lens().project(T_world_camera[camera].inverse() * T_world_thing * tag.T_thing_tag * corners[k]);
      out.corners[k] =
          *pixel + (noise_px > 0 ? Eigen::Vector2d(noise(random), noise(random)) : Eigen::Vector2d::Zero());
    }
    return {out};
  }
};

TEST(TagFit, IsExactFromExactCorners) {
  Room room;
  const auto left = room.seen(0, 0), right = room.seen(1, 0);
  const TagsSeenBy cameras[] = {{&lens(), room.T_world_camera[0], &left}, {&lens(), room.T_world_camera[1], &right}};
  for (std::size_t count : {1, 2}) {
    const auto fit = fit_tag(room.tag, std::span(cameras, count));
    ASSERT_TRUE(fit);
    EXPECT_LT(pose_difference(room.T_world_thing, fit->T_world_thing).norm(), 1e-6);
  }
}

TEST(TagFit, KnowsHowSureItIs) {
  Room room;
  std::vector<double> stretch, off;
  for (int i = 0; i < 300; ++i) {
    const auto left = room.seen(0, 0.15), right = room.seen(1, 0.15);
    const TagsSeenBy cameras[] = {{&lens(), room.T_world_camera[0], &left}, {&lens(), room.T_world_camera[1], &right}};
    const auto fit = fit_tag(room.tag, cameras);
    ASSERT_TRUE(fit);
    const Vector6d twist = to_twist(room.T_world_thing.inverse() * fit->T_world_thing);
    stretch.push_back(twist.dot(fit->covariance.ldlt().solve(twist)));
    off.push_back(twist.tail<3>().norm());
  }
  EXPECT_NEAR(std::accumulate(stretch.begin(), stretch.end(), 0.0) / 300, 6, 0.8)
      << "chi-square of six degrees of freedom";
  EXPECT_LT(quantile(off, 0.95), 0.004);
}

TEST(TagFit, SaysNothingOfOthersAndOfWhatCannotBe) {
  Room room;
  auto left = room.seen(0, 0);
  const std::vector<DetectedTag> none;
  const TagsSeenBy nobody[] = {{&lens(), room.T_world_camera[0], &none}};
  EXPECT_FALSE(fit_tag(room.tag, nobody));
  left[0].id = 6;
  const TagsSeenBy other[] = {{&lens(), room.T_world_camera[0], &left}};
  EXPECT_FALSE(fit_tag(room.tag, other));
  left[0].id = 5;
  for (auto& corner : left[0].corners) corner = {100, 100};
  EXPECT_FALSE(fit_tag(room.tag, other)) << "no square";
  left = room.seen(0, 0);
  std::swap(left[0].corners[0], left[0].corners[1]);
  EXPECT_FALSE(fit_tag(room.tag, other)) << "a square that is crossed over";
}

}  // namespace
}  // namespace foresight::tag_fit_test
