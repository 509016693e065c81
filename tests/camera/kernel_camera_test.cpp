// The kernel's own test driver: real V4L2 calls, buffers and faults. Needs "modprobe vivid n_devs=2".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "drivers/camera/stereo_camera.hpp"
#include "drivers/camera/v4l2_camera.hpp"

namespace foresight::kernel_camera_test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

const char* kDevices[] = {"bus:platform:vivid-000", "bus:platform:vivid-001"};

class Vivid : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* device : kDevices)
      if (!v4l2::find_device(v4l2::system_calls(), device, "test"))
        GTEST_SKIP() << "no " << device << "; modprobe vivid n_devs=2";
  }
  std::unique_ptr<V4l2Camera> camera(std::size_t i, PixelFormat format = PixelFormat::yuyv) {
    V4l2Camera::Options options;
    options.device = kDevices[i];
    options.settings.width = 640;
    options.settings.height = 360;
    options.settings.rate = 10;  // an emulated machine has no time for more
    options.settings.format = format;
    // 1: start of exposure. By default its stamps lie one period in the future.
    options.settings.controls = {{"timestamp_source", 1}, {"percentage_of_dropped_buffers", 0}};
    options.settings.readout = 0ms;
    return std::make_unique<V4l2Camera>(i == 0 ? "left" : "right", options, clock_);
  }
  /// By another handle than the camera's: at any time, and in any thread.
  static void set(std::size_t i, const char* control, std::int64_t value = 0) {
    const auto device = v4l2::find_device(v4l2::system_calls(), kDevices[i], "test");
    ASSERT_TRUE(device);
    v4l2::set_control(v4l2::system_calls(), *device, control, value, "test");
  }
  static std::string start_error(V4l2Camera& camera) {
    try {
      camera.start();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "(no error)";
  }
  /// The first status of that kind among the next 100.
  static bool becomes(V4l2Camera& camera, CameraStatus wanted) {
    CameraFrame frame;
    for (int i = 0; i < 100; ++i)
      if (camera.wait_frame(200ms, frame) == wanted) return true;
    return false;
  }

  MonotonicClock clock_;
};

TEST_F(Vivid, DeliversFramesOfNow) {
  const auto left = camera(0);
  left->start();
  CameraFrame frame;
  RobotTime last{};
  for (int i = 0; i < 30; ++i) {
    ASSERT_EQ(left->wait_frame(2s, frame), CameraStatus::ok);
    EXPECT_EQ(frame.bytes.size(), 640u * 360 * 2);
    EXPECT_GE(frame.dmabuf, 0);
    EXPECT_GT(frame.time, last);
    EXPECT_LT(std::chrono::abs(clock_.now() - frame.time), 2s);  // an emulated machine is slow, and may be held up
    last = frame.time;
    cv::Mat image;
    ASSERT_EQ(to_bgr(frame, image), Conversion::ok);
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    EXPECT_GT(deviation[0], 10) << "colour bars";
  }
  EXPECT_EQ(left->counters().frames, 30u);
}

// Nothing synchronises the two, so the tolerance is more than half a period; a machine that is held up is late.
constexpr PairingOptions kPairing{.tolerance = 51ms, .frozen_after = 500ms, .largest_age = 5s};

/// Vivid's bars: white, yellow, cyan, green, magenta, red, blue, black, at three quarters of full brightness.
void expect_bars(const cv::Mat& image, PixelFormat format) {
  double last_grey = 256;
  for (int bar = 0; bar < 8; ++bar) {
    const cv::Rect middle(image.cols * bar / 8 + image.cols / 32, image.rows * 3 / 4, image.cols / 16, image.rows / 8);
    const cv::Scalar mean = cv::mean(image(middle));
    const std::string where = std::string(to_string(format)) + ", bar " + std::to_string(bar);
    if (format == PixelFormat::grey) {
      EXPECT_LT(mean[0], last_grey - 5) << where << ": each is darker than the one before";
      last_grey = mean[0];
      continue;
    }
    const bool lit[] = {bar % 2 == 0, bar / 4 == 0, bar / 2 % 2 == 0};  // blue, green, red
    for (int c = 0; c < 3; ++c)
      EXPECT_TRUE(lit[c] ? mean[c] > 150 && mean[c] < 220 : mean[c] < 60) << where << ", channel " << c << ": " << mean;
  }
}

TEST_F(Vivid, EveryFormatShowsTheSameBars) {
  for (const PixelFormat format :
       {PixelFormat::yuyv, PixelFormat::nv12, PixelFormat::grey, PixelFormat::bgr, PixelFormat::bayer_rggb8,
        PixelFormat::bayer_bggr8, PixelFormat::bayer_gbrg8, PixelFormat::bayer_grbg8, PixelFormat::bayer_rggb10,
        PixelFormat::bayer_bggr10, PixelFormat::bayer_gbrg10, PixelFormat::bayer_grbg10}) {
    const auto left = camera(0, format);
    left->start();
    CameraFrame frame;
    ASSERT_EQ(left->wait_frame(2s, frame), CameraStatus::ok) << to_string(format);
    EXPECT_EQ(frame.format, format);
    cv::Mat image;
    ASSERT_EQ(to_bgr(frame, image), Conversion::ok) << to_string(format);
    expect_bars(image, format);
  }
  EXPECT_THAT(start_error(*camera(0, PixelFormat::mjpeg)), AllOf(HasSubstr("no format mjpeg"), HasSubstr("yuyv, ")));
}

TEST_F(Vivid, ADamagedFrameIsSkipped) {
  const auto left = camera(0);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  left->set_control("inject_v4l2_buf_flag_error", 0);
  CameraFrame frame;
  for (int i = 0; i < 20 && left->counters().corrupt == 0; ++i) left->wait_frame(200ms, frame);
  EXPECT_EQ(left->counters().corrupt, 1u);
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
  EXPECT_EQ(left->counters().restarts, 0u);
}

TEST_F(Vivid, DroppedFramesAreGaps) {
  const auto left = camera(0);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  set(0, "percentage_of_dropped_buffers", 60);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(becomes(*left, CameraStatus::ok));
  set(0, "percentage_of_dropped_buffers", 0);
  EXPECT_GT(left->counters().gaps, 5u);
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
}

TEST_F(Vivid, ABufferThatIsRefusedRestartsTheStream) {
  const auto left = camera(0);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  left->set_control("inject_vidioc_qbuf_error", 0);
  for (int i = 0; i < 10 && left->counters().restarts == 0; ++i) becomes(*left, CameraStatus::ok);
  EXPECT_EQ(left->counters().restarts, 1u);
  EXPECT_EQ(left->counters().losses, 0u);
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
}

TEST_F(Vivid, AFatalErrorRestartsTheStream) {
  const auto left = camera(0);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  left->set_control("inject_fatal_streaming_error", 0);
  for (int i = 0; i < 10 && left->counters().restarts == 0; ++i) becomes(*left, CameraStatus::ok);
  EXPECT_EQ(left->counters().restarts, 1u);
  EXPECT_EQ(left->counters().losses, 0u);
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
}

TEST_F(Vivid, WhatFailsAtStartIsNamedAndTheNextStartSucceeds) {
  constexpr struct {
    const char *button, *call;
  } kFaults[] = {{"inject_vidioc_reqbufs_error", "VIDIOC_REQBUFS"},
                 {"inject_vidioc_qbuf_error", "VIDIOC_"},
                 {"inject_vidioc_streamon_error", "VIDIOC_STREAMON"}};
  for (const auto& fault : kFaults) {
    const auto left = camera(0);
    set(0, fault.button);
    EXPECT_THAT(start_error(*left), AllOf(HasSubstr("'left'"), HasSubstr(fault.call), HasSubstr("(errno 22)")))
        << fault.button;
    left->start();
    EXPECT_TRUE(becomes(*left, CameraStatus::ok)) << fault.button;
  }
}

TEST_F(Vivid, MakesStereoPairs) {
  StereoCamera stereo(camera(0), camera(1), clock_, kPairing);
  stereo.start();
  int pairs = 0;
  for (int i = 0; i < 40; ++i)
    if (const auto pair = stereo.take(500ms)) {
      ++pairs;
      EXPECT_LE(std::chrono::abs(pair->left.time - pair->right.time), kPairing.tolerance);
    }
  const StereoStatus status = stereo.status();
  EXPECT_GE(pairs, 20) << status.reason << "; unpaired " << status.pairing.unpaired[0] << ", "
                       << status.pairing.unpaired[1] << "; wrong times " << status.pairing.jumps[0] << ", "
                       << status.pairing.jumps[1] << "; dropped " << status.dropped;
}

// Vivid comes back when nobody has the old device open any more: when our driver has closed it, and looks again.
TEST_F(Vivid, ZUnplugged) {
  StereoCamera stereo(camera(0), camera(1), clock_, kPairing);
  stereo.start();
  ASSERT_TRUE(stereo.take(5s)) << stereo.status().reason;
  set(0, "disconnect");
  StereoStatus status = stereo.status();
  for (int i = 0; i < 250 && status.cameras[0] != CameraStatus::lost; ++i) {
    stereo.take(20ms);
    status = stereo.status();
  }
  EXPECT_EQ(status.cameras[0], CameraStatus::lost);
  EXPECT_THAT(fault_text(status), HasSubstr("the left camera is lost"));
  EXPECT_NE(status.cameras[1], CameraStatus::lost);
  while (stereo.take(0ms)) {
  }
  EXPECT_TRUE(stereo.take(10s)) << stereo.status().reason;
}

}  // namespace
}  // namespace foresight::kernel_camera_test
