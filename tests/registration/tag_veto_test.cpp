#include "calibration/registration/tag_veto.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lab_head.hpp"

namespace foresight::tag_veto_test {
namespace {

const Pose& truth() {
  static const Pose T = sim::T_world_head_left({0.1, 0.5});
  return T;
}

struct Seen {
  sim::TagRoom room{sim::TagRoom::lab_tags()};
  TagMap map = room.corners();
  StereoLenses lenses = lab_lenses();
  cv::Mat left = room.picture(lab_rays(), truth(), 2, 1);
  cv::Mat right = room.picture(lab_rays(), truth() * lenses.T_left_right, 2, 2);
};

const Seen& seen() {
  static const Seen pictures;
  return pictures;
}

/// As sure as refinements usually are: 0.05 px of a turn.
const Matrix6d kSure = 1e-8 * Matrix6d::Identity();

/// Turned about an axis of the camera by so many pixels in the middle of the picture.
Pose turned(double px, int axis = 0) {
  return truth() * to_motion(Vector6d(px / 520 * Vector6d::Unit(axis)));
}

TagVerdict verdict(const Pose& refined, const Pose& given = truth()) {
  return TagVeto(seen().lenses, seen().map, {}).judge({given, refined, kSure}, seen().left, seen().right);
}

TEST(TagVeto, FivePixelsOffIsVetoedAndAThirdOfAPixelIsNot) {
  EXPECT_EQ(verdict(truth()), TagVerdict::agree);
  for (const int axis : {0, 1})
    for (const double sign : {1, -1}) {
      EXPECT_EQ(verdict(turned(5 * sign, axis)), TagVerdict::object) << axis;
      EXPECT_EQ(verdict(turned(1.5 * sign, axis)), TagVerdict::object) << axis;
      EXPECT_EQ(verdict(turned(0.3 * sign, axis)), TagVerdict::agree) << axis;
    }
}

TEST(TagVeto, OneTagInOneColourPictureIsEnough) {
  TagMap one;
  one.insert(*seen().map.find(4));
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>(3, seen().left), colour);
  TagVeto veto({lab_lens(), lab_lens()}, one, {});
  EXPECT_EQ(veto.judge({truth(), turned(5), kSure}, colour, {}), TagVerdict::object);
  EXPECT_EQ(veto.judge({truth(), turned(0.3), kSure}, colour, {}), TagVerdict::agree);
}

TEST(TagVeto, NothingIsVetoedWithoutTags) {
  const Pose beside = turned(5);
  TagVeto without({lab_lens(), lab_lens()}, {}, {});
  EXPECT_EQ(without.judge({truth(), beside, kSure}, seen().left, {}), TagVerdict::unseen);
  TagVeto unseen(seen().lenses, seen().map, {});
  const cv::Mat blank(480, 640, CV_8UC1, cv::Scalar(128));
  EXPECT_EQ(unseen.judge({truth(), beside, kSure}, blank, blank), TagVerdict::unseen);
}

TEST(TagVeto, CornersThatLieTowardsTheMiddleOfTheirTagsAreNoReason) {
  TagDetector detector({});
  std::vector<DetectedTag> left = detector.detect(seen().left), right = detector.detect(seen().right);
  ASSERT_GE(left.size(), 4u);
  const auto shrink = [](std::vector<DetectedTag>& tags) {
    for (DetectedTag& tag : tags) {
      const Eigen::Vector2d middle = (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]) / 4;
      for (Eigen::Vector2d& corner : tag.corners) corner += 0.3 * (middle - corner).normalized();
    }
  };
  shrink(left), shrink(right);
  const TagVeto veto(seen().lenses, seen().map, {});
  const Matrix6d exact = Matrix6d::Zero();
  // The given pose is the better one, so that it is the bound that lets this pass.
  EXPECT_EQ(veto.judge({truth(), turned(0.2), exact}, left, right), TagVerdict::agree);
  for (const DetectedTag& tag : left)
    EXPECT_EQ(veto.judge({truth(), turned(0.2), exact}, {tag}, {}), TagVerdict::agree) << tag.id;
  EXPECT_EQ(veto.judge({truth(), turned(5), exact}, left, right), TagVerdict::object);
}

TEST(TagVeto, AMovedTagAmongOthersIsNoReason) {
  TagMap map = seen().map;
  for (Eigen::Vector3d& corner : map.at(4)) corner.y() += 0.02;
  TagVeto veto(seen().lenses, map, {});
  EXPECT_EQ(veto.judge({turned(0.1), truth(), kSure}, seen().left, seen().right), TagVerdict::agree);
  EXPECT_EQ(veto.judge({truth(), turned(5), kSure}, seen().left, seen().right), TagVerdict::object);
}

TEST(TagVeto, AGivenPoseThatFitsTheTagsWorseIsNoBetterChoice) {
  EXPECT_EQ(verdict(turned(3), turned(6)), TagVerdict::agree);
  EXPECT_EQ(verdict(turned(6), turned(3)), TagVerdict::object);
}

TEST(TagVeto, AnUnsureRefinementIsNotContradicted) {
  TagVeto veto(seen().lenses, seen().map, {});
  EXPECT_EQ(veto.judge({truth(), turned(5), 1e-4 * Matrix6d::Identity()}, seen().left, seen().right),
            TagVerdict::agree);
}

}  // namespace
}  // namespace foresight::tag_veto_test
