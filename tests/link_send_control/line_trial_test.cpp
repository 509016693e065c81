#include "link/send_control/line_trial.hpp"

#include <algorithm>
#include <cstdlib>

#include "common/statistics.hpp"
#include "tests/support/model_pair_coder.hpp"
#include "tests/support/moving_picture.hpp"
#include "tests/support/synthetic_lines.hpp"

namespace foresight::line_trial_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Lines are as thin for these small pictures as real ones are for real pictures.
LineTrialOptions small(DirectionSpec up, Duration length = seconds(12)) {
  LineTrialOptions options{.line = {.up = std::move(up), .down = {.delay = milliseconds(20)}, .seed = 3},
                           .length = length};
  options.line.up.delay += milliseconds(20);
  options.sender.first_bytes_per_s = 5'000;
  options.sender.fine_bytes = 1'500;
  options.sender.least_bytes = 300;
  return options;
}

LineTrialResult run(const LineTrialOptions& options) {
  return run_line_trial(options, [](RobotTime time) { return moving_picture(time); });
}

StereoPicture grey_pixel(RobotTime time) {
  return {.left = cv::Mat(1, 1, CV_8UC1, cv::Scalar(128)), .captured = time};
}

void with_model_coder(LineTrialOptions& options) {
  options.encoder = [] { return std::make_unique<ModelPairEncoder>(); };
  options.decoder = [] { return std::make_unique<ModelPairDecoder>(); };
}

bool long_tests() {
  return std::getenv("FORESIGHT_LONG") != nullptr;
}

double p95(const LineTrialResult& result) {
  return quantile(result.age_beyond_ms, 0.95);
}
double pairs_per_s(const LineTrialResult& result, const LineTrialOptions& options) {
  return static_cast<double>(result.pairs.size()) / to_seconds(options.length);
}

TEST(LineTrial, AFastLineShowsEveryPicture) {
  const auto options = small({}, seconds(4));
  const LineTrialResult result = run(options);
  EXPECT_GT(pairs_per_s(result, options), 29);
  EXPECT_LT(p95(result), 40) << "one period of the camera, and what steps of time add";
  EXPECT_EQ(result.damaged, 0U);
  EXPECT_EQ(result.early, 0U);
  EXPECT_EQ(result.copies, 0U);
}

TEST(LineTrial, AThinLineShowsRecentPictures) {
  const auto options = small({.bytes_per_s = 10'000});
  const LineTrialResult result = run(options);
  EXPECT_GT(pairs_per_s(result, options), 10);
  EXPECT_LT(p95(result), 250);
  EXPECT_EQ(result.early, 0U);
  EXPECT_EQ(result.damaged, 0U);
  EXPECT_GT(result.up_bytes, 60'000U) << "it should use what the line carries";
}

// 250 ms each way: how far away the robot is takes little of what the line carries.
TEST(LineTrial, ALongRoadIsUsed) {
  const auto near = small({.bytes_per_s = 20'000}, seconds(24));
  auto far = near;
  far.line.up.delay = far.line.down.delay = milliseconds(250);
  const LineTrialResult beside = run(near), result = run(far);
  EXPECT_GT(result.up_bytes, beside.up_bytes * 6 / 10);
  EXPECT_GT(pairs_per_s(result, far), 0.6 * pairs_per_s(beside, near));
  EXPECT_LT(p95(result), 400) << "the first trips, in which the line becomes known, included";
  EXPECT_EQ(result.early, 0U);
  EXPECT_EQ(result.damaged, 0U);
}

TEST(LineTrial, GoesOnSoonAfterAGap) {
  auto options = small({.bytes_per_s = 20'000, .outages = {{.at = seconds(5), .lasts = seconds(3)}}});
  const LineTrialResult result = run(options);
  const auto fresh = std::find_if(result.pairs.begin(), result.pairs.end(),
                                  [](const TrialPair& pair) { return pair.captured >= RobotTime{} + seconds(8); });
  ASSERT_NE(fresh, result.pairs.end());
  EXPECT_LT(fresh->decoded, RobotTime{} + milliseconds(8700));
  EXPECT_LT(result.up_bytes, 20'000U * 9) << "a line that stands still is not filled";
  EXPECT_EQ(result.early, 0U);
}

TEST(LineTrial, UsesALineAgainSoonAfterAThinTime) {
  RateTrace rates{.at = {seconds(0), seconds(3), seconds(5)}, .bytes_per_s = {40'000, 500, 40'000}, .period = {}};
  rates.period = seconds(60);
  const LineTrialResult result = run(small({.trace = std::make_shared<const Trace>(std::move(rates))}, seconds(6)));
  std::array<std::size_t, 6> bytes{};  // shown, by the second
  for (const TrialPair& pair : result.pairs)
    bytes.at(static_cast<std::size_t>(to_seconds(pair.decoded - RobotTime{}))) += pair.bytes;
  EXPECT_LT(bytes[4], 2000U);
  EXPECT_GT(bytes[5], bytes[2] * 6 / 10);
  EXPECT_EQ(result.early, 0U);
}

TEST(LineTrial, AnOutageThatLosesEverythingIsSurvived) {
  for (const double rate : {0.0, 20'000.0}) {
    auto options =
        small({.bytes_per_s = rate, .outages = {{.at = seconds(3), .lasts = seconds(2), .loses = true}}}, seconds(8));
    options.line.down.outages = options.line.up.outages;
    const LineTrialResult result = run(options);
    const auto fresh = std::find_if(result.pairs.begin(), result.pairs.end(),
                                    [](const TrialPair& pair) { return pair.captured >= RobotTime{} + seconds(5); });
    ASSERT_NE(fresh, result.pairs.end());
    EXPECT_LT(fresh->decoded, RobotTime{} + milliseconds(6500));
    EXPECT_EQ(result.damaged, 0U);
    EXPECT_EQ(result.early, 0U);
  }
}

// Loss in bursts both ways, packets that overtake each other, copies: nothing wrong is shown, and it goes on.
TEST(LineTrial, LossCostsTimeAndNeverShowsADamagedPicture) {
  for (const Coding coding : {Coding::h264, Coding::jpeg}) {
    auto options =
        small({.jitter = milliseconds(15), .reorder = true, .loss = 0.05, .burst = 3, .duplicates = 0.02}, seconds(8));
    options.line.down = options.line.up;
    options.coding = coding;
    options.sender.fine_bytes = 9'000;
    options.sender.first_bytes_per_s = 200'000;
    const LineTrialResult result = run(options);
    EXPECT_EQ(result.damaged, 0U);
    EXPECT_EQ(result.early, 0U);
    EXPECT_GT(result.copies, 10U) << "there was nothing to repair: the test shows nothing";
    EXPECT_GT(pairs_per_s(result, options), coding == Coding::h264 ? 15 : 10);
    EXPECT_LT(p95(result), 400);
  }
}

// 250 ms each way: what is lost is not waited for.
TEST(LineTrial, LossOnALongRoadCostsFewRoundTrips) {
  LineTrialOptions options;
  options.length = seconds(60);
  options.compare = false;
  options.line.seed = 3;
  options.line.up = {.delay = milliseconds(250), .loss = 0.05, .bytes_per_s = 1'000'000};
  options.line.down = options.line.up;
  with_model_coder(options);
  const LineTrialResult result = run_line_trial(options, grey_pixel);
  EXPECT_GT(result.spares, result.packets / 20);
  EXPECT_LT(result.copies, result.packets / 100) << "one in twenty was lost";
  EXPECT_LT(quantile(result.age_beyond_ms, 0.75), 250) << "which is what a repair takes at the least";
  EXPECT_GT(pairs_per_s(result, options), 8);
  EXPECT_EQ(result.early, 0U);
}

// Lines that nobody recorded, with a model of the coder (its sizes and lanes): walking, driving, tunnels, fades, loss.
TEST(LineTrial, PicturesStayRecentOnLinesOfAllKinds) {
  const unsigned seeds = long_tests() ? 40 : 2;
  std::size_t gaps = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed)
    for (const SyntheticLine& line : synthetic_lines(seed)) {
      SCOPED_TRACE(line.name + ", seed " + std::to_string(seed));
      LineTrialOptions options{.line = line.line, .length = seconds(60), .compare = false};
      with_model_coder(options);
      const LineTrialResult result = run_line_trial(options, grey_pixel);
      std::vector<double> ages, bytes;
      for (std::size_t i = 0; i < result.age_beyond_ms.size(); ++i)
        if (!result.in_gap[i]) ages.push_back(result.age_beyond_ms[i]);
      for (const TrialPair& pair : result.pairs) bytes.push_back(static_cast<double>(pair.bytes));
      EXPECT_LT(quantile(ages, 0.95), line.name == "deep fades" ? 500 : line.name == "on and off" ? 450 : 320);
      EXPECT_LT(quantile(ages, 0.5), 150);
      EXPECT_GT(pairs_per_s(result, options), 9);
      EXPECT_GT(median(bytes), 2500) << "age must not be bought with pictures that show nothing";
      EXPECT_EQ(result.early, 0U);
      for (const double recovery : result.recovery_ms) EXPECT_LE(recovery, 500);
      gaps += result.recovery_ms.size();
    }
  EXPECT_GT(gaps, 0U) << "the bar of recoveries shows nothing";
}

// Packets that take up to 80 ms longer than those after them: some are given up for lost that come all the same.
TEST(LineTrial, WhatIsOnlyLateCountsAsOnItsWay) {
  const auto options = small({.jitter = milliseconds(80), .reorder = true, .bytes_per_s = 40'000}, seconds(20));
  const LineTrialResult result = run(options);
  EXPECT_GT(result.copies, 10U) << "nothing was given up too early: the test shows nothing";
  EXPECT_EQ(result.early, 0U);
  EXPECT_GT(pairs_per_s(result, options), 10);
}

TEST(LineTrial, RepeatsBitForBit) {
  const auto options = small({.jitter = milliseconds(5), .loss = 0.02, .burst = 2, .bytes_per_s = 15'000}, seconds(3));
  const LineTrialResult a = run(options), b = run(options);
  EXPECT_EQ(a.age_beyond_ms, b.age_beyond_ms);
  EXPECT_EQ(a.up_bytes, b.up_bytes);
}

}  // namespace
}  // namespace foresight::line_trial_test
