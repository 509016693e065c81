// `foresight bench line`: its keys, small, and words for wrong lines.
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/support/folders.hpp"

namespace foresight::line_bench_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(LineBench, SaysAgeRateAndQualityAndRepeats) {
  const TempFolder out;
  const std::string trace = out.write("thin.csv", "time_s,up_kbps,down_kbps\n0,200,1000\n1,150,1000\n2,250,1000\n");
  nlohmann::json all[2];
  for (nlohmann::json& numbers : all) {
    const std::string json = out / "line.json";
    const Outcome outcome = run_program({"bench", "line", "--trace", trace, "--seconds", "6", "--size", "64x48",
                                         "--pictures", "4", "--loss", "0.01", "--json", json});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    numbers = read_json(json);
  }
  for (const char* key :
       {"age_p50_ms", "age_p95_ms", "pairs_per_s", "psnr_db", "psnr_p5_db", "bytes_per_s", "worst_recovery_ms"})
    EXPECT_EQ(all[0][key], all[1][key]) << key;
  EXPECT_LT(all[0]["age_p50_ms"], all[0]["age_p95_ms"]);
  EXPECT_LT(all[0]["age_p95_ms"], 500);
  EXPECT_GT(all[0]["pairs_per_s"], 3);
  EXPECT_GT(all[0]["psnr_db"], 28);
  EXPECT_LT(all[0]["bytes_per_s"], 250 * 125);
  EXPECT_EQ(all[0]["damaged"], 0);
}

TEST(LineBench, SaysWhereNothingCame) {
  const TempFolder out;
  const std::string json = out / "line.json";
  const std::string line = out.write("dead.yaml", "up: {delay_ms: 20, outages: [{at_s: 0, for_s: 100}]}\n");
  const Outcome outcome = run_program(
      {"bench", "line", "--line", line, "--seconds", "3", "--size", "64x48", "--pictures", "2", "--json", json});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("no picture came"), HasSubstr("- / - ms"), HasSubstr("- / - dB"),
                                 HasSubstr("- ms to decode"), testing::Not(HasSubstr("-1"))));
  EXPECT_EQ(read_json(json)["gaps"], 1);
}

TEST(LineBench, OutagesAreGaps) {
  const TempFolder out;
  const std::string json = out / "line.json";
  const std::string line =
      out.write("out.yaml", "up: {delay_ms: 20, rate_kbps: 400, outages: [{at_s: 3, for_s: 2}]}\n");
  ASSERT_EQ(run_program({"bench", "line", "--line", line, "--seconds", "8", "--size", "64x48", "--pictures", "2",
                         "--json", json})
                .exit_code,
            0);
  const nlohmann::json numbers = read_json(json);
  EXPECT_EQ(numbers["gaps"], 1);
  EXPECT_NEAR(numbers["gaps_s"].get<double>(), 2, 0.1);
}

TEST(LineBench, RefusesLinesThatAreNone) {
  const TempFolder out;
  const auto refused = [&](std::vector<std::string> words, const std::string& what) {
    words.insert(words.begin(), {"bench", "line"});
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(what));
  };
  refused({"--trace", out.write("unsorted", "3\n2\n")}, "unsorted:2");
  refused({"--trace", out.write("empty", "")}, "empty");
  refused({"--line", out.write("line.yaml", "up: {los: 1}\n")}, "line.yaml:1");
  refused({"--size", "640"}, "--size");
  refused({"--loss", "2"}, "--loss");
  refused({"--trace", out / "absent"}, "absent");
}

}  // namespace
}  // namespace foresight::line_bench_test
