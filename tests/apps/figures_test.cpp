// The figures of the thesis from a small run: all there, of the right size, and what they say they show.
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::figures_test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kFiles = {"core_vs_thesis.png", "fig_4_08.png", "fig_4_15.png", "fig_4_20.png",
                                         "fig_5_09.png",       "fig_5_11.png", "fig_5_19.png", "fig_5_23.png"};

class Figures : public testing::Test {
 protected:
  /// A small run, made once.
  static const std::string& run() {
    static const TempFolder folder;
    static std::string path;
    if (!path.empty()) return path;
    const std::string out = folder / "run";
    const Outcome outcome = run_program(
        {"synth", out, "--frames", "24", "--size", "160x120", "--rate", "20", "--no-distortion", "--no-truth"});
    if (outcome.exit_code != 0) throw std::runtime_error("no synthetic run: " + outcome.err);
    return path = out;
  }

  void expect_refused(const std::string& run, const std::string& out, const std::string& where, const std::string& what,
                      const std::string& cure) const {
    SCOPED_TRACE(run + " " + out);
    const Outcome outcome = run_program({"bench", "figures", run, "--out", out});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.last_line(), says(where, what, cure));
    EXPECT_TRUE(fs::is_empty(out_.path()));
  }

  TempFolder out_;
};

int count(const cv::Mat& picture, const cv::Scalar& bgr) {
  cv::Mat mask;
  cv::inRange(picture, bgr, bgr, mask);
  return cv::countNonZero(mask);
}

TEST_F(Figures, ShowWhatTheySay) {
  const std::string out = out_ / "made/here";
  const Outcome outcome = run_program({"bench", "figures", run(), "--out", out});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.last_line() << '\n' << outcome.err;
  EXPECT_THAT(outcome.out, testing::HasSubstr(out));
  ASSERT_EQ(names_in(out), kFiles);

  std::map<std::string, cv::Mat> pictures;
  const std::map<std::string, std::pair<int, int>> panels = {
      // columns and rows of pictures; none is narrower than 260 px on the page
      {"core_vs_thesis.png", {3, 2}}, {"fig_4_08.png", {2, 2}}, {"fig_4_15.png", {2, 1}}, {"fig_4_20.png", {2, 1}},
      {"fig_5_09.png", {3, 2}},       {"fig_5_11.png", {3, 6}}, {"fig_5_19.png", {2, 2}}, {"fig_5_23.png", {2, 2}}};
  for (const auto& [name, grid] : panels) {
    SCOPED_TRACE(name);
    const cv::Mat picture = pictures[name] = cv::imread(out + "/" + name);
    ASSERT_FALSE(picture.empty());
    EXPECT_GE(picture.cols, 260 * grid.first);
    EXPECT_GE(picture.rows, 120 * grid.second);
    EXPECT_LT(picture.cols, 2000);
    cv::Scalar mean, deviation;
    cv::meanStdDev(picture, mean, deviation);
    EXPECT_GT(deviation[1], 10);
  }
  const cv::Scalar pink(180, 105, 255), black(0, 0, 0), white(255, 255, 255);
  for (const char* name : {"fig_4_08.png", "fig_5_09.png", "fig_5_19.png", "fig_5_23.png"})
    EXPECT_GT(count(pictures.at(name), pink), 200) << name;
  EXPECT_GT(count(pictures.at("fig_5_11.png"), black), 10000);
  EXPECT_GT(cv::norm(pictures.at("fig_4_15.png"), pictures.at("fig_4_20.png"), cv::NORM_L1), 0);

  // Each expansion takes more colours away: column by column of the page.
  const cv::Mat errors = pictures.at("fig_5_09.png");
  const int third = errors.cols / 3;
  int before = -1;
  for (int i = 0; i < 3; ++i) {
    const int holes = count(errors.colRange(i * third, (i + 1) * third), pink);
    EXPECT_GT(holes, before);
    before = holes;
  }
}

TEST_F(Figures, WrongInputEndsWithCode2AndNoOutput) {
  const TempFolder places;
  places.write("file", "kept");
  fs::create_directories(places / "taken/fig_5_09.png");
  // The same run with fewer images; and with a lens of 150 degrees.
  const TempFolder brief, fisheye;
  for (const TempFolder* copy : {&brief, &fisheye}) fs::copy(run(), copy->path(), fs::copy_options::recursive);
  std::istringstream images(brief.read("rgb.txt"));
  std::string kept;
  for (std::string line; std::getline(images, line) && line.find("000012") == std::string::npos;) kept += line + "\n";
  brief.write("rgb.txt", kept);
  fisheye.write("camera.yaml",
                "image_width: 160\nimage_height: 120\ndistortion_model: equidistant\n"
                "camera_matrix: {rows: 3, cols: 3, data: [60, 0, 80, 0, 60, 60, 0, 0, 1]}\n"
                "distortion_coefficients: {rows: 1, cols: 4, data: [0, 0, 0, 0]}\n");
  expect_refused(places / "nowhere", out_ / "out", "nowhere", "no such folder", "");
  expect_refused(run(), places / "file/out", "--out", "cannot be written to", "give another place");
  expect_refused(run(), places / "taken", "--out", "fig_5_09.png: this is a folder", "give a file name");
  expect_refused(fisheye.path(), out_ / "out", fisheye.path(), "more than one picture plane", "120 degrees");
  expect_refused(brief.path(), out_ / "out", brief.path(), "only 12 images", "at least 20");
  EXPECT_EQ(places.read("file"), "kept");
}

}  // namespace
}  // namespace foresight::figures_test
