// --real-time and --window.
#include <regex>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::real_time_test {
namespace {

using nlohmann::json;

// The time of the play itself, without set-up: "replay: 20 images in 2 s, 9.9/s".
double played_seconds(const Outcome& outcome) {
  std::smatch match;
  const std::regex line("replay: .* in ([0-9]+) s");
  return std::regex_search(outcome.err, match, line) ? std::stod(match[1]) : -1;
}

TEST(RealTime, PlaysByTheClock) {
  const LoopedRun run(16, 0.15);
  const TempFolder out;
  // A driver that compiles its shaders for the first time, or a machine with other work, may be late for all of a run.
  int shown = 0;
  for (int attempt = 0; attempt < 5 && shown == 0; ++attempt) {
    const Outcome outcome =
        run_program({"replay", run.path(), "--real-time", "--delay-ms", "300", "--report", out / "report.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_GE(outcome.seconds, 15 * 0.15);
    EXPECT_GE(played_seconds(outcome), 2) << "not quicker; how late a busy machine ends says nothing";
    const json report = read_json(out / "report.json");
    shown = report["summary"]["frames"];
    EXPECT_EQ(shown + report["summary"]["dropped_frames"].get<int>(), 14);
    for (const json& frame : report["frames"]) EXPECT_TRUE(frame["dropped"] || frame["delay_s"] >= 0.299) << frame;
  }
  EXPECT_GE(shown, 1);
}

TEST(RealTime, DropsWhatComesTooLateAndCountsIt) {
  const LoopedRun run(200, 1e-4);  // quicker than any machine draws
  const TempFolder out;
  const Outcome outcome = run_program({"replay", run.path(), "--real-time", "--report", out / "report.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json summary = read_json(out / "report.json")["summary"];
  EXPECT_EQ(summary["frames"].get<int>() + summary["dropped_frames"].get<int>(), 200);
  EXPECT_GT(summary["dropped_frames"], 50);
  EXPECT_GT(summary["dropped_images"], 50);
}

TEST(RealTime, AWindowShowsTheReplayAndCloses) {
  if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no DISPLAY; scripts/test gives one";
  const SmallRun run;
  const TempFolder out;
  const Outcome outcome =
      run_program({"replay", run.path(), "--window", "--delay-frames", "1", "--report", out / "report.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_json(out / "report.json")["summary"]["frames"], 7);
}

}  // namespace
}  // namespace foresight::real_time_test
