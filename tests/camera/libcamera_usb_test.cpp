// libcamera itself on emulated USB cameras. It names a camera after where it is plugged in, so it needs a bus whose
// controller has a firmware node; and udevd tells it of what comes.
#include <cstdlib>

#include "drivers/camera/libcamera_camera.hpp"
#include "tests/camera/emulated_cameras.hpp"

namespace foresight::libcamera_usb_test {
namespace {

using namespace std::chrono_literals;

constexpr double kRate = 30;  // frames/s: libcamera takes the camera's own

class LibcameraUsb : public EmulatedCameras {
 protected:
  void SetUp() override {
    if (!libcam::is_built_in()) GTEST_SKIP() << "built without libcamera; install libcamera-dev and rebuild";
    EmulatedCameras::SetUp();
    if (HasFatalFailure() || IsSkipped()) return;
    // Ports are numbered from 1, and end the path: "...-1:1.0-1d6b:0102".
    for (int i = 0; i < 100 && (id(0).empty() || id(1).empty()); ++i) clock_.sleep_until(clock_.now() + 100ms);
    ASSERT_FALSE(id(0).empty() || id(1).empty()) << "libcamera knows " << libcam::library().cameras().size();
  }
  /// "" where libcamera does not know it.
  static std::string id(std::size_t side) {
    const std::string port = "-" + std::to_string(side + 1) + ":1.0-";
    for (const std::string& camera : libcam::library().cameras())
      if (camera.find(port) != std::string::npos) return camera.substr(0, camera.find(" ("));
    return {};
  }
  std::unique_ptr<LibcameraCamera> camera(std::size_t side, PixelFormat format) {
    LibcameraCamera::Options options;
    options.device = id(side);
    options.settings = settings_of(side, format, kRate);
    return std::make_unique<LibcameraCamera>(kNames[side], options, clock_);
  }
  std::unique_ptr<StereoCamera> pair_of(PixelFormat format) {
    return EmulatedCameras::pair_of(camera(0, format), camera(1, format));
  }
  /// How long it took to notice.
  Duration expect_loss_of_left(StereoCamera& stereo) {
    EXPECT_TRUE(stereo.take(5s)) << stereo.status().reason;
    const RobotTime before = clock_.now();
    emulated_[0].reset();
    EXPECT_TRUE(comes_to(stereo, [](const StereoStatus& s) { return s.cameras[0] == CameraStatus::lost; }))
        << stereo.status().reason;
    const Duration noticed = clock_.now() - before;
    std::printf("noticed after %.2f s\n", to_seconds(noticed));
    EXPECT_NE(stereo.status().cameras[1], CameraStatus::lost) << "the other one goes on";
    EXPECT_EQ(fault_text(stereo.status()),
              "the left camera is lost: unplugged, or nothing comes; opened again on return");
    return noticed;
  }
  void expect_return_of_left(StereoCamera& stereo) {
    while (stereo.take(0ms)) {
    }
    plug_in(0);
    const auto pair = stereo.take(20s);
    ASSERT_TRUE(pair) << stereo.status().reason;
    EXPECT_EQ(number_of(0, pair->left.bgr), number_of(1, pair->right.bgr));
  }
};

TEST_F(LibcameraUsb, ShowTheLabInBothFormats) {
  for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::mjpeg}) {
    const auto left = camera(0, format);
    left->start();
    expect_the_lab(*left, 0, 10);
  }
}

TEST_F(LibcameraUsb, PairsShowTheSameInstant) {
  const auto stereo = pair_of(PixelFormat::yuyv);
  stereo->start();
  for (int i = 0; i < 10; ++i) {
    const auto pair = stereo->take(5s);
    ASSERT_TRUE(pair) << stereo->status().reason;
    EXPECT_EQ(number_of(0, pair->left.bgr), number_of(1, pair->right.bgr));
  }
}

TEST_F(LibcameraUsb, AStreamThatHangsIsOpenedAnew) {
  const auto left = camera(0, PixelFormat::yuyv);
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

TEST_F(LibcameraUsb, OneThatIsUnpluggedIsLostAndReturnsUnderItsId) {
  const auto stereo = pair_of(PixelFormat::yuyv);
  stereo->start();
  expect_loss_of_left(*stereo);
  expect_return_of_left(*stereo);
}

// Without udevd's word libcamera says nothing at all, not even by an error: only the watchdog does.
TEST_F(LibcameraUsb, AnUnplugThatNobodyTellsIsFoundByTheWatchdog) {
  const auto stereo = pair_of(PixelFormat::yuyv);
  stereo->start();
  ASSERT_TRUE(stereo->take(5s)) << stereo->status().reason;
  ASSERT_EQ(std::system("udevadm control --stop-exec-queue"), 0);
  const Duration noticed = expect_loss_of_left(*stereo);
  EXPECT_GE(noticed, 800ms) << "a watchdog's time";
  EXPECT_LT(noticed, 8s);
  ASSERT_EQ(std::system("udevadm control --start-exec-queue"), 0);
  expect_return_of_left(*stereo);
}

}  // namespace
}  // namespace foresight::libcamera_usb_test
