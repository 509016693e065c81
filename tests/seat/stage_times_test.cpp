// Images are followed until they are seen, and all stages are told in words.
#include "seat/stage_times.hpp"

#include <gtest/gtest.h>

namespace foresight::stage_times_test {
namespace {

using namespace std::chrono_literals;

RobotTime at(Duration time) {
  return RobotTime{} + time;
}

TEST(StageTimes, WhatIsNotKnownIsNotTold) {
  EXPECT_TRUE(stage_lines({}).empty());
}

TEST(StageTimes, EachStageHasItsWords) {
  StageTimes times;
  times.ages = {12ms, 20ms, 21ms, 60ms, BoundedDelay{254ms, 1ms}, BoundedDelay{262ms, 1ms}};
  times.to_view = 41ms;
  times.drawing = 24ms;
  times.to_set_point = 11ms;
  times.costs = {{"upload", 2, {}}, {"depth", 9, {}}, {"extract", 21, {}}, {"lamp", 12, {}}};
  const auto lines = stage_lines(times);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].words,
            "an image's age: paired 12 ms, posed 20 ms, coded 60 ms, here 254 ms, decoded 262 ms, seen 303 ms, drawing "
            "24 ms, hand until sent 11 ms");
  EXPECT_EQ(lines[1].words, "an image 44 ms of CPU: extract 21, lamp 12, depth 9");
}

TEST(StageTimes, WhereThereIsAGpuItsTimeCounts) {
  StageTimes times;
  times.costs = {{"depth", 9, 0.4}, {"extract", 1, 3.2}};
  EXPECT_EQ(stage_lines(times).at(0).words, "an image 4 ms of GPU: extract 3, depth 0");
}

TEST(ImageWay, EndsWithTheSwapOfThePictureThatShowsIt) {
  ImageWay way;
  way.swapped(at(5ms));
  EXPECT_FALSE(way.to_view());
  way.came(at(1000ms), at(10ms));
  way.drawn(at(900ms));
  way.swapped(at(20ms));
  EXPECT_FALSE(way.to_view()) << "an older image was seen";
  way.came(at(1100ms), at(25ms));
  way.drawn(at(1000ms));
  way.swapped(at(43ms));
  EXPECT_EQ(way.to_view(), 33ms);
  way.swapped(at(60ms));
  EXPECT_EQ(way.to_view(), 33ms) << "nothing new";
  way.came(at(1200ms), at(70ms));
  way.drawn(at(1300ms));
  way.swapped(at(90ms));
  EXPECT_EQ(way.to_view(), 20ms) << "a newer one overtook it";
  way.came(at(1400ms), at(100ms));
  way.came(at(50ms), at(110ms));
  way.drawn(at(50ms));
  way.swapped(at(125ms));
  EXPECT_EQ(way.to_view(), 15ms) << "the robot's clock began anew";
}

}  // namespace
}  // namespace foresight::stage_times_test
