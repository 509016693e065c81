#include "link/coding/h264_coder.hpp"

#include <algorithm>
#include <random>

#include "link/send_control/line_trial.hpp"
#include "tests/support/moving_picture.hpp"

namespace foresight::h264_coder_test {
namespace {

RobotTime instant(std::uint32_t i) {
  return RobotTime{} + std::chrono::milliseconds(33) * i;
}

bool equal(const StereoPicture& a, const StereoPicture& b) {
  return a.left.size() == b.left.size() && cv::norm(a.left, b.left, cv::NORM_INF) == 0 &&
         cv::norm(a.right, b.right, cv::NORM_INF) == 0;
}

// Two decoders: one gets everything, and tells what the encoder has made.
class H264Lanes : public testing::Test {
 protected:
  CodedPair encode(bool only_what_arrived = false) {
    ++number_;
    const CodedPair pair = encoder_.encode(moving_picture(instant(number_)),
                                           {.number = number_, .bytes = 3000, .only_what_arrived = only_what_arrived});
    made_.push_back(mirror_.decode(pair).value());
    return pair;
  }
  void expect_shown(const CodedPair& pair) {
    const std::optional<StereoPicture> shown = receiver_.decode(pair);
    ASSERT_TRUE(shown) << pair.number;
    EXPECT_TRUE(equal(*shown, made_[pair.number - 1])) << pair.number;
    EXPECT_EQ(shown->captured, instant(pair.number));
  }

  H264PairEncoder encoder_;
  H264PairDecoder mirror_, receiver_;
  std::vector<StereoPicture> made_;
  std::uint32_t number_ = 0;
};

TEST_F(H264Lanes, EveryPictureComesOutAtOnceWithItsInstant) {
  for (int i = 0; i < 12; ++i) {
    const CodedPair pair = encode();
    EXPECT_EQ(pair.reference, pair.number - 1);
    EXPECT_EQ(pair.lane, 0);
    expect_shown(pair);
    EXPECT_GT(luma_psnr_db(moving_picture(instant(pair.number)), made_.back()), 27);
  }
}

TEST_F(H264Lanes, WhatBuildsOnALostPairIsRefused) {
  expect_shown(encode());
  const CodedPair lost = encode(), after = encode();
  EXPECT_FALSE(receiver_.ready(after));
  EXPECT_FALSE(receiver_.decode(after));
  expect_shown(lost);  // it came at last
  expect_shown(after);
  EXPECT_FALSE(receiver_.decode(after)) << "again";
}

TEST_F(H264Lanes, GoesOnFromPairsThatArrivedWhileOthersAreMissing) {
  const CodedPair first = encode(true);
  expect_shown(first);
  encoder_.arrived(1);
  const CodedPair late = encode(true);    // 2 on 1, and is lost
  const CodedPair begins = encode(true);  // nothing arrived that nobody builds on: a lane of its own
  EXPECT_EQ(late.reference, 1U);
  EXPECT_EQ(begins.reference, 0U);
  EXPECT_NE(begins.lane, late.lane);
  expect_shown(begins);
  encoder_.arrived(3);
  const CodedPair on_it = encode(true);
  EXPECT_EQ(on_it.reference, 3U);
  expect_shown(on_it);
  expect_shown(late);  // sent again; its lane goes on
  encoder_.arrived(2);
  const CodedPair on_late = encode(true);
  EXPECT_EQ(on_late.reference, 2U);
  expect_shown(on_late);
}

TEST_F(H264Lanes, BeginsALaneAnewWhenItsPairIsGone) {
  expect_shown(encode());
  encode();
  encoder_.gone(2);
  const CodedPair fresh = encode();
  EXPECT_EQ(fresh.reference, 0U);
  expect_shown(fresh);
  expect_shown(encode());
}

// What codes and decodes a lane takes memory: one that rests for long is no more gone back to.
TEST_F(H264Lanes, GivesUpALaneThatRests) {
  constexpr std::uint32_t kOften = kLaneRests / std::chrono::milliseconds(33);  // pairs in that time
  for (const std::uint32_t rests : {kOften - 2, kOften + 2}) {
    const std::uint32_t first = number_ + 1;
    expect_shown(encode(true));
    encoder_.arrived(first);
    const CodedPair late = encode(true), begins = encode(true);
    ASSERT_EQ(late.reference, first);
    ASSERT_NE(begins.lane, late.lane);
    expect_shown(late);
    for (expect_shown(begins); number_ < late.number + rests; expect_shown(encode())) encoder_.arrived(number_);
    encoder_.gone(number_);
    const CodedPair after = encode();
    EXPECT_EQ(after.reference, rests < kOften ? late.number : 0) << rests;
    expect_shown(after);
    encoder_.begin_anew();
  }
}

TEST_F(H264Lanes, ADamagedPictureIsNotShownNorBuiltOn) {
  for (std::size_t hit = 8; hit < 200; hit += 24) {
    H264PairDecoder receiver;
    H264PairEncoder encoder;
    ASSERT_TRUE(receiver.decode(encoder.encode(moving_picture(instant(1)), {.number = 1})));
    CodedPair cut = encoder.encode(moving_picture(instant(2)), {.number = 2});
    const CodedPair next = encoder.encode(moving_picture(instant(3)), {.number = 3});
    cut.data.resize(std::min(hit, cut.data.size() - 1));
    if (receiver.decode(cut)) continue;  // rarely the end holds nothing; the frame's checksum is there for that
    EXPECT_FALSE(receiver.ready(next));
    EXPECT_FALSE(receiver.decode(next));
  }
}

TEST_F(H264Lanes, FollowsTheBudgetThroughAChangeOfScene) {
  H264PairEncoder encoder;
  std::vector<std::size_t> sizes;
  for (std::uint32_t i = 1; i <= 40; ++i) {
    const RobotTime time = instant(i <= 20 ? i : i + 3000);
    const std::size_t budget = i <= 10 ? 6000 : 2000;
    sizes.push_back(encoder.encode(moving_picture(time, {160, 128}), {.number = i, .bytes = budget}).data.size());
    if (i > 3 && i != 11 && i != 21) {
      EXPECT_LT(sizes.back(), budget * 2) << i;
      EXPECT_GT(sizes.back(), budget / 4) << i;
    }
  }
}

// What a pair takes decides how long it is on the line: coarse and fine ones must not take turns, whatever the camera's
// distance in time and however the line's share changes.
TEST_F(H264Lanes, PairsTakeWhatTheyMay) {
  H264PairEncoder encoder;
  std::mt19937 random(1);
  std::vector<double> ratios;
  std::size_t budget = 1500, tick = 0;
  for (std::uint32_t i = 1; i <= 60; ++i) {
    if (random() % 4 == 0) budget = 800 + random() % 2400;
    tick += 1 + random() % 4;
    const StereoPicture picture = moving_picture(instant(static_cast<std::uint32_t>(tick)), {160, 128});
    const auto bytes = encoder.encode(picture, {.number = i, .bytes = budget}).data.size();
    if (i > 5) ratios.push_back(static_cast<double>(bytes) / static_cast<double>(budget));
  }
  std::sort(ratios.begin(), ratios.end());
  EXPECT_GT(ratios[ratios.size() / 20], 0.45) << "finer it gets by small steps only";
  EXPECT_NEAR(ratios[ratios.size() / 2], 1, 0.2);
  EXPECT_LT(ratios[ratios.size() * 19 / 20], 1.5);
}

// A line that carries next to nothing: what the coarsest step takes is too much, so the pictures get softer; later they
// are as sharp as before.
TEST_F(H264Lanes, GetsBelowTheFloorOfTheCoarsestStepAndBack) {
  H264PairEncoder encoder;
  H264PairDecoder decoder;
  std::vector<std::size_t> thin;
  double before = 0, after = 0;
  for (std::uint32_t i = 1; i <= 60; ++i) {
    const StereoPicture picture = moving_picture(instant(3 * i), {320, 240}, true, 6);
    const std::size_t budget = i > 20 && i <= 35 ? 300 : 12'000;
    const CodedPair pair = encoder.encode(picture, {.number = i, .bytes = budget});
    const auto shown = decoder.decode(pair);
    ASSERT_TRUE(shown);
    if (i == 20) before = luma_psnr_db(picture, *shown);
    if (i == 60) after = luma_psnr_db(picture, *shown);
    if (i > 28 && i <= 35) thin.push_back(pair.data.size());
  }
  EXPECT_LT(*std::max_element(thin.begin(), thin.end()), 900U);
  EXPECT_NEAR(after, before, 1);
}

// A camera that stood still begins to move as the line gets thinner: pictures take more than they may at first, but are
// not softened, which would have to be said as well, twice.
TEST_F(H264Lanes, WhatBeginsToMoveStaysSharp) {
  H264PairEncoder encoder;
  H264PairDecoder decoder;
  std::vector<double> moving_db;
  std::size_t bytes = 0;
  for (std::uint32_t i = 1; i <= 40; ++i) {
    const bool moves = i > 25;
    const StereoPicture picture = moving_picture(instant(moves ? 3 * (i - 25) : 0), {320, 240});
    const CodedPair pair = encoder.encode(picture, {.number = i, .bytes = moves ? 4'000U : 16'000U});
    const auto shown = decoder.decode(pair);
    ASSERT_TRUE(shown);
    if (!moves) continue;
    moving_db.push_back(luma_psnr_db(picture, *shown));
    bytes += pair.data.size();
  }
  EXPECT_GT(*std::min_element(moving_db.begin(), moving_db.end()), 41);
  EXPECT_LT(bytes / moving_db.size(), 4'600U);
}

TEST_F(H264Lanes, TakesGreyOddAndSinglePicturesAndChangesOfSize) {
  std::uint32_t number = 0;
  for (const bool colour : {false, true})
    for (const bool stereo : {false, true}) {
      StereoPicture picture = moving_picture({}, {75, 57}, colour);
      if (!stereo) picture.right.release();
      const auto shown = receiver_.decode(encoder_.encode(picture, {.number = ++number, .bytes = 20'000}));
      ASSERT_TRUE(shown);
      EXPECT_EQ(shown->left.size(), picture.left.size());
      EXPECT_EQ(shown->left.type(), picture.left.type());
      EXPECT_EQ(shown->right.empty(), !stereo);
      EXPECT_GT(luma_psnr_db(picture, *shown), 30);
    }
}

// A thin line: pictures cross it at half their size, and as before when it carries more again; each change begins a
// lane anew, and all are shown as large as they were, odd sizes too.
TEST_F(H264Lanes, ThinLinesGetHalvedPictures) {
  for (const cv::Size size : {cv::Size(320, 240), cv::Size(175, 157)}) {
    H264PairEncoder encoder;
    H264PairDecoder decoder, mirror;
    std::size_t halved = 0, whole = 0;
    bool before = false;
    double thin = 0;
    for (std::uint32_t i = 1; i <= 60; ++i) {
      const StereoPicture picture = moving_picture(instant(2 * i), size);
      const std::size_t budget = i > 10 && i <= 30 ? static_cast<std::size_t>(2 * size.area()) / 220 : 12'000;
      const CodedPair pair = encoder.encode(picture, {.number = i, .bytes = budget});
      EXPECT_TRUE(pair.halved == before || pair.reference == 0) << i;
      before = pair.halved;
      const auto shown = decoder.decode(parse_coded_pair(to_bytes(pair)).value()), made = mirror.decode(pair);
      ASSERT_TRUE(shown && made) << i;
      EXPECT_EQ(shown->left.size(), size);
      EXPECT_TRUE(equal(*shown, *made));
      (pair.halved ? halved : whole) += 1;
      if (i == 30) thin = luma_psnr_db(picture, *shown);
    }
    EXPECT_GE(halved, 20U);
    EXPECT_GE(whole, 10U);
    EXPECT_FALSE(before) << "it stayed halved";
    EXPECT_GT(thin, 18);
  }
}

Planes planes_at(std::uint32_t i) {
  return to_planes(moving_picture(instant(i), {320, 240}));
}

TEST(PictureScale, HalvesWhatMovesWhereTheLineStaysThin) {
  PictureScale scale;
  const std::size_t thin = 600, ample = 6000;  // of 600 places, nearly all of which move
  std::uint32_t i = 0;
  for (; i < 30; ++i) EXPECT_FALSE(scale.halved(planes_at(3 * i), i % 3 == 2 ? ample : thin)) << "it comes and goes";
  int until = 0;
  while (!scale.halved(planes_at(3 * ++i), thin)) ++until;
  EXPECT_LE(until, 4);
  for (int k = 0; k < 30; ++k) EXPECT_TRUE(scale.halved(planes_at(3 * ++i), k % 5 == 4 ? thin : ample));
  for (until = 0; scale.halved(planes_at(3 * ++i), ample);) ++until;
  EXPECT_LE(until, 20);
}

TEST(PictureScale, LeavesAStillSceneSharp) {
  PictureScale scale;
  for (std::uint32_t i = 0; i < 40; ++i) scale.halved(to_planes(moving_picture(instant(7), {320, 240})), 6000);
  for (std::uint32_t i = 0; i < 40; ++i) {
    StereoPicture still = moving_picture(instant(7), {320, 240}, true, 0);
    cv::Mat grain(still.left.size(), CV_16SC3);
    cv::RNG random(i + 1);
    random.fill(grain, cv::RNG::NORMAL, 0, 4);
    cv::add(still.left, grain, still.left, cv::noArray(), CV_8UC3);
    EXPECT_FALSE(scale.halved(to_planes(still), 600)) << "noise is no motion";
  }
}

}  // namespace
}  // namespace foresight::h264_coder_test
