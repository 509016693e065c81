// What `replay --refine` wins on poses that are wrong by a known number of pixels.
#include <fstream>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

struct Shown {
  double psnr_db = 0, sharpness = 0;
};

class Refine : public testing::Test {
 protected:
  fs::path synth(const std::string& name, const std::vector<std::string>& more) const {
    const fs::path run = folder_ / name;
    std::vector<std::string> words{"synth", run, "--frames", "16", "--size", "240x180", "--pose-error-px", "2"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return run;
  }

  /// Gives `run` its true poses.
  static void correct(const fs::path& run) {
    std::map<std::string, std::string> truth;
    const auto rows = [](const fs::path& file, const auto& use) {
      std::ifstream stream(file);
      for (std::string line; std::getline(stream, line);)
        if (!line.starts_with('#')) use(line.substr(0, line.find(' ')), line);
    };
    rows(run / "truth/trajectory.txt", [&](const std::string& time, const std::string& line) { truth[time] = line; });
    std::string poses;
    rows(run / "trajectory.txt", [&](const std::string& time, const std::string&) { poses += truth.at(time) + "\n"; });
    std::ofstream(run / "trajectory.txt") << poses;
  }

  Outcome replay(const fs::path& run, std::vector<std::string> more) const {
    std::vector<std::string> words{"replay", run, "--report", report_};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  Shown shown(const fs::path& run, const std::vector<std::string>& more) const {
    const Outcome outcome = replay(run, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    Shown mean;
    const json frames = read_json(report_)["frames"];
    for (const json& frame : frames) {
      mean.psnr_db += frame["predicted"]["psnr_db"].get<double>() / static_cast<double>(frames.size());
      mean.sharpness += frame["predicted"]["sharpness"].get<double>() / static_cast<double>(frames.size());
    }
    return mean;
  }

  TempFolder folder_;
  fs::path report_ = folder_ / "report.json";
};

TEST_F(Refine, WinsBackMostOfWhatWrongPosesLose) {
  const fs::path run = synth("run", {"--seed", "4"});
  for (const char* delay : {"0", "1"}) {
    SCOPED_TRACE(delay);
    const Shown given = shown(run, {"--delay-frames", delay}),
                refined = shown(run, {"--delay-frames", delay, "--refine"});
    const fs::path right = folder_ / (std::string("right") + delay);
    fs::copy(run, right, fs::copy_options::recursive);
    correct(right);
    const Shown exact = shown(right, {"--delay-frames", delay});
    EXPECT_GT(exact.psnr_db, given.psnr_db + 2);
    EXPECT_GT((refined.psnr_db - given.psnr_db) / (exact.psnr_db - given.psnr_db), 0.5);
    EXPECT_NEAR(refined.sharpness, exact.sharpness, 0.04);
  }
}

TEST_F(Refine, ErrorsThatLastAreBridgedOverLongDelays) {
  const fs::path run = synth("run", {"--seed", "4", "--pose-error-s", "3"});
  const Shown given = shown(run, {"--delay-frames", "3"}), refined = shown(run, {"--delay-frames", "3", "--refine"});
  EXPECT_GT(refined.psnr_db, given.psnr_db + 1);
}

TEST_F(Refine, GoesWithTwoCamerasAndByTheClockButNotWithTheThesis) {
  const SmallRun run("--stereo");
  const Outcome stereo = replay(run.path(), {"--refine"});
  EXPECT_EQ(stereo.exit_code, 0) << stereo.err;
  EXPECT_THAT(stereo.out, HasSubstr("Poses refined of"));
  EXPECT_EQ(replay(run.path(), {"--refine", "--real-time"}).exit_code, 0);
  const Outcome refused = replay(run.path(), {"--refine", "--pipeline", "thesis"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.last_line(), HasSubstr("--pipeline core"));
}

}  // namespace
}  // namespace foresight
