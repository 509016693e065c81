#include "link/send_control/line_trial.hpp"

#include <algorithm>

#include "common/statistics.hpp"
#include "tests/support/moving_picture.hpp"

namespace foresight {
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

double p95(const LineTrialResult& result) {
  return quantile(result.age_beyond_ms, 0.95);
}
double pairs_per_s(const LineTrialResult& result, const LineTrialOptions& options) {
  return static_cast<double>(result.pairs.size()) / to_seconds(options.length);
}

TEST(LineTrial, AFastLineShowsEveryPicture) {
  const auto options = small({}, seconds(4));
  const LineTrialResult result = run(options);
  EXPECT_GT(pairs_per_s(result, options), 25);
  EXPECT_LT(p95(result), 70);
  EXPECT_EQ(result.damaged, 0U);
  EXPECT_EQ(result.early, 0U);
  EXPECT_EQ(result.copies, 0U);
}

TEST(LineTrial, AThinLineShowsRecentPictures) {
  const auto options = small({.bytes_per_s = 10'000});
  const LineTrialResult result = run(options);
  EXPECT_GT(pairs_per_s(result, options), 5);
  EXPECT_LT(p95(result), 400);
  EXPECT_EQ(result.early, 0U);
  EXPECT_EQ(result.damaged, 0U);
  EXPECT_GT(result.up_bytes, 60'000U) << "it should use what the line carries";
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
    EXPECT_GT(pairs_per_s(result, options), 5);
    EXPECT_LT(p95(result), 2000);
  }
}

TEST(LineTrial, RepeatsBitForBit) {
  const auto options = small({.jitter = milliseconds(5), .loss = 0.02, .burst = 2, .bytes_per_s = 15'000}, seconds(3));
  const LineTrialResult a = run(options), b = run(options);
  EXPECT_EQ(a.age_beyond_ms, b.age_beyond_ms);
  EXPECT_EQ(a.up_bytes, b.up_bytes);
}

}  // namespace
}  // namespace foresight
