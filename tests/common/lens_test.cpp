#include "common/lens.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <random>
#include <stdexcept>

namespace foresight::lens_test {
namespace {

Lens make(LensModel model, std::array<double, 8> d, double f = 500, int width = 640, int height = 480) {
  Lens::Parameters p;
  p.model = model;
  p.width = width, p.height = height;
  p.fx = f, p.fy = f * 1.02, p.cx = width / 2.0 - 7.3, p.cy = height / 2.0 + 4.1;
  p.d = d;
  return Lens(p);
}

struct Case {
  const char* name;
  Lens lens;
};

// From mild to strong; the last of each perspective model folds back inside or near the image.
std::vector<Case> cases() {
  return {
      {"pinhole", make(LensModel::plumb_bob, {})},
      {"barrel", make(LensModel::plumb_bob, {-0.28, 0.09, 0.0007, -0.0004, -0.012})},
      {"strong_barrel", make(LensModel::plumb_bob, {-0.42, 0.21, 0.002, -0.003, -0.05}, 300)},
      {"pincushion", make(LensModel::plumb_bob, {0.35, 0.2, -0.001, 0.002, 0.1})},
      {"fold_back", make(LensModel::plumb_bob, {-0.4, 0, 0, 0, 0}, 250)},
      {"rational", make(LensModel::rational_polynomial, {2.1, 1.3, 0.0004, -0.0003, 0.07, 2.5, 2.0, 0.3}, 300)},
      {"rational_pole", make(LensModel::rational_polynomial, {0.1, 0, 0, 0, 0, -0.6, 0, 0}, 400)},
      {"fisheye", make(LensModel::equidistant, {-0.01, 0.004, -0.002, 0.0003}, 200)},
      {"fisheye_plain", make(LensModel::equidistant, {}, 120)},
      {"fisheye_fold_back", make(LensModel::equidistant, {-0.12, 0, 0, 0}, 180)},
  };
}

TEST(Lens, PixelToRayToPixelIsTheSamePixel) {
  for (const auto& [name, lens] : cases()) {
    int seen = 0;
    for (double y = -0.5; y <= lens.height(); y += 15.97) {
      for (double x = -0.5; x <= lens.width(); x += 15.97) {
        const Eigen::Vector2d pixel(x, y);
        const auto ray = lens.unproject(pixel);
        if (!ray) continue;
        ++seen;
        EXPECT_NEAR(ray->norm(), 1, 1e-12);
        const auto back = lens.project(*ray * 2.7);
        ASSERT_TRUE(back) << name << " at " << pixel.transpose();
        EXPECT_LT((*back - pixel).norm(), 1e-9) << name << " at " << pixel.transpose();
      }
    }
    EXPECT_GT(seen, 200) << name;
  }
}

TEST(Lens, RayToPixelToRayIsTheSameRay) {
  std::mt19937 random(1);
  for (const auto& [name, lens] : cases()) {
    const bool fisheye = lens.model() == LensModel::equidistant;
    // Rays beyond the border of the image tell nothing; near the fold the inverse is steep.
    const double largest = std::min(lens.max_angle(), fisheye ? lens.max_radius() : std::atan(lens.max_radius()));
    std::uniform_real_distribution<double> angle(0, 0.97 * largest), around(0, 2 * std::numbers::pi);
    for (int i = 0; i < 500; ++i) {
      const double a = angle(random), b = around(random);
      const Eigen::Vector3d ray(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      const auto pixel = lens.project(ray);
      ASSERT_TRUE(pixel) << name;
      const auto back = lens.unproject(*pixel);
      ASSERT_TRUE(back) << name << " at " << pixel->transpose() << ", angle " << a << " of " << largest;
      EXPECT_LT((*back - ray).norm(), 1e-7) << name << ", angle " << a << " of " << largest;
    }
  }
}

TEST(Lens, AgreesWithOpenCv) {
  std::mt19937 random(2);
  for (const auto& [name, lens] : cases()) {
    const auto& p = lens.parameters();
    const bool fisheye = lens.model() == LensModel::equidistant;
    const double largest = std::min({0.95 * (fisheye ? lens.max_radius() : std::atan(lens.max_radius())), 1.2});
    std::uniform_real_distribution<double> angle(0, largest), around(0, 2 * std::numbers::pi);
    std::vector<cv::Point3d> points;
    for (int i = 0; i < 200; ++i) {
      const double a = angle(random), b = around(random);
      points.emplace_back(3 * std::sin(a) * std::cos(b), 3 * std::sin(a) * std::sin(b), 3 * std::cos(a));
    }
    const cv::Matx33d K(p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1);
    const cv::Mat d(1, fisheye ? 4 : 8, CV_64F, const_cast<double*>(p.d.data()));
    std::vector<cv::Point2d> pixels;
    if (fisheye)
      cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), K, d);
    else
      cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, d, pixels);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto ours = lens.project({points[i].x, points[i].y, points[i].z});
      ASSERT_TRUE(ours) << name;
      EXPECT_NEAR(ours->x(), pixels[i].x, 1e-8) << name;
      EXPECT_NEAR(ours->y(), pixels[i].y, 1e-8) << name;
    }
  }
}

TEST(Lens, WhatLiesBehindOrBeyondTheFoldIsUnseen) {
  const Lens perspective = make(LensModel::plumb_bob, {-0.4});
  // r (1 - 0.4 r^2) grows up to r^2 = 1 / 1.2.
  EXPECT_NEAR(perspective.max_radius(), std::sqrt(1 / 1.2), 1e-6);
  EXPECT_TRUE(perspective.project({0.90, 0, 1}));
  EXPECT_FALSE(perspective.project({0.92, 0, 1}));
  EXPECT_FALSE(perspective.project({0, 0, -1}));
  EXPECT_FALSE(perspective.project({0, 0, 0}));

  const Lens fisheye = make(LensModel::equidistant, {-0.1});
  // theta (1 - 0.1 theta^2) grows up to theta^2 = 1 / 0.3.
  EXPECT_NEAR(fisheye.max_radius(), std::sqrt(1 / 0.3), 1e-6);
  EXPECT_TRUE(fisheye.project({std::sin(1.82), 0, std::cos(1.82)}));  // behind, and seen
  EXPECT_FALSE(fisheye.project({std::sin(1.83), 0, std::cos(1.83)}));
}

TEST(Lens, NoRayForPixelsThatNothingReaches) {
  // The fold lies at 250 px * 0.913 * (1 - 0.4 * 0.833) = 152 px from the centre.
  const Lens lens = make(LensModel::plumb_bob, {-0.4}, 250);
  EXPECT_TRUE(lens.unproject({lens.parameters().cx + 151, lens.parameters().cy}));
  EXPECT_FALSE(lens.unproject({lens.parameters().cx + 153, lens.parameters().cy}));
  EXPECT_FALSE(lens.unproject({-0.5, -0.5}));
}

TEST(Lens, MaxAngleIsThatOfTheFarthestCorner) {
  const Lens lens = make(LensModel::plumb_bob, {});
  const auto& p = lens.parameters();
  const double x = (p.cx + 0.5) / p.fx, y = (p.cy + 0.5) / p.fy, x2 = (639.5 - p.cx) / p.fx;
  EXPECT_NEAR(lens.max_angle(), std::atan(std::hypot(std::max(x, x2), y)), 1e-12);
}

TEST(Lens, RefusesWhatIsNoCamera) {
  const auto message = [](auto change) {
    Lens::Parameters p{LensModel::plumb_bob, 640, 480, 500, 500, 320, 240, {}};
    change(p);
    try {
      Lens lens(p);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([](auto&) {}), "accepted");
  EXPECT_EQ(message([](auto& p) { p.width = 0; }), "image width must lie in 1 .. 32768");
  EXPECT_EQ(message([](auto& p) { p.height = 40000; }), "image height must lie in 1 .. 32768");
  EXPECT_EQ(message([](auto& p) { p.fx = -1; }), "fx must be finite and positive");
  EXPECT_EQ(message([&](auto& p) { p.fy = nan; }), "fy must be finite and positive");
  EXPECT_EQ(message([&](auto& p) { p.cx = nan; }), "cx must be finite");
  EXPECT_EQ(message([&](auto& p) { p.cy = 1 / 0.0; }), "cy must be finite");
  EXPECT_EQ(message([&](auto& p) { p.d[7] = nan; }), "distortion coefficients must be finite");
}

}  // namespace
}  // namespace foresight::lens_test
