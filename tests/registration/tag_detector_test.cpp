#include "calibration/tags/tag_detector.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "lab_head.hpp"
#include "sim/tag_room.hpp"

namespace foresight::tag_detector_test {
namespace {

TEST(TagDetector, CornersLieInOurPixels) {
  const sim::TagRoom room(sim::TagRoom::lab_tags());
  const auto corners = room.corners();
  const Lens lens = lab_lens();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double square = 0;
  int count = 0;
  for (const double pan : {-0.3, 0.0, 0.3}) {
    const Pose T_world_camera = sim::T_world_head_left({pan, 0.45});
    const cv::Mat picture = room.picture(lab_rays(), T_world_camera, 2, 1);
    TagDetector detector({});
    for (const DetectedTag& tag : detector.detect(picture)) {
      ASSERT_TRUE(corners.contains(tag.id));
      for (std::size_t c = 0; c < 4; ++c) {
        const auto truth = lens.project(T_world_camera.inverse() * corners.at(tag.id)[c]);
        mean += tag.corners[c] - *truth;
        square += (tag.corners[c] - *truth).squaredNorm();
        ++count;
      }
    }
  }
  ASSERT_GE(count, 4 * 15);
  EXPECT_LT((mean / count).norm(), 0.06);
  EXPECT_LT(std::sqrt(square / count), 0.25);
}

TEST(TagDetector, SeesNothingInNoise) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::setRNGSeed(1);
  cv::randu(noise, 0, 255);
  TagDetector detector({});
  EXPECT_TRUE(detector.detect(noise).empty());
}

TEST(TagDetector, LeavesOutATagThatIsThereTwice) {
  auto tags = sim::TagRoom::lab_tags();
  tags[3].id = tags[4].id;
  const cv::Mat picture = sim::TagRoom(tags).picture(lab_rays(), sim::T_world_head_left({0, 0.55}), 0, 1);
  TagDetector detector({});
  for (const DetectedTag& tag : detector.detect(picture)) EXPECT_NE(tag.id, tags[4].id);
}

TEST(TagDetector, LeavesOutATagAtTheBorder) {
  const cv::Mat picture =
      sim::TagRoom(sim::TagRoom::lab_tags()).picture(lab_rays(), sim::T_world_head_left({0, 0.55}), 0, 1);
  TagDetector detector({});
  for (const DetectedTag& tag : detector.detect(picture)) {
    double least = 1e9;
    for (const Eigen::Vector2d& corner : tag.corners) least = std::min(least, corner.x());
    const auto seen = [&](double beside) {
      const int first = static_cast<int>(least - beside);
      const auto tags = detector.detect(picture.colRange(std::max(0, first), picture.cols).clone());
      return std::any_of(tags.begin(), tags.end(), [&](const DetectedTag& other) { return other.id == tag.id; });
    };
    if (least < 60) continue;
    EXPECT_TRUE(seen(12)) << tag.id;
    EXPECT_FALSE(seen(2)) << tag.id;
  }
}

TEST(TagDetector, NamesTheNearestFamily) {
  try {
    TagDetector detector({.family = "tag36h12"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("tag36h11"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace foresight::tag_detector_test
