// `foresight calibrate capture` on OpenCV's pictures.
#include <gmock/gmock.h>

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "calibration/target/image_input.hpp"
#include "tests/calibrate/run_calibrate.hpp"

namespace foresight::capture_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kPictures = "/usr/share/doc/opencv-doc/examples/data";
const std::string kBoard = "chessboard:9x6:0.025";

class Capture : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kPictures / "left01.jpg"))
      GTEST_SKIP() << "no pictures at " << kPictures << "; install opencv-doc";
  }
  static int count(const std::filesystem::path& folder) {
    return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }
  std::string capture(std::vector<std::string> more) const {
    more.insert(more.begin(), {"capture", "--board", kBoard, "--json", folder_ / "c.json"});
    return run_calibrate(more);
  }
  const std::string left_ = kPictures / "left[01]*.jpg", right_ = kPictures / "right[01]*.jpg";
  const TempFolder folder_;
};

TEST_F(Capture, PairsEndAsFoldersForStereo) {
  const std::string out = folder_ / "set";
  ASSERT_EQ(capture({"--images", left_, right_, "--out", out, "--no-window"}), "1");
  const auto numbers = json_of(folder_, "c.json");
  EXPECT_EQ(numbers["cameras"], 2);
  EXPECT_EQ(numbers["ended"], "no more images");
  EXPECT_EQ(numbers["missing"], "nothing in the upper left corner: move the board there");
  EXPECT_GE(numbers["views"], 10);
  EXPECT_EQ(count(folder_ / "set/left"), numbers["views"]);
  EXPECT_EQ(count(folder_ / "set/right"), numbers["views"]);
  EXPECT_EQ(cv::imread((folder_ / "set-seen/now.png").string()).size(), cv::Size(1280, 800));
  EXPECT_THAT(capture({"--images", left_, right_, "--out", out, "--no-window"}), HasSubstr("already holds files"));
}

// Every image counts, however slow the finder: two runs take the same views.
TEST_F(Capture, ALoneCameraEndsAsOneFolderForIntrinsics) {
  for (const std::string set : {"one", "two"}) {
    const auto before = set == "two" ? json_of(folder_, "c.json") : nlohmann::json();
    ASSERT_EQ(capture({"--images", left_, "--out", folder_ / set, "--no-window", "--views", "5"}), "1");
    const auto numbers = json_of(folder_, "c.json");
    EXPECT_EQ(numbers["cameras"], 1);
    EXPECT_EQ(count(folder_ / set), numbers["views"]);
    if (!before.is_null()) {
      EXPECT_EQ(numbers, before);
    }
  }
  EXPECT_EQ(run_calibrate({"intrinsics", "--board", kBoard, "--images", folder_ / "one"}), "0");
}

TEST_F(Capture, StopsWhenItIsEnough) {
  // Two sets of pictures in one folder: the second camera's see what the first one's do not.
  std::filesystem::create_directories(folder_ / "all");
  int number = 0;
  for (const char* side : {"right", "left"})
    for (const auto& file : list_images(kPictures / (side + std::string("[01]*.jpg"))))
      std::filesystem::copy(file, folder_ / ("all/" + std::to_string(++number) + ".jpg"));
  const std::string result =
      capture({"--images", folder_ / "all", "--out", folder_ / "set", "--no-window", "--views", "8"});
  const auto numbers = json_of(folder_, "c.json");
  EXPECT_EQ(result, "0") << numbers;
  EXPECT_EQ(numbers["ended"], "enough");
  EXPECT_LT(numbers["views"], 26);
}

TEST_F(Capture, AWindowTakesTheSame) {
  if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no display: run it under xvfb-run";
  ASSERT_EQ(capture({"--images", left_, right_, "--out", folder_ / "a", "--window"}), "1");
  const auto numbers = json_of(folder_, "c.json");
  ASSERT_EQ(capture({"--images", left_, right_, "--out", folder_ / "b", "--no-window"}), "1");
  EXPECT_EQ(numbers, json_of(folder_, "c.json"));
}

// Ctrl-C in the middle: what was taken stays, and the exit code says that it was not the end.
TEST_F(Capture, KeepsWhatWasTakenWhenItIsStopped) {
  for (const std::string side : {"left", "right"}) {
    std::filesystem::create_directories(folder_ / side);
    for (int copy = 0; copy < 20; ++copy)  // far more than are looked at
      for (const auto& file : list_images(kPictures / (side + "0*.jpg")))
        std::filesystem::create_symlink(file, folder_ / (side + "/" + std::to_string(copy) + file.filename().string()));
  }
  const std::filesystem::path out = folder_ / "set";
  std::jthread ctrl_c([&](const std::stop_token& stop) {
    while (!stop.stop_requested() && (!std::filesystem::exists(out / "right") || count(out / "right") < 2))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!stop.stop_requested()) kill(getpid(), SIGINT);
  });
  EXPECT_EQ(capture({"--images", folder_ / "left", folder_ / "right", "--out", out, "--no-window", "--views", "900"}),
            "130");
  const auto numbers = json_of(folder_, "c.json");
  EXPECT_EQ(numbers["ended"], "interrupted");
  EXPECT_GE(numbers["views"], 2);
  EXPECT_EQ(count(out / "left"), numbers["views"]);
}

TEST_F(Capture, ExposuresThatTellNothingAreRefused) {
  const auto series = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"capture", "--mock", "--out", folder_ / "s", "--exposures"});
    return run_calibrate(more);
  };
  EXPECT_THAT(series({"0.001", "0.002", "0.00255"}), AllOf(HasSubstr("0.00255 s"), HasSubstr("0.1 ms")));
  EXPECT_THAT(series({"0.001", "0.002", "0.04"}), AllOf(HasSubstr("0.04 s"), HasSubstr("0.03 s")));
  EXPECT_THAT(series({"0.001", "0.002", "0.001"}), HasSubstr("given twice"));
  EXPECT_THAT(series({"0.001", "0.0012", "0.0014"}), HasSubstr("less than twice the shortest"));
  EXPECT_THAT(series({"0.001", "0.002", "0.004", "--board", kBoard}), HasSubstr("stands beside --board"));
  EXPECT_THAT(run_calibrate({"capture", "--mock", "--out", folder_ / "s"}), HasSubstr("--board"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s"));
}

TEST_F(Capture, SaysWhichCamerasAreMissing) {
  const std::string out = folder_ / "set";
  EXPECT_THAT(capture({"--out", out}), AllOf(HasSubstr("say which cameras"), HasSubstr("--camera")));
  EXPECT_THAT(capture({"--out", out, "--left", "a"}), HasSubstr("name both cameras"));
  EXPECT_THAT(capture({"--out", out, "--camera", "a", "--images", left_}), HasSubstr("say which cameras"));
  EXPECT_THAT(capture({"--out", out, "--images", left_, "--only", "left"}), HasSubstr("--rig"));
  EXPECT_THAT(capture({"--out", out, "--camera", "/dev/null"}), HasSubstr("/dev/null"));
  EXPECT_THAT(capture({"--out", folder_ / "s2", "--images", "/nowhere"}), HasSubstr("/nowhere"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s2"));
}

}  // namespace
}  // namespace foresight::capture_test
