// Which images are kept, and that nothing writes over one that somebody looks at.
#include "texture_gpu/kept_images.hpp"

#include <cmath>

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::kept_images_test {
namespace {

Pose at(double x, double z = 0, double turn = 0) {
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(x, 0, z);
  out.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return out;
}

TEST(ViewDistance, IsTheAngleBetweenLinesOfSight) {
  EXPECT_NEAR(view_distance(at(0), at(0.5), 2), std::atan2(0.5, 2), 1e-12);
  EXPECT_NEAR(view_distance(at(0), at(0, 0, 0.3), 2), 0.3, 1e-12);
  EXPECT_NEAR(view_distance(at(0), at(0, 0.4), 2), 0, 1e-12) << "nearer, from the same side";
}

ImageStand stand(double t, double x) {
  return {RobotTime{} + seconds(t), at(x), 1};
}

TEST(LeastNeeded, OfTwoThatAreAlikeIsTheNewerOneAsLongAsTheOtherIsNotOld) {
  EXPECT_EQ(least_needed(std::vector{stand(9, 0.5), stand(8.9, 0.4), stand(8.8, 0.38), stand(8.6, 0.1)}), 1u);
  EXPECT_EQ(least_needed(std::vector{stand(9, 0.5), stand(8.9, 0.4), stand(8.6, 0.1), stand(7.5, 0.38)}), 3u);
}

TEST(LeastNeeded, IsFirstWhatSeesSomethingElse) {
  EXPECT_EQ(least_needed(std::vector{stand(9, 0), stand(8, 5), stand(7, 0.1), stand(6, 0.1)}), 1u);
}

TEST(LeastNeeded, IsNeverTheNewest) {
  EXPECT_EQ(least_needed(std::vector{stand(1, 0), stand(0, 0)}), 1u);
  EXPECT_EQ(least_needed(std::vector{stand(1, 0), stand(0.9, 0), stand(0.8, 0.5)}), 1u);
}

TEST(AreAlikeInHue, AreCamerasThatDifferInBrightnessAlone) {
  const cv::Mat left(4, 4, CV_8UC3, cv::Scalar(80, 120, 160));
  EXPECT_TRUE(are_alike_in_hue(left, cv::Mat(6, 8, CV_8UC3, cv::Scalar(40, 60, 80))));
  EXPECT_FALSE(are_alike_in_hue(left, cv::Mat(6, 8, CV_8UC3, cv::Scalar(40, 60, 95))));
  EXPECT_TRUE(are_alike_in_hue(cv::Mat(4, 4, CV_8UC1, cv::Scalar(80)), cv::Mat(4, 4, CV_8UC1, cv::Scalar(20))));
}

class KeptImagesTest : public HeadlessTest {
 protected:
  static constexpr std::uint64_t kRoom = 1 << 30;
  static std::vector<double> times(const KeptImages& kept) {
    std::vector<double> out;
    for (const auto& image : kept.images()) out.push_back(to_seconds(image->image.time - RobotTime{}));
    return out;
  }
  std::shared_ptr<PublishedImage> image(double t, const Pose& T_world_camera) {
    auto out = std::make_shared<PublishedImage>();
    out->camera = camera_ ? camera_ : camera_ = std::make_shared<CameraInput>(small_lens("pinhole"), 2);
    out->image.time = RobotTime{} + seconds(t);
    out->image.T_world_camera = T_world_camera;
    return out;
  }
  std::shared_ptr<CameraInput> camera_;
};

TEST_F(KeptImagesTest, AreTheNewestAndViewsAllAround) {
  KeptImages kept(6, kRoom);
  // To and fro, 0.4 m, a second each way.
  for (int i = 0; i <= 90; ++i) kept.keep(image(i / 30.0, at(0.2 * std::cos(EIGEN_PI * i / 30))));
  ASSERT_EQ(kept.images().size(), 6u);
  EXPECT_NEAR(times(kept).front(), 3, 1e-9);
  for (double x = -0.2; x <= 0.2; x += 0.01) {
    double nearest = 1;
    for (const auto& one : kept.images())
      nearest = std::min(nearest, std::abs(one->image.T_world_camera.translation().x() - x));
    EXPECT_LT(nearest, 0.11) << x;
  }
  EXPECT_GT(times(kept).back(), 0.9) << "they are renewed";
}

TEST_F(KeptImagesTest, OfACameraThatStandsStillHoldWhatItSawBefore) {
  KeptImages kept(3, kRoom);
  kept.keep(image(0, at(0.5)));
  for (int i = 1; i <= 40; ++i) kept.keep(image(0.1 * i, at(0)));
  EXPECT_EQ(times(kept).back(), 0) << "the only one from elsewhere";
  EXPECT_NEAR(times(kept)[0], 4.0, 1e-9);
}

TEST_F(KeptImagesTest, ForgetWhatIsNotOlderThanTheNewest) {
  KeptImages kept(4, kRoom);
  for (const double t : {1.0, 3.0, 4.0, 2.0}) kept.keep(image(t, at(0.1 * t)));
  EXPECT_EQ(times(kept), (std::vector<double>{2, 1}));
}

TEST_F(KeptImagesTest, AreAsManyAsFit) {
  const std::uint64_t bytes = image(0, at(0))->camera->bytes();
  EXPECT_GT(bytes, 160u * 120u * 9u) << "colours, depth, edges";
  KeptImages two(4, 2 * bytes), none(4, 0);
  for (int i = 0; i < 6; ++i)
    for (KeptImages* kept : {&two, &none}) kept->keep(image(i, at(0.1 * i)));
  EXPECT_EQ(two.images().size(), 2u);
  EXPECT_EQ(none.images().size(), 1u) << "the newest";
}

TEST_F(KeptImagesTest, AreLeasedAsLongAsTheyAreKept) {
  KeptImages kept(2, kRoom);
  const auto first = image(0, at(0)), second = image(1, at(0.1));
  kept.keep(first);
  kept.keep(second);
  EXPECT_EQ(first->leases, 1);
  kept.keep(image(2, at(0.2)));
  EXPECT_EQ(first->leases + second->leases, 1);
}

TEST_F(KeptImagesTest, RangeIsThatOfWhatIsInView) {
  const auto scene = plane_scene(4, 4);
  const SurfacePatches surface = find_surface_patches(*scene, {});
  const PosedImage image{{}, {}, look_at({0, 0, 3}, {0.01, 0, 0}), state_of(*scene)};
  EXPECT_NEAR(typical_range(surface, small_lens("pinhole"), image), 3, 0.4);
}

}  // namespace
}  // namespace foresight::kept_images_test
