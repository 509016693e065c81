// The kernel's own test driver: real V4L2 calls, buffers and faults. Needs "modprobe vivid n_devs=2".
#include <gtest/gtest.h>

#include "drivers/camera/stereo_camera.hpp"
#include "drivers/camera/v4l2_camera.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

const char* kDevices[] = {"bus:platform:vivid-000", "bus:platform:vivid-001"};

class Vivid : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* device : kDevices)
      if (!v4l2::find_device(v4l2::system_calls(), device, "test"))
        GTEST_SKIP() << "no " << device << "; modprobe vivid n_devs=2";
  }
  std::unique_ptr<V4l2Camera> camera(std::size_t i) {
    V4l2Camera::Options options;
    options.device = kDevices[i];
    options.settings.width = 640;
    options.settings.height = 360;
    // 1: start of exposure. By default its stamps lie one period in the future.
    options.settings.controls = {{"timestamp_source", 1}, {"percentage_of_dropped_buffers", 0}};
    options.settings.readout = 0ms;
    return std::make_unique<V4l2Camera>(i == 0 ? "left" : "right", options, clock_);
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
    EXPECT_LT(std::chrono::abs(clock_.now() - frame.time), 500ms);  // emulated machines are slow
    last = frame.time;
    cv::Mat image;
    ASSERT_EQ(to_bgr(frame, image), Conversion::ok);
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    EXPECT_GT(deviation[0], 10) << "colour bars";
  }
  EXPECT_EQ(left->counters().frames, 30u);
}

TEST_F(Vivid, FaultsAreSeenAndPass) {
  const auto left = camera(0);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  left->set_control("inject_v4l2_buf_flag_error", 0);
  EXPECT_TRUE(becomes(*left, CameraStatus::corrupt));
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
  left->set_control("percentage_of_dropped_buffers", 60);
  for (int i = 0; i < 20; ++i) becomes(*left, CameraStatus::ok);
  EXPECT_GT(left->counters().gaps, 0u);
  left->set_control("percentage_of_dropped_buffers", 0);
  left->set_control("inject_fatal_streaming_error", 0);
  for (int i = 0; i < 40; ++i) becomes(*left, CameraStatus::ok);
  EXPECT_GT(left->counters().restarts + left->counters().losses, 0u);
  EXPECT_TRUE(becomes(*left, CameraStatus::ok));
}

TEST_F(Vivid, MakesStereoPairs) {
  PairingOptions options;
  options.tolerance = 16ms;
  StereoCamera stereo(camera(0), camera(1), clock_, options);
  stereo.start();
  int pairs = 0;
  for (int i = 0; i < 40; ++i)
    if (const auto pair = stereo.take(500ms)) {
      ++pairs;
      EXPECT_LE(std::chrono::abs(pair->left.time - pair->right.time), 16ms);
    }
  EXPECT_GE(pairs, 20) << stereo.status().reason;
}

TEST_F(Vivid, ZUnplugged) {  // the last one: that device does not come back
  const auto left = camera(0);
  left->start();
  ASSERT_TRUE(becomes(*left, CameraStatus::ok));
  left->set_control("disconnect", 0);
  EXPECT_TRUE(becomes(*left, CameraStatus::lost));
}

}  // namespace
}  // namespace foresight
