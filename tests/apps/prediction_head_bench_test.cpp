// `foresight bench prediction head` and `hand`: recorded heads and hands, its keys, and words for wrong input.
#include <cmath>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/support/folders.hpp"

namespace foresight::prediction_head_bench_test {
namespace {

const std::string kHeader = "time_s,x,y,z,qx,qy,qz,qw\n";

std::string swaying_row(const std::string& time, double t) {
  return time + "," + std::to_string(0.3 * std::sin(2 * t)) + ",1.6," + std::to_string(0.1 * std::sin(5 * t)) + ",0," +
         std::to_string(std::sin(0.2 * std::sin(t))) + ",0," + std::to_string(std::cos(0.2 * std::sin(t))) + "\n";
}

nlohmann::json measured(const TempFolder& out, const std::string& csv) {
  const std::string json = out / "head.json";
  const Outcome outcome = run_program({"bench", "prediction", "head", csv, "--json", json});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? read_json(json) : nlohmann::json{};
}

TEST(PredictionHead, EveryRecordedUserIsPredictedBetterThanByConstantVelocity) {
  const auto folder = data_folder() / "head_motion_hololens/raw";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded heads in " << folder;
  const TempFolder out;
  double ours = 0, newest_two = 0;
  for (const char* user : {"User1.csv", "User2.csv", "User3.csv"}) {
    const nlohmann::json all = measured(out, (folder / user).string());
    EXPECT_LE(all["p95_mm"].get<double>(), 0.87 * all["constant_velocity_50ms_p95_mm"].get<double>()) << user;
    EXPECT_LE(all["p95_deg"].get<double>(), 0.95 * all["constant_velocity_50ms_p95_deg"].get<double>()) << user;
    EXPECT_NEAR(all["inside_2_sigma"], 0.94, 0.04) << user;
    EXPECT_NEAR(all["rotation_inside_2_sigma"], 0.94, 0.04) << user;
    ours += all["p95_mm"].get<double>();
    newest_two += all["newest_two_p95_mm"].get<double>();
  }
  EXPECT_LT(ours, newest_two);
}

// Seconds, nanoseconds and ticks of 100 ns say the same; lost poses and repeated rows are counted, not predicted from.
TEST(PredictionHead, ReadsWhatTrackersWrite) {
  const TempFolder out;
  std::string in_seconds = kHeader, in_ns = "timestamp,x,y,z,qx,qy,qz,qw\n", in_ticks = in_ns, lost = kHeader;
  for (int i = 0; i < 400; ++i) {
    const double t = i * 0.016;
    const std::string ns = std::to_string(i * 16'000'000LL),
                      ticks = std::to_string(637139238387771648LL + i * 160'000LL);
    in_seconds += swaying_row(std::to_string(t), t);
    in_ns += swaying_row(ns + ".0", t);
    in_ticks += swaying_row(ticks, t);
    lost += i % 40 == 7 ? std::to_string(t) + ",nan,nan,nan,nan,nan,nan,nan\n" : swaying_row(std::to_string(t), t);
    if (i % 100 == 50) lost += swaying_row(std::to_string(t), t + 7);
  }
  const nlohmann::json first = measured(out, out.write("s.csv", in_seconds));
  EXPECT_EQ(first["rows"], 400);
  EXPECT_LT(first["p95_mm"], first["constant_velocity_50ms_p95_mm"]);
  for (const std::filesystem::path& other : {out.write("ns.csv", in_ns), out.write("ticks.csv", in_ticks)})
    EXPECT_NEAR(measured(out, other)["p95_mm"].get<double>(), first["p95_mm"].get<double>(), 1e-9);
  const nlohmann::json less = measured(out, out.write("lost.csv", lost));
  EXPECT_EQ(less["lost"], 10);
  EXPECT_EQ(less["repeated"], 4);
  EXPECT_EQ(less["anew"], 1);
  EXPECT_LT(less["p95_mm"], less["constant_velocity_50ms_p95_mm"]);
}

TEST(PredictionHead, HandsAreFilteredWithoutLag) {
  const auto csv = data_folder() / "quest_controllers/controllers.csv";
  if (!std::filesystem::exists(csv)) GTEST_SKIP() << "no recorded hands in " << csv;
  const TempFolder out;
  const std::string json = out / "hand.json";
  const Outcome outcome = run_program({"bench", "prediction", "hand", csv.string(), "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json all = read_json(json);
  EXPECT_EQ(all["poses"].size(), 4u);
  EXPECT_NEAR(all["lag_ms"], 0, 1);
  EXPECT_GT(all["low_pass_lag_ms"], 15);
  EXPECT_LT(all["noise_mm"].get<double>(), 0.9 * all["raw_noise_mm"].get<double>());
  EXPECT_LT(all["jitter_mm"].get<double>(), 0.8 * all["raw_jitter_mm"].get<double>());
}

TEST(PredictionHead, WrongInputIsRefused) {
  const TempFolder out;
  const std::string row = "0.1,0,0,0,0,0,0,1\n";
  const std::pair<std::string, const char*> cases[] = {
      {"/nowhere.csv", "/nowhere.csv"},
      {out.write("empty.csv", ""), "has no row"},
      {out.write("header.csv", kHeader), "has no row"},
      {out.write("no_pose.csv", "time_s,x,y\n0,1,2\n"), "names no time_s"},
      {out.write("short.csv", kHeader + row), "has only 0 poses"},
      {out.write("fields.csv", kHeader + row + "0.2,0,0\n"), "fields.csv:3"},
      {out.write("word.csv", kHeader + row + "0.2,0,here,0,0,0,0,1\n"), "word.csv:3:7"},
      {out.write("time.csv", kHeader + "nan,0,0,0,0,0,0,1\n"), "time.csv:2:1"},
      {out.write("back.csv", kHeader + row + "0.05,0,0,0,0,0,0,1\n"), "back.csv:3"},
      {out.write("lost.csv", kHeader + row + "0.2,nan,0,0,0,0,0,1\n"), "1 of its 2 rows hold no rigid pose"},
  };
  for (const auto& [csv, problem] : cases) {
    const Outcome outcome = run_program({"bench", "prediction", "head", csv});
    EXPECT_EQ(outcome.exit_code, 2) << problem;
    EXPECT_THAT(outcome.last_line(), testing::HasSubstr(problem));
  }
}

}  // namespace
}  // namespace foresight::prediction_head_bench_test
