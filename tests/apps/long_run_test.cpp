// Thousands of images: memory stays flat and the texture budget is never exceeded.
#include <fstream>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::long_run_test {
namespace {

using nlohmann::json;

constexpr int kImages = 3000;
constexpr double kMegabyte = 1 << 20;

double resident_mb(pid_t pid) {
  std::ifstream stream("/proc/" + std::to_string(pid) + "/statm");
  double total = 0, resident = 0;
  stream >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / kMegabyte;
}

std::size_t count_files(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::directory_iterator files(folder, error);
  return error ? 0 : static_cast<std::size_t>(std::distance(files, {}));
}

struct Budget {
  const char* megabytes;
  std::vector<std::string> resolution;
};

class LongRun : public testing::TestWithParam<Budget> {};

TEST_P(LongRun, MemoryStaysFlatWithinTheBudget) {
  if (!std::getenv("FORESIGHT_LONG")) GTEST_SKIP() << "takes minutes; scripts/test --long runs it";
  const LoopedRun run(kImages, 1 / 30.0);
  const TempFolder out;
  std::vector<std::string> words{
      "replay", run.path(), "--delay-frames", "3", "--texture-memory-mb", GetParam().megabytes};
  words.insert(words.end(), GetParam().resolution.begin(), GetParam().resolution.end());
  words.insert(words.end(), {"--out", out / "out", "--report", out / "report.json"});
  Program program(words);
  double at_half = 0, most_after = 0;
  while (program.running()) {
    const std::size_t done = count_files(out / "out/predicted");
    const double now = resident_mb(program.pid());
    // The last images are left out: then the reports are written.
    if (done >= kImages / 2 && at_half == 0) at_half = now;
    if (at_half > 0 && done < kImages - 20) most_after = std::max(most_after, now);
    usleep(100'000);
  }
  const Outcome outcome = program.wait(std::chrono::seconds(3000));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GT(at_half, 0);
  EXPECT_LT(most_after, at_half + 6) << "MB resident, after " << at_half << " at half of the run";

  const json report = read_json(out / "report.json");
  const double budget = std::stod(GetParam().megabytes) * kMegabyte;
  double most_used = 0;
  for (const json& frame : report["frames"]) most_used = std::max(most_used, frame["texture_bytes_used"].get<double>());
  EXPECT_EQ(report["frames"].size(), static_cast<std::size_t>(kImages - 3));
  EXPECT_LE(most_used, budget);
  std::printf("%s MB budget: %.1f MB used; resident %.1f MB at half, at most %.1f MB after; %.0f s, PSNR %.2f dB\n",
              GetParam().megabytes, most_used / kMegabyte, at_half, most_after, outcome.seconds,
              report["summary"]["predicted"]["psnr_db"]["mean"].get<double>());
}

// At 500 texels per metre the view needs several times 16 MB: the memory policy is always at work.
INSTANTIATE_TEST_SUITE_P(Budgets, LongRun,
                         testing::Values(Budget{"1024", {}}, Budget{"16", {"--texels-per-metre", "500"}}),
                         [](const auto& budget) { return std::string(budget.param.megabytes) + "MB"; });

}  // namespace
}  // namespace foresight::long_run_test
