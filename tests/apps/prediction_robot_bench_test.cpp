// `foresight bench prediction robot`: rigs with emulated drives behind the real gate, half a second away.
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/support/folders.hpp"

namespace foresight::prediction_robot_bench_test {
namespace {

nlohmann::json measured(const TempFolder& out, const std::string& rig, std::vector<std::string> more) {
  const std::string json = out / "robot.json", file = (source_folder() / "configs" / rig).string();
  std::vector<std::string> line{"bench", "prediction", "robot", "--rig", file, "--json", json};
  line.insert(line.end(), more.begin(), more.end());
  const Outcome outcome = run_program(line);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? read_json(json) : nlohmann::json{};
}

TEST(PredictionRobot, TheToolIsShownWhereItWillBeAcrossASecond) {
  const TempFolder out;
  for (const char* rig : {"minerva.yaml", "cia402.yaml"}) {
    const nlohmann::json all = measured(out, rig, {"--seconds", "40", "--seed", "3"});
    ASSERT_FALSE(all.is_null()) << rig;
    EXPECT_GT(all["judged"].get<int>(), 1000) << rig;
    EXPECT_GT(all["fastest_share"].get<double>(), 0.99) << rig << ": up to full speed";
    EXPECT_LE(all["tool_p95_mm"].get<double>(), 2) << rig;
    EXPECT_LE(all["shaft_tool_p95_mm"].get<double>(), 2) << rig;
    EXPECT_GE(all["hold_tool_p95_mm"].get<double>(), 100) << rig;
    EXPECT_GE(all["velocity_tool_p95_mm"].get<double>(), 100) << rig;
    for (const char* inside : {"tool_inside_2_sigma", "joints_inside_2_sigma"}) {
      EXPECT_GE(all[inside].get<double>(), 0.90) << rig << ", " << inside;
      EXPECT_LE(all[inside].get<double>(), 0.98) << rig << ", " << inside;
    }
    EXPECT_LE(all["largest_step_over_limit"].get<double>(), 2.1) << rig << ": nothing jumps";
    EXPECT_NEAR(all["delay_ms_told"].get<double>(), 500, 0.1) << rig;
  }
}

TEST(PredictionRobot, ALineThatJittersAndLosesIsToldInTheUncertainty) {
  const TempFolder out;
  const nlohmann::json all =
      measured(out, "cia402.yaml", {"--seconds", "25", "--delay-ms", "200", "--jitter-ms", "15", "--loss", "0.02"});
  ASSERT_FALSE(all.is_null());
  EXPECT_LE(all["tool_p95_mm"].get<double>(), 10);
  EXPECT_LE(10 * all["tool_p95_mm"].get<double>(), all["velocity_tool_p95_mm"].get<double>());
  EXPECT_GE(all["tool_inside_2_sigma"].get<double>(), 0.88);
  EXPECT_GE(all["joints_inside_2_sigma"].get<double>(), 0.88);
  EXPECT_LE(all["largest_step_over_limit"].get<double>(), 2.1);
}

TEST(PredictionRobot, ARigWithoutARobotIsRefused) {
  const TempFolder out;
  const Outcome outcome =
      run_program({"bench", "prediction", "robot", "--rig", out.write("rig.yaml", "name: nothing\n").string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.last_line(), testing::HasSubstr("rig.yaml"));
}

}  // namespace
}  // namespace foresight::prediction_robot_bench_test
