// The V4L2 driver on emulated USB cameras.
#include <fstream>
#include <string_view>

#include "drivers/camera/v4l2_camera.hpp"
#include "tests/camera/emulated_cameras.hpp"

namespace foresight::usb_camera_test {
namespace {

using namespace std::chrono_literals;
using namespace std::string_view_literals;

constexpr double kRate = 10;  // frames/s: a guest takes 30 ms for a JPEG

class UsbCameras : public EmulatedCameras {
 protected:
  std::unique_ptr<V4l2Camera> camera(std::size_t side, PixelFormat format) {
    V4l2Camera::Options options;
    options.device = selector(side);
    options.settings = settings_of(side, format, kRate);
    return std::make_unique<V4l2Camera>(kNames[side], options, clock_);
  }
  std::unique_ptr<StereoCamera> pair_of(PixelFormat format) {
    return EmulatedCameras::pair_of(camera(0, format), camera(1, format));
  }
};

TEST_F(UsbCameras, ShowTheLabInBothFormats) {
  for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::mjpeg}) {
    const auto left = camera(0, format);
    left->start();
    EXPECT_NEAR(left->settings().rate, kRate, 1e-3);
    expect_the_lab(*left, 0, 10);
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
}  // namespace foresight::usb_camera_test
