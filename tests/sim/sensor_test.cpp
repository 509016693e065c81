// What the sensor and the shutter do to the picture, measured.
#include "sim/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sim/motion.hpp"
#include "sim/shutter.hpp"
#include "sim/synth_run.hpp"
#include "sim/texture.hpp"

namespace foresight::sim::sensor_test {
namespace {

cv::Mat grey(float light) {
  return cv::Mat(200, 300, CV_32FC3, cv::Scalar::all(light));
}

double linear(const cv::Mat& image, int u, int v) {
  return linear_from_srgb(static_cast<float>(image.at<cv::Vec3b>(v, u)[1]) / 255);
}

TEST(Sensor, NoiseHasTheDeviationAskedForAtMidGrey) {
  for (const double sigma : {1.5, 6.0}) {
    const cv::Mat image = Sensor{.noise = sigma}.develop(grey(linear_from_srgb(128 / 255.0f)), 0, 4);
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(mean[c], 128, 0.3);
      EXPECT_NEAR(deviation[c], std::sqrt(sigma * sigma + 1 / 12.0), 0.02 * sigma + 0.02);  // and rounding
    }
  }
}

TEST(Sensor, NoiseDiffersBetweenImagesAndIsRepeatable) {
  const Sensor sensor{.noise = 3};
  const cv::Mat a = sensor.develop(grey(0.2f), 0, 1);
  EXPECT_EQ(cv::norm(a, sensor.develop(grey(0.2f), 0, 1), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(a, sensor.develop(grey(0.2f), 0, 2), cv::NORM_L1), 100);
  const Sensor other{.noise = 3, .seed = 2};
  EXPECT_GT(cv::norm(a, other.develop(grey(0.2f), 0, 1), cv::NORM_L1), 100);
}

TEST(Sensor, CornersLoseTheShareAskedFor) {
  const cv::Mat image = Sensor{.vignetting = 0.4}.develop(grey(0.3f), 0, 0);
  EXPECT_NEAR(linear(image, 150, 100), 0.3, 0.003);
  for (const cv::Point corner : {cv::Point(0, 0), cv::Point(299, 0), cv::Point(0, 199), cv::Point(299, 199)})
    EXPECT_NEAR(linear(image, corner.x, corner.y), 0.6 * 0.3, 0.003);
  const double r2 = (60 * 60 + 40 * 40) / (149.5 * 149.5 + 99.5 * 99.5);
  EXPECT_NEAR(linear(image, 210, 140), (1 - 0.4 * r2) * 0.3, 0.004);
}

TEST(Sensor, ExposureSwingsByTheShareAskedFor) {
  const Sensor sensor{.exposure_drift = 0.25};
  EXPECT_EQ(sensor.gain(0), 1);
  EXPECT_NEAR(linear(sensor.develop(grey(0.3f), Sensor::kDriftPeriod / 4, 0), 9, 9), 1.25 * 0.3, 0.004);
  EXPECT_NEAR(linear(sensor.develop(grey(0.3f), 3 * Sensor::kDriftPeriod / 4, 0), 9, 9), 0.75 * 0.3, 0.004);
}

class ShutterTest : public testing::Test {
 protected:
  ShutterTest()
      : lab_(make_lab(0.004, 1)), light_(lab_, 8), renderer_(lab_, light_), rays_(synth_lens(options_, false)) {}

  const SynthOptions options_{.width = 80, .height = 60};
  const Lab lab_;
  const LightMap light_;
  const Renderer renderer_;
  const RayTable rays_;
  // Quick, so that a few ms matter.
  const LabMotion motion_{[](double t) { return T_world_camera_at(20 * t); },
                          [this](double t) { return lab_state_at(lab_, 20 * t); }};

  Picture at(double t, const Shutter& shutter = {}) const { return expose(renderer_, rays_, motion_, shutter, t); }
};

TEST_F(ShutterTest, RowsOfARollingShutterAreThoseOfAGlobalOneAtTheirTimes) {
  const Shutter rolling{.readout_s = 0.02};
  const Picture image = at(0.1, rolling);
  EXPECT_DOUBLE_EQ(rolling.row_time(0.1, 0, 60), 0.09);
  EXPECT_DOUBLE_EQ(rolling.row_time(0.1, 59, 60), 0.11);
  for (const int row : {0, 20, 45, 59}) {
    const Picture global = at(rolling.row_time(0.1, row, 60));
    EXPECT_EQ(cv::norm(image.depth.row(row), global.depth.row(row), cv::NORM_INF), 0) << row;
    EXPECT_EQ(cv::norm(image.facet.row(row), global.facet.row(row), cv::NORM_INF), 0) << row;
    EXPECT_LT(cv::norm(image.light.row(row), global.light.row(row), cv::NORM_L1) / (3 * 80), 0.003) << row;
  }
  EXPECT_GT(cv::norm(image.light.row(0), at(0.1).light.row(0), cv::NORM_L1) / (3 * 80), 0.01);
}

TEST_F(ShutterTest, MotionBlurIsTheMeanOverTheExposure) {
  const Picture blurred = at(0.1, {.exposure_s = 0.03}), middle = at(0.1);
  EXPECT_EQ(cv::norm(blurred.depth, middle.depth, cv::NORM_INF), 0);
  const auto sharpness = [](const cv::Mat& light) {
    cv::Mat edges;
    cv::Sobel(light, edges, CV_32F, 1, 0);
    return cv::norm(edges);
  };
  cv::Mat mean(blurred.light.size(), CV_32FC3, cv::Scalar::all(0));
  double sharp = 0;
  for (int k = -2; k <= 2; ++k) {
    const Picture instant = at(0.1 + 0.006 * k);
    mean += instant.light / 5;
    sharp += sharpness(instant.light) / 5;
  }
  EXPECT_LT(cv::norm(blurred.light, mean, cv::NORM_L1) / (3 * 80 * 60), 0.006);
  EXPECT_LT(sharpness(blurred.light), 0.9 * sharp);
}

}  // namespace
}  // namespace foresight::sim::sensor_test
