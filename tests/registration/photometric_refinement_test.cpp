#include "calibration/registration/photometric_refinement.hpp"

#include <gtest/gtest.h>

#include <random>

#include "calibration/registration/view_points.hpp"
#include "two_planes.hpp"

namespace foresight::photometric_refinement_test {
namespace {

/// Rotations of some mrad and translations of some mm: a few pixels.
Vector6d random_twist(std::mt19937& random, double size) {
  std::normal_distribution<double> normal;
  Vector6d out;
  for (double& x : out) x = size * normal(random);
  return out;
}

void add_noise(cv::Mat& image, unsigned seed, double sigma) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(image.at<std::uint8_t>(v, u) + normal(random));
}

double px(const Matrix6d& metric, const Vector6d& twist) {
  return std::sqrt(twist.dot(metric * twist));
}

TEST(PhotometricRefinement, FindsAKnownMotionWithinItsSigma) {
  const TwoPlanes world;
  const RenderedView view = world.view(Pose::Identity());
  std::mt19937 random(1);
  double chi2 = 0;
  constexpr int kRuns = 6;
  for (int run = 0; run < kRuns; ++run) {
    const Vector6d truth = random_twist(random, 0.008);
    cv::Mat image = world.image(to_motion(truth));
    add_noise(image, 100 + static_cast<unsigned>(run), 4);
    const RefinementSummary found = refine_pose(TwoPlanes::lens(), view, image, {});
    ASSERT_TRUE(found.accepted) << run << ": " << found.reason;
    const Vector6d error = to_twist(to_motion(truth).inverse() * found.T_world_camera);
    EXPECT_LT(px(found.px_metric, error), 0.1) << run;
    EXPECT_GT(found.moved_px, 0.3);
    chi2 += error.dot(found.covariance.ldlt().solve(error));
  }
  // 36 degrees of freedom; the covariance is itself an estimate from some 200 blocks.
  EXPECT_GT(chi2, 0.3 * 6 * kRuns);
  EXPECT_LT(chi2, 3 * 6 * kRuns);
}

TEST(PhotometricRefinement, DoesNotMindGainAndBias) {
  const TwoPlanes world;
  const Vector6d truth = (Vector6d() << 0.006, -0.004, 0.01, 0.004, -0.003, 0.006).finished();
  cv::Mat image = world.image(to_motion(truth));
  image.convertTo(image, CV_8U, 0.7, 30);
  const RefinementSummary found = refine_pose(TwoPlanes::lens(), world.view(Pose::Identity()), image, {});
  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_NEAR(found.gain, 0.7, 0.02);
  EXPECT_NEAR(found.bias, 30, 2.5);
  EXPECT_LT(px(found.px_metric, to_twist(to_motion(truth).inverse() * found.T_world_camera)), 0.1);
}

TEST(PhotometricRefinement, DoesNotMindAForeignObject) {
  const TwoPlanes world;
  const Vector6d truth = (Vector6d() << 0.006, -0.004, 0.01, 0.004, -0.003, 0.006).finished();
  cv::Mat image = world.image(to_motion(truth));
  image(cv::Rect(30, 140, 90, 80)).setTo(20);
  const RefinementSummary found = refine_pose(TwoPlanes::lens(), world.view(Pose::Identity()), image, {});
  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_LT(px(found.px_metric, to_twist(to_motion(truth).inverse() * found.T_world_camera)), 0.15);
}

TEST(PhotometricRefinement, RefusesAnotherScene) {
  const TwoPlanes world, other{1.7};
  const RefinementSummary found =
      refine_pose(TwoPlanes::lens(), world.view(Pose::Identity()), other.image(Pose::Identity()), {});
  EXPECT_FALSE(found.accepted);
  EXPECT_FALSE(found.reason.empty());
  EXPECT_TRUE(found.T_world_camera.isApprox(Pose::Identity(), 0));
}

TEST(PhotometricRefinement, RefusesWhatIsBeyondItsGate) {
  const TwoPlanes world;
  const cv::Mat image = world.image(to_motion((Vector6d() << 0.01, 0.01, 0, 0, 0, 0).finished()));
  RefinementOptions options;
  options.largest_px = 1;
  const RefinementSummary found = refine_pose(TwoPlanes::lens(), world.view(Pose::Identity()), image, options);
  EXPECT_FALSE(found.accepted);
  EXPECT_EQ(found.reason, "the correction is larger than the gate");
}

TEST(PhotometricRefinement, RefusesAViewWithoutEvidence) {
  const TwoPlanes world;
  RenderedView view = world.view(Pose::Identity());
  for (int v = 0; v < view.colour.rows; ++v)
    for (int u = 0; u < view.colour.cols; ++u) view.colour.at<cv::Vec4b>(v, u)[3] = 128;
  const RefinementSummary found = refine_pose(TwoPlanes::lens(), view, world.image(Pose::Identity()), {});
  EXPECT_FALSE(found.accepted);
  EXPECT_EQ(found.reason, "too few textured pixels");
}

TEST(PhotometricRefinement, PriorHoldsTheWeakPose) {
  const TwoPlanes world;
  const cv::Mat image = world.image(to_motion((Vector6d() << 0.005, 0.005, 0, 0, 0, 0).finished()));
  RefinementOptions options;
  options.prior_information = 1e12 * Matrix6d::Identity();
  const RefinementSummary found = refine_pose(TwoPlanes::lens(), world.view(Pose::Identity()), image, options);
  EXPECT_LT(found.moved_px, 0.01);
}

TEST(PhotometricRefinement, SlopesAreThoseOfTheImage) {
  const TwoPlanes world;
  const Lens lens = TwoPlanes::lens();
  const RenderedView view = world.view(Pose::Identity());
  const RefinementOptions options;
  const auto values = grey_pyramid(view.colour, 2);
  const cv::Mat mask = evidence_mask(view, options);
  for (int level = 0; level < 2; ++level) {
    const auto points = find_view_points(lens, view, values[static_cast<std::size_t>(level)], mask, level, options);
    ASSERT_GT(points.size(), 500u);
    for (int axis = 0; axis < 6; ++axis) {
      // The view itself is the image; it is sampled where the moved camera would look.
      const double step = 2e-4;
      double square = 0, difference = 0;
      for (const ViewPoint& point : points) {
        const auto value = [&](double s) {
          const auto pixel = lens.project(to_motion(s * Vector6d::Unit(axis)).inverse() * point.p_view);
          return sample(values[static_cast<std::size_t>(level)], to_level(*pixel, level)).value_or(point.value);
        };
        // Averages over half a pixel either way, as central differences of pixels do.
        const double numeric = (value(step) - value(-step)) / (2 * step);
        square += point.slope[axis] * point.slope[axis];
        difference += (numeric - point.slope[axis]) * (numeric - point.slope[axis]);
      }
      EXPECT_LT(std::sqrt(difference / square), 0.15) << "level " << level << ", axis " << axis;
    }
  }
}

TEST(PhotometricRefinement, DisplacementsAreThoseOfTheLens) {
  const TwoPlanes world;
  const Lens lens = TwoPlanes::lens();
  const RenderedView view = world.view(Pose::Identity());
  const RefinementOptions options;
  const auto points =
      find_view_points(lens, view, grey_pyramid(view.colour, 1)[0], evidence_mask(view, options), 0, options);
  for (std::size_t i = 0; i < points.size(); i += 97)
    for (int axis = 0; axis < 6; ++axis) {
      const auto pixel = [&](double s) {
        return *lens.project(to_motion(s * Vector6d::Unit(axis)).inverse() * points[i].p_view);
      };
      const Eigen::Vector2d numeric = (pixel(1e-6) - pixel(-1e-6)) / 2e-6;
      EXPECT_LT((numeric - points[i].displacement.col(axis)).norm(), 1e-3 * (1 + numeric.norm()));
    }
}

TEST(PhotometricRefinement, RefusesSizesThatDiffer) {
  const TwoPlanes world;
  EXPECT_THROW(refine_pose(TwoPlanes::lens(), world.view(Pose::Identity()), cv::Mat(10, 10, CV_8UC1), {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace foresight::photometric_refinement_test
