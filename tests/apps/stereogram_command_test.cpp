// `foresight stereogram` as it is used and misused.
#include <algorithm>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::stereogram_command_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class StereogramCommand : public testing::Test {
 protected:
  Outcome draw(const std::string& input, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{"stereogram", input, "--out", picture_};
    words.insert(words.end(), options.begin(), options.end());
    for (const auto& [option, value] : {std::pair{"--size", "320x240"}, {"--eye-distance", "90"}})
      if (std::ranges::find(options, option) == options.end()) words.insert(words.end(), {option, value});
    return run_program(words);
  }
  // What the program read back of what it drew, %.
  static double read_back(const Outcome& outcome) {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::size_t at = outcome.out.find("px; ");
    return at == std::string::npos ? -1 : std::strtod(outcome.out.c_str() + at + 4, nullptr);
  }
  void expect_refused(const Outcome& outcome, const std::string& where, const std::string& what) const {
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.last_line(), AllOf(StartsWith("foresight: "), HasSubstr(where), HasSubstr(what)));
    EXPECT_FALSE(fs::exists(picture_));
  }

  TempFolder folder_;
  std::string picture_ = folder_.path() / "dots.png";
};

TEST_F(StereogramCommand, ARunAndAModelCanBeReadBack) {
  const SmallRun run;
  EXPECT_GT(read_back(draw(run.path())), 80);
  EXPECT_GT(fs::file_size(picture_), 10'000u);
  const cv::Mat plain = cv::imread(picture_);
  EXPECT_GT(read_back(draw(run.path(), {"--strips", "two"})), 80);
  EXPECT_EQ(cv::norm(plain, cv::imread(picture_), cv::NORM_INF), 0) << "both ways are the same picture";
  EXPECT_GT(read_back(draw(run.path(), {"--invert", "--frame", "3", "--cursor", "160", "120"})), 80);
  EXPECT_GT(cv::norm(plain, cv::imread(picture_), cv::NORM_L1) / static_cast<double>(plain.total()), 10);
  EXPECT_GT(read_back(draw((run.path() / "scene.yaml").string(), {"--from", "front"})), 80);
}

TEST_F(StereogramCommand, WhatCannotBeDrawnIsRefused) {
  const SmallRun run;
  const std::string model = run.path() / "scene.yaml";
  expect_refused(draw(run.path(), {"--image", "99"}), "--image", "the run has no image 99");
  expect_refused(draw(model, {"--image", "0"}), "--image", "belongs to a run");
  expect_refused(draw(run.path(), {"--eye-distance", "4"}), "--eye-distance", "give at least");
  expect_refused(draw(run.path(), {"--eye-distance", "5000"}), "--eye-distance", "give at most 320");
  expect_refused(draw(run.path(), {"--size", "20x20"}), "--size", "from 64x16");
  cv::imwrite(folder_.path() / "tiny.png", cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(9)));
  expect_refused(draw(run.path(), {"--pattern", folder_.path() / "tiny.png"}), "tiny.png", "too small");
  expect_refused(draw(run.path(), {"--pattern", folder_.path() / "none.png"}), "none.png", "");
}

}  // namespace
}  // namespace foresight::stereogram_command_test
