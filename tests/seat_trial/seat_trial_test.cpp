// A program at a seat, both sides in stepped time in this process: what it does depends on what the line brings alone.
#include "apps/operator/seat_trial.hpp"

#include <gtest/gtest.h>

#include "apps/operator/stepped_sides.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat.hpp"
#include "seat/seat_words.hpp"
#include "seat/tool_script.hpp"
#include "seat/tour.hpp"
#include "tests/support/folders.hpp"

namespace foresight::seat_trial_test {
namespace {

using namespace std::chrono_literals;

/// All that was asked for at one tick.
struct Asked {
  OperatorTime time;
  SeatWish wish;

  bool operator==(const Asked& other) const {
    return time == other.time && wish.deadman == other.wish.deadman && wish.position == other.wish.position &&
           wish.request == other.wish.request && wish.control == other.wish.control &&
           wish.hand_over == other.wish.hand_over;
  }
};

struct Outcome {
  SeatTrialFigures figures;
  std::vector<Asked> asked;
};

/// The lab's rig with few and small images.
Rig small_rig(const std::filesystem::path& file, double images_hz) {
  Rig rig = read_rig(file);
  for (CameraConfig& camera : rig.cameras->cameras) {
    camera.settings.rate = images_hz;
    camera.settings.width = 160;
    camera.settings.height = 120;
  }
  return rig;
}

/// A pick that is cut off after `seconds`, with few and small images.
Outcome try_pick(double seconds, LinkCoding coding, std::function<cv::Mat(const cv::Mat&)> truth,
                 const TrustSwitchOptions& fall_back = {}) {
  SeatTrialOptions options;
  options.rig_file = source_folder() / "configs" / "minerva.yaml";
  Rig rig = small_rig(options.rig_file, 5);
  rig.link.coding = coding;
  options.line.up.delay = options.line.down.delay = 200ms;
  // States at their full rate would fill it, and be seconds old: no press would ever be answered.
  options.line.up.bytes_per_s = 100'000;
  options.physics = 1;
  options.thing = "brick_red";
  options.tray = "tray";
  options.most_s = seconds;
  options.pictures_hz = 2;
  options.zero_delay = false;
  options.truth = std::move(truth);
  options.fall_back = fall_back;
  Outcome out;
  options.asked = [&](OperatorTime time, const SeatWish& wish) { out.asked.push_back({time, wish}); };
  const auto scene = std::make_shared<const LiveScene>(live_scene_of(rig, true, std::nullopt, true, 0));
  ToolScript script(rig, pick_and_place(rig, *scene, options.thing, options.tray), {});
  out.figures = try_seat(
      rig, scene, options, script, [] { return false; }, [](const std::string&) {});
  return out;
}

TEST(SeatTrial, WhatTheProgramAsksForIsTheSameWhateverItIsScoredBy) {
  const Outcome seen = try_pick(2.5, LinkCoding::h264, {});
  cv::RNG random(7);
  const Outcome noise = try_pick(2.5, LinkCoding::h264, [&](const cv::Mat& image) {
    cv::Mat out(image.size(), image.type());
    random.fill(out, cv::RNG::UNIFORM, 0, 256);
    return out;
  });
  ASSERT_GT(seen.asked.size(), 1000u);
  ASSERT_EQ(seen.asked.size(), noise.asked.size());
  for (std::size_t i = 0; i < seen.asked.size(); ++i) ASSERT_TRUE(seen.asked[i] == noise.asked[i]) << "tick " << i;
  const SeatFidelity& figures = seen.figures.fidelity;
  ASSERT_TRUE(figures.predicted_db && figures.video_db && noise.figures.fidelity.predicted_db)
      << seen.figures.task.failure << "; " << figures.record.frames.size() << " pictures, "
      << seen.figures.line.pairs.pairs << " pairs " << seen.figures.line.coding << ", "
      << seen.figures.line.pairs.refusal << ", " << seen.figures.task.seconds << " s";
  // Else nothing was swapped, or nothing was done.
  EXPECT_GT(seen.figures.fidelity.predicted_db.value(), 20);
  EXPECT_LT(noise.figures.fidelity.predicted_db.value(), 12);
  EXPECT_TRUE(seen.asked.back().wish.position != seen.asked.front().wish.position);
  EXPECT_EQ(seen.figures.line.coding, "h264") << "pairs are to pass the coder, as they would on a line";
  EXPECT_GT(seen.figures.fidelity.video_db.value(), 10);
}

TEST(SeatTrial, NothingIsExactWhereTheNewestImageStandsIn) {
  const Outcome out = try_pick(2.5, LinkCoding::h264, {}, {.lowest_db = 90, .after = 0ms});
  const TrustFigures& trust = out.figures.fidelity.trust;
  ASSERT_TRUE(trust.exact_share && trust.fallback_share);
  ASSERT_GT(*trust.fallback_share, 0.5);
  EXPECT_LT(*trust.exact_share, 1.1 * (1 - *trust.fallback_share) + 0.01);
}

/// A robot that is driven, is gone for five seconds, and is there again with a clock that began anew, of which nothing
/// is known for a round trip. Pictures go on.
TEST(SeatTrial, ARobotThatComesBackIsToldOfAndDrivenAgain) {
  SeatTrialOptions options;
  options.rig_file = source_folder() / "configs" / "minerva.yaml";
  Rig rig = small_rig(options.rig_file, 2);
  options.line.up.delay = options.line.down.delay = 400ms;
  rig.link.round_trip = 1500ms;
  options.pictures_hz = 5;
  options.scored = false;
  std::optional<RobotTime> driven, back, drew;
  std::uint64_t pictures = 0;
  Duration longest{0};
  bool told = false, again = false;
  options.each = [&](const SeatMoment& moment) {
    if (std::exchange(pictures, moment.pictures) != moment.pictures) drew = moment.now;
    if (drew) longest = std::max<Duration>(longest, moment.now - *drew);
    const SeatStatus status = moment.seat.status();
    if (!driven && status.engaged) driven = moment.now;
    if (!driven || moment.now - *driven < 4s) return;
    if (!back && moment.robot.runs()) moment.robot.end();
    for (const SeatLine& line : seat_lines(status, rig.joint_names(), moment.source.fault()))
      told = told || line.words.find("nothing comes of the robot") != line.words.npos;
    EXPECT_FALSE(!back && moment.now - *driven > 6s && status.engaged) << "nobody is there";
    again = again || (back && status.engaged);
    if (back || moment.now - *driven < 9s) return;
    back = moment.now;
    moment.robot.start(moment.robot.rig(), moment.robot.identity());
  };
  const auto scene = std::make_shared<const LiveScene>(live_scene_of(rig, true, std::nullopt, false, 0));
  ToolScript script(rig, tour(rig, 1, 100), {});
  const SeatTrialFigures figures = try_seat(
      rig, scene, options, script, [&] { return again; }, [](const std::string&) {});
  EXPECT_TRUE(driven && back);
  EXPECT_TRUE(told);
  EXPECT_LT(to_seconds(longest), 0.5) << "without a picture";
  EXPECT_TRUE(again) << figures.task.failure;
}

}  // namespace
}  // namespace foresight::seat_trial_test
