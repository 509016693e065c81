#include "display/head/eye_geometry.hpp"

#include <limits>
#include <random>

#include "common/rotation.hpp"
#include "input/room_axes.hpp"

namespace foresight::eye_geometry_test {
namespace {

using head::EyeFov;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Pose pose(const Eigen::Vector3d& p, const Eigen::AngleAxisd& turn) {
  Pose out = Pose::Identity();
  out.translation() = p;
  out.linear() = turn.toRotationMatrix();
  return out;
}

TEST(RoomAxes, TurnXRightYUpZBackIntoForwardLeftUp) {
  Pose T_room = Pose::Identity();
  T_room.translation() = Eigen::Vector3d(1, 2, -3);  // right, up, ahead
  EXPECT_TRUE(from_room_axes(T_room).translation().isApprox(Eigen::Vector3d(3, -1, 2)));
  T_room.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();  // looks to the left
  const Pose T = from_room_axes(T_room);
  EXPECT_TRUE(T.linear().isApprox(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  EXPECT_TRUE(to_room_axes(T).isApprox(T_room));
}

TEST(EyeGeometry, TakesPosesOnlyWhereTheyAreSome) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()));
  ASSERT_TRUE(head::checked_pose({0, 1, 0}, turn));
  EXPECT_TRUE(is_rigid(*head::checked_pose({0, 1, 0}, Eigen::Quaterniond(1.004 * turn.coeffs()))));
  EXPECT_FALSE(head::checked_pose({0, kNan, 0}, turn));
  EXPECT_FALSE(head::checked_pose({0, 1e30, 0}, turn));
  EXPECT_FALSE(head::checked_pose({0, 1, 0}, Eigen::Quaterniond(0, 0, 0, 0)));
  EXPECT_FALSE(head::checked_pose({0, 1, 0}, Eigen::Quaterniond(kNan, 0, 0, 0)));
  EXPECT_FALSE(head::checked_pose({0, 1, 0}, Eigen::Quaterniond(0.5 * turn.coeffs())));
}

TEST(EyeGeometry, TakesViewsOnlyWhereTheyShowSomething) {
  EXPECT_TRUE(head::checked_fov({-0.8, 0.7, 0.6, -0.9}));
  EXPECT_TRUE(head::checked_fov({0.1, 0.9, 0.9, 0.2})) << "all of it to one side";
  EXPECT_FALSE(head::checked_fov({0, 0, 0, 0}));
  EXPECT_FALSE(head::checked_fov({0.7, -0.8, 0.6, -0.9}));
  EXPECT_FALSE(head::checked_fov({-0.8, 0.7, -0.9, 0.6}));
  EXPECT_FALSE(head::checked_fov({-1.6, 0.7, 0.6, -0.9}));
  EXPECT_FALSE(head::checked_fov({-0.8, kNan, 0.6, -0.9}));
}

TEST(EyeGeometry, ALensShowsExactlyWhatTheEyeSees) {
  const EyeFov fov{-0.8, 0.6, 0.7, -0.5};
  const Lens lens = head::eye_lens(fov, 320, 200);
  const auto at = [&](double right, double up) { return lens.project({std::tan(right), -std::tan(up), 1}).value(); };
  EXPECT_TRUE(at(fov.left, fov.up).isApprox(Eigen::Vector2d(-0.5, -0.5), 1e-9)) << "the corner of the first pixel";
  EXPECT_TRUE(at(fov.right, fov.down).isApprox(Eigen::Vector2d(319.5, 199.5), 1e-9));
}

TEST(EyeGeometry, PutsTheHeadWhereTheCameraIs) {
  std::mt19937 random(1);
  std::uniform_real_distribution some(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const auto any = [&] {
      const Eigen::Vector3d axis(some(random), some(random), some(random));
      return pose({some(random), some(random), some(random)}, Eigen::AngleAxisd(some(random), axis.normalized()));
    };
    const Pose T_world_body = any(), T_space_head = any();
    const Pose T_world_space = head::T_world_space_for(T_world_body * head::T_body_camera(), T_space_head);
    EXPECT_TRUE(T_world_space.linear().col(2).isApprox(Eigen::Vector3d::UnitZ())) << "up stays up";
    const Pose T_world_head = T_world_space * T_space_head;
    EXPECT_LT((T_world_head.translation() - T_world_body.translation()).norm(), 1e-12);
    const Eigen::Vector3d looks = T_world_head.linear().col(0), camera = T_world_body.linear().col(0);
    EXPECT_NEAR(looks.head<2>().normalized().dot(camera.head<2>().normalized()), 1, 1e-12);
  }
}

TEST(EyeGeometry, KnowsForwardOfACameraThatLooksDown) {
  Pose T_world_camera = Pose::Identity();
  T_world_camera.linear().col(0) = -Eigen::Vector3d::UnitY();  // right in the image
  T_world_camera.linear().col(1) = -Eigen::Vector3d::UnitX();  // down in it: its top is towards x
  T_world_camera.linear().col(2) = -Eigen::Vector3d::UnitZ();
  ASSERT_NEAR(T_world_camera.linear().determinant(), 1, 1e-12);
  const Pose T_world_space = head::T_world_space_for(T_world_camera, Pose::Identity());
  EXPECT_TRUE(T_world_space.linear().isIdentity(1e-12));
}

}  // namespace
}  // namespace foresight::eye_geometry_test
