// A pair of USB cameras under the kernel's usbcore and uvcvideo, which are emulated (tests/devices/usb_camera) and show
// the stereo images of a run. Needs "modprobe vhci-hcd uvcvideo", root, and the run's folder in FORESIGHT_PICTURES.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "drivers/camera/stereo_camera.hpp"
#include "drivers/camera/v4l2_camera.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;
using namespace std::string_view_literals;
namespace fs = std::filesystem;

constexpr double kRate = 10;  // frames/s: a guest takes 30 ms for a JPEG
const char* const kNames[] = {"left", "right"};

/// Plugged in from construction to destruction.
class EmulatedCamera {
 public:
  EmulatedCamera(std::size_t side, const fs::path& pictures) {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "usb_camera";
    const std::string command =
        program.string() + " " + std::to_string(side) + " " + kNames[side] + " " + pictures.string() + " >/dev/null";
    process_ = popen(command.c_str(), "we");
  }
  ~EmulatedCamera() { pclose(process_); }
  EmulatedCamera(const EmulatedCamera&) = delete;
  EmulatedCamera& operator=(const EmulatedCamera&) = delete;

  void disturb(const char* what) {
    std::fprintf(process_, "%s\n", what);
    std::fflush(process_);
  }

 private:
  std::FILE* process_;
};

std::string selector(std::size_t side) {
  return std::string("serial:") + kNames[side];
}

cv::Mat thumbnail(const cv::Mat& image) {
  cv::Mat out;
  cv::resize(image, out, {image.cols / 8, image.rows / 8}, 0, 0, cv::INTER_AREA);
  return out;
}

class UsbCameras : public testing::Test {
 protected:
  void SetUp() override {
    const char* const run = std::getenv("FORESIGHT_PICTURES");
    if (run == nullptr) GTEST_SKIP() << "FORESIGHT_PICTURES names no stereo run; see scripts/test-devices";
    if (!fs::exists("/sys/devices/platform/vhci_hcd.0/attach")) GTEST_SKIP() << "no vhci_hcd.0; modprobe vhci-hcd";
    for (std::size_t side : {0, 1}) {
      folders_[side] = fs::path(run) / (side == 0 ? "rgb" : "rgb_right");
      std::vector<fs::path> files;
      for (const auto& entry : fs::directory_iterator(folders_[side])) files.push_back(entry.path());
      std::sort(files.begin(), files.end());
      for (const fs::path& file : files) pictures_[side].push_back(cv::imread(file.string()));
      for (const cv::Mat& picture : pictures_[side]) thumbnails_[side].push_back(thumbnail(picture));
    }
    for (std::size_t side : {0, 1})
      if (!emulated_[side]) plug_in(side);
  }
  static void TearDownTestSuite() {
    for (auto& camera : emulated_) camera.reset();
  }

  static bool is_there(std::size_t side) {
    return v4l2::find_device(v4l2::system_calls(), selector(side), "test").has_value();
  }
  /// One after the other: the controller takes no second device while it resets the first.
  void plug_in(std::size_t side) {
    emulated_[side] = std::make_unique<EmulatedCamera>(side, folders_[side]);
    for (int i = 0; i < 600 && !is_there(side); ++i) clock_.sleep_until(clock_.now() + 50ms);
    ASSERT_TRUE(is_there(side)) << "camera " << kNames[side] << " did not appear";
  }
  std::unique_ptr<V4l2Camera> camera(std::size_t side, PixelFormat format) {
    V4l2Camera::Options options;
    options.device = selector(side);
    options.settings.width = pictures_[side][0].cols;
    options.settings.height = pictures_[side][0].rows;
    options.settings.format = format;
    options.settings.rate = kRate;
    return std::make_unique<V4l2Camera>(kNames[side], options, clock_);
  }
  std::unique_ptr<StereoCamera> pair_of(PixelFormat format) {
    PairingOptions options;
    options.largest_age = 5s;  // a machine that is held up is late
    return std::make_unique<StereoCamera>(camera(0, format), camera(1, format), clock_, options);
  }
  static bool becomes(V4l2Camera& camera, CameraStatus wanted) {
    CameraFrame frame;
    for (int i = 0; i < 100; ++i)
      if (camera.wait_frame(200ms, frame) == wanted) return true;
    return false;
  }
  /// Until that is true of the pair's status, 10 s at most.
  template <typename Condition>
  static bool comes_to(StereoCamera& stereo, Condition condition) {
    for (int i = 0; i < 100; ++i) {
      stereo.take(100ms);
      if (condition(stereo.status())) return true;
    }
    return false;
  }
  /// The number of the picture that looks most like `image`.
  std::size_t number_of(std::size_t side, const cv::Mat& image) const {
    const cv::Mat small = thumbnail(image);
    std::size_t best = 0;
    double least = 1e300;
    for (std::size_t i = 0; i < thumbnails_[side].size(); ++i) {
      const double difference = cv::norm(small, thumbnails_[side][i], cv::NORM_L1);
      if (difference < least) {
        least = difference;
        best = i;
      }
    }
    return best;
  }

  MonotonicClock clock_;
  std::array<fs::path, 2> folders_;
  std::array<std::vector<cv::Mat>, 2> pictures_, thumbnails_;
  static std::array<std::unique_ptr<EmulatedCamera>, 2> emulated_;  // of all tests: to plug one in takes seconds
};
std::array<std::unique_ptr<EmulatedCamera>, 2> UsbCameras::emulated_;

TEST_F(UsbCameras, ShowTheLabInBothFormats) {
  for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::mjpeg}) {
    const auto left = camera(0, format);
    left->start();
    EXPECT_NEAR(left->settings().rate, kRate, 1e-3);
    CameraFrame frame;
    RobotTime last{};
    std::size_t number = 0;
    for (int i = 0; i < 10; ++i) {
      ASSERT_EQ(left->wait_frame(2s, frame), CameraStatus::ok) << to_string(format);
      EXPECT_GT(frame.time, last);
      EXPECT_LT(std::chrono::abs(clock_.now() - frame.time), 2s);  // an emulated machine is slow, and may be held up
      last = frame.time;
      cv::Mat image;
      ASSERT_EQ(to_bgr(frame, image), Conversion::ok);
      const std::size_t shown = number_of(0, image);
      EXPECT_TRUE(i == 0 || shown != number) << "the picture stands still";
      number = shown;
      // Half the colours' resolution, and JPEG's quantisation, cost that much; a wrong matrix or picture far more.
      EXPECT_GT(cv::PSNR(image, pictures_[0][shown]), 28) << to_string(format) << " picture " << shown;
    }
  }
}

TEST_F(UsbCameras, PairsShowTheSameInstant) {
  for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::mjpeg}) {
    const auto stereo = pair_of(format);
    stereo->start();
    for (int i = 0; i < 10; ++i) {
      const auto pair = stereo->take(5s);
      ASSERT_TRUE(pair) << stereo->status().reason;
      EXPECT_EQ(number_of(0, pair->left.bgr), number_of(1, pair->right.bgr)) << to_string(format);
    }
  }
}

// uvcvideo itself drops damaged frames, unless loaded with nodrop=1: then their number is missing.
TEST_F(UsbCameras, DamagedFramesAreSeen) {
  const bool passed_on = [] {
    std::ifstream file("/sys/module/uvcvideo/parameters/nodrop");
    int value = 0;
    return file >> value && value != 0;
  }();
  const auto left = camera(0, PixelFormat::yuyv);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  std::uint64_t faults = 0;
  for (const char* fault : {"error", "short"}) {
    emulated_[0]->disturb(fault);
    ++faults;
    const auto seen = [&] { return passed_on ? left->counters().corrupt : left->counters().gaps; };
    for (int i = 0; i < 20 && seen() < faults; ++i) {
      CameraFrame frame;
      left->wait_frame(200ms, frame);
    }
    EXPECT_GE(seen(), faults) << fault;
    EXPECT_TRUE(becomes(*left, CameraStatus::ok)) << fault;
  }
  EXPECT_EQ(left->counters().restarts, 0u);
  EXPECT_EQ(left->counters().losses, 0u);
}

TEST_F(UsbCameras, ATruncatedJpegIsNoPicture) {
  const auto stereo = pair_of(PixelFormat::mjpeg);
  stereo->start();
  ASSERT_TRUE(stereo->take(5s)) << stereo->status().reason;
  emulated_[0]->disturb("short");
  EXPECT_TRUE(comes_to(*stereo, [](const StereoStatus& s) { return s.corrupt[0] > 0; }));
  EXPECT_EQ(stereo->status().corrupt[1], 0u);
  EXPECT_TRUE(stereo->take(5s)) << stereo->status().reason;
}

TEST_F(UsbCameras, AStreamThatHangsIsRestarted) {
  const auto left = camera(0, PixelFormat::mjpeg);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  emulated_[0]->disturb("hang");
  for (int i = 0; i < 50 && left->counters().restarts == 0; ++i) {
    CameraFrame frame;
    left->wait_frame(200ms, frame);
  }
  EXPECT_EQ(left->counters().restarts, 1u);
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
  EXPECT_EQ(left->counters().losses, 0u);
}

TEST_F(UsbCameras, OneThatFreezesIsNamedAndReturns) {
  const auto stereo = pair_of(PixelFormat::mjpeg);
  stereo->start();
  ASSERT_TRUE(stereo->take(5s)) << stereo->status().reason;
  emulated_[1]->disturb("freeze");
  EXPECT_TRUE(comes_to(*stereo, [](const StereoStatus& s) { return s.cameras[1] == CameraStatus::lost; }));
  EXPECT_STREQ(stereo->status().reason, "the right camera is frozen");
  EXPECT_NE(stereo->status().cameras[0], CameraStatus::lost);
  while (stereo->take(0ms)) {  // of before
  }
  emulated_[1]->disturb("resume");
  EXPECT_TRUE(stereo->take(10s)) << stereo->status().reason;
  EXPECT_TRUE(comes_to(*stereo, [](const StereoStatus& s) { return *s.reason == 0; }));
}

TEST_F(UsbCameras, OneThatIsUnpluggedReturnsUnderItsSerialNumber) {
  const auto stereo = pair_of(PixelFormat::mjpeg);
  stereo->start();
  ASSERT_TRUE(stereo->take(5s)) << stereo->status().reason;
  emulated_[0].reset();
  EXPECT_TRUE(comes_to(*stereo, [](const StereoStatus& s) { return s.cameras[0] == CameraStatus::lost; }));
  EXPECT_TRUE(comes_to(*stereo, [](const StereoStatus& s) { return s.reason == "the left camera is frozen"sv; }))
      << stereo->status().reason;
  while (stereo->take(0ms)) {
  }
  plug_in(0);
  const auto pair = stereo->take(10s);
  ASSERT_TRUE(pair) << stereo->status().reason;
  EXPECT_EQ(number_of(0, pair->left.bgr), number_of(1, pair->right.bgr));
}

}  // namespace
}  // namespace foresight
