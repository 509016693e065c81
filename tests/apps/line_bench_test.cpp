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
