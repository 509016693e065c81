// Things in pictures of the lab by the ray caster, which shares no code with what looks for them.
#include "prediction/sighting/thing_finder.hpp"

#include "prediction/arm_chain.hpp"
#include "scene/primitives.hpp"
#include "tests/sighting/pictured_room.hpp"

namespace foresight::thing_finder_test {
namespace {

using sim::kBricks;
using sim::LabState;
using Room = sim::PicturedRoom;

const Room& room(int width) {
  static const Room fine(640), coarse(320);
  return width == 640 ? fine : coarse;
}

Pose moved(const Pose& T, double x, double y, double z, double turn) {
  Pose out = T;
  out.translation() += Eigen::Vector3d(x, y, z);
  out.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * T.linear();
  return out;
}

class Finder : public testing::Test {
 protected:
  explicit Finder(int width) : room_(room(width)), truth_(room_.rest()), thought_(truth_) {}

  Pose& truth(std::size_t thing) { return truth_[room_.nodes[thing]]; }
  Pose& thought(std::size_t thing) { return thought_[room_.nodes[thing]]; }
  FoundThings look() {
    std::vector<ExpectedThing> expected;
    for (std::size_t i = 0; i < kBricks.size(); ++i) expected.push_back({thought(i), held_ == static_cast<int>(i)});
    return finder_.look(room_.frame(truth_, thought_, ++number_), expected);
  }
  double off(const ThingSighting& sighting) {
    return (sighting.T_world_thing.translation() - truth(sighting.thing).translation()).norm();
  }
  void print(const FoundThings& found) {
    for (const ThingSighting& s : found.sightings)
      std::printf("  %s: %.2f mm off, sigma %.2f mm, %.2f deg off\n", kBricks[s.thing].c_str(), 1e3 * off(s),
                  1e3 * s.sigma, 57.3 * pose_difference(truth(s.thing), s.T_world_thing).tail<3>().norm());
    for (const std::size_t i : found.missing) std::printf("  %s is missing\n", kBricks[i].c_str());
  }

  const Room& room_;
  ThingFinder finder_{room_.model(), {{room_.nodes[0], {}}, {room_.nodes[1], {}}}, room_.lenses};
  LabState truth_, thought_;
  int held_ = -1;
  std::int64_t number_ = 0;
};

class FinderTest : public Finder, public testing::WithParamInterface<int> {
 protected:
  FinderTest() : Finder(GetParam()) {}
  static bool takes_too_long() { return GetParam() == 640 && std::getenv("FORESIGHT_LONG") == nullptr; }
};

class CoarseFinder : public Finder {
 protected:
  CoarseFinder() : Finder(320) {}
};

TEST_F(CoarseFinder, SeesInTheHandWhatWasTakenForLost) {
  print(look());  // what it looks like
  truth(0) = moved(truth(0), 0.05, 0.02, 0.11, 0.3);
  std::vector<ExpectedThing> expected{{thought(0)}, {thought(1)}};
  for (const bool asked : {false, true}) {
    if (asked) expected[0].in_hand = moved(truth(0), 0.004, -0.003, 0.004, 0.05);
    bool seen = false;
    const FoundThings found = finder_.look(room_.frame(truth_, thought_, ++number_), expected);
    print(found);
    for (const ThingSighting& sighting : found.sightings)
      if (sighting.thing == 0) seen = off(sighting) < 0.015;
    EXPECT_EQ(seen, asked);
  }
}

TEST_P(FinderTest, SeesThingsWhereTheyAre) {
  truth(0) = moved(truth(0), 0.002, -0.002, 0, 0.02);
  const FoundThings found = look();
  print(found);
  ASSERT_EQ(found.sightings.size(), 2u);
  for (const ThingSighting& sighting : found.sightings) {
    EXPECT_LT(off(sighting), 0.003);
    EXPECT_LT(off(sighting), 3.5 * sighting.sigma) << "it knows how sure it is";
  }
}

TEST_P(FinderTest, SeesAThingThatIsElsewhere) {
  if (takes_too_long()) GTEST_SKIP() << "in the large pictures only with FORESIGHT_LONG=1";
  if (GetParam() == 640) look();  // prints beside the outline are edges of their own here: its colours are needed
  for (const double way : {0.015, -0.03, 0.045}) {
    thought_ = truth_ = room_.rest();
    truth(0) = moved(truth(0), 0.6 * way, -0.8 * way, 0, 5 * way);
    FoundThings found = look();
    if (found.sightings.size() < 2) found = look();
    print(found);
    const auto red = std::ranges::find(found.sightings, std::size_t{0}, &ThingSighting::thing);
    ASSERT_NE(red, found.sightings.end()) << way;
    EXPECT_LT(off(*red), 0.004) << way;
    EXPECT_LT(off(*red), 4 * red->sigma) << way;
  }
}

TEST_P(FinderTest, SeesAThingThatIsCarriedAndTurned) {
  if (takes_too_long()) GTEST_SKIP() << "in the large pictures only with FORESIGHT_LONG=1";
  look();
  truth(0) = moved(truth(0), 0.06, 0.02, 0.1, 0.4);
  thought(0) = moved(truth(0), 0.004, -0.003, 0.004, 0.05);
  held_ = 0;
  const FoundThings found = look();
  print(found);
  const auto red = std::ranges::find(found.sightings, std::size_t{0}, &ThingSighting::thing);
  ASSERT_NE(red, found.sightings.end());
  EXPECT_LT(off(*red), GetParam() == 640 ? 0.004 : 0.01) << "20 px in the coarse picture, and in other light";
  EXPECT_LT(off(*red), 4 * red->sigma);
}

TEST_P(FinderTest, WhatShouldBeInTheHandIsSeenOnTheTable) {
  if (takes_too_long()) GTEST_SKIP() << "in the large pictures only with FORESIGHT_LONG=1";
  look();
  thought(0) = moved(truth(0), 0.05, 0.02, 0.12, 0.1);
  held_ = 0;
  const FoundThings found = look();
  print(found);
  const auto red = std::ranges::find(found.sightings, std::size_t{0}, &ThingSighting::thing);
  ASSERT_NE(red, found.sightings.end());
  EXPECT_LT(off(*red), 0.004);
}

// There it has other light than on the mat, and the tray's boards hide its lower part.
TEST_F(CoarseFinder, AThingInTheTrayIsSeenThereAndOnlyThere) {
  look();
  const Pose in_tray = moved(truth_[static_cast<std::size_t>(*room_.model()->find("tray"))], 0.005, 0.01, 0.006, 0.3);
  thought(0) = moved(in_tray, 0.003, -0.002, 0, 0.04);
  for (const ThingSighting& seen : look().sightings) EXPECT_NE(seen.thing, 0u) << "it still stands on the mat";
  truth(0) = in_tray;
  const FoundThings found = look();
  print(found);
  const auto red = std::ranges::find(found.sightings, std::size_t{0}, &ThingSighting::thing);
  ASSERT_NE(red, found.sightings.end());
  EXPECT_LT(off(*red), 0.006);
  EXPECT_LT(off(*red), 4 * red->sigma);
}

TEST_F(CoarseFinder, AnotherThingOfTheSameShapeIsNotTaken) {
  look();
  thought(0) = moved(truth(1), 0.004, 0.004, 0, 0);
  truth(0).translation().z() -= 3;  // gone
  for (int i = 0; i < 2; ++i) {
    const FoundThings found = look();
    print(found);
    for (const ThingSighting& sighting : found.sightings) EXPECT_EQ(sighting.thing, 1u);
  }
}

TEST_F(CoarseFinder, WhatIsGoneIsMissing) {
  look();
  truth(0).translation().z() -= 3;
  bool missing = false;
  for (int i = 0; i < 3 && !missing; ++i) {
    const FoundThings found = look();
    print(found);
    for (const ThingSighting& sighting : found.sightings) EXPECT_EQ(sighting.thing, 1u);
    missing = std::ranges::find(found.missing, std::size_t{0}) != found.missing.end();
  }
  EXPECT_TRUE(missing);
}

INSTANTIATE_TEST_SUITE_P(Sizes, FinderTest, testing::Values(640, 320));

TEST(ThingFinder, FindsNothingInPicturesThatAreNone) {
  const Room& in = room(320);
  ThingFinder finder(in.model(), {{in.nodes[0], {}}}, in.lenses);
  const ExpectedThing expected{in.rest()[in.nodes[0]]};
  PosedFrame frame;
  frame.left.scene.T_world_node = in.rest();
  EXPECT_TRUE(finder.look(frame, {&expected, 1}).sightings.empty());
  frame.left.pixels = cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
  frame.left.T_world_camera = sim::LiveLab::T_world_left_modelled(sim::shafts_at_rest);
  const FoundThings found = finder.look(frame, {&expected, 1});
  EXPECT_TRUE(found.sightings.empty());
  EXPECT_TRUE(found.missing.empty()) << "of what nobody saw before";
  EXPECT_TRUE(finder.look(frame, {}).sightings.empty());
}

TEST(ThingShape, HasTheEdgesOfABoxAndHidesItsBack) {
  const ThingShape shape(make_box({0.04, 0.04, 0.04}));
  for (const OutlinePoint& point : shape.outline()) EXPECT_FALSE(point.open);
  EXPECT_NEAR(static_cast<double>(shape.outline().size()), 120, 1) << "twelve edges of ten points, no diagonal";
  EXPECT_TRUE(shape.hides({0, 0, 1}, {0.01, 0.01, -0.02}));
  EXPECT_FALSE(shape.hides({0, 0, 1}, {0.01, 0.01, 0.02}));
}

}  // namespace
}  // namespace foresight::thing_finder_test
