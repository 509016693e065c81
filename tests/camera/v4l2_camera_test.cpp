#include "drivers/camera/v4l2_camera.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "fake_v4l2.hpp"

namespace foresight::v4l2_camera_test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

class V4l2 : public testing::Test {
 protected:
  V4l2() : kernel_(clock_) {
    options_.device = "/dev/video2";
    options_.settings.width = 64;
    options_.settings.height = 48;
    options_.settings.readout = 20ms;
  }
  void start() {
    camera_ = std::make_unique<V4l2Camera>("left", options_, clock_, kernel_);
    camera_->start();
  }
  CameraStatus wait(Duration timeout = 100ms) { return camera_->wait_frame(timeout, frame_); }
  /// So many waits; the last status.
  CameraStatus waits(int n) {
    CameraStatus status = CameraStatus::timeout;
    for (int i = 0; i < n; ++i) status = wait();
    return status;
  }
  std::string error() {
    try {
      start();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "(no error)";
  }

  SteppedClock clock_;
  FakeV4l2 kernel_;
  V4l2Camera::Options options_;
  std::unique_ptr<V4l2Camera> camera_;
  CameraFrame frame_;
};

TEST_F(V4l2, DeliversFramesWithMidExposureTimes) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(frame_.format, PixelFormat::yuyv);
  EXPECT_EQ(frame_.stride, 128u);
  EXPECT_EQ(frame_.bytes.size(), 64u * 48 * 2);
  EXPECT_EQ(frame_.bytes[0], frame_.sequence);
  EXPECT_GE(frame_.dmabuf, 0);
  // The first tick was at one period, its exposure began at 0; 10 ms exposure, 20 ms readout.
  EXPECT_EQ(Duration{frame_.time.ns}, 15ms);
  EXPECT_EQ(frame_.uncertainty, 1ms);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().frames, 1001u);
  EXPECT_EQ(camera_->counters().gaps, 0u);
}

TEST_F(V4l2, StampsAtTheEndOfTheFrame) {
  kernel_.clear_flags = V4L2_BUF_FLAG_TSTAMP_SRC_MASK;
  kernel_.jump = 100ms;
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(Duration{frame_.time.ns}, 100ms - 15ms);
}

TEST_F(V4l2, WhatIsUnknownWidensTheUncertainty) {
  kernel_.exposure = 0;
  options_.settings.readout = Duration{-1};
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_NEAR(to_seconds(frame_.uncertainty), 0.001 + 0.5 / 30, 1e-6);
  kernel_.clear_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_GT(frame_.uncertainty, 30ms);
}

TEST_F(V4l2, IsFoundBySerialNumberAndBus) {
  for (const char* device : {"serial:C0FFEE", "bus:usb-fake-1"}) {
    options_.device = device;
    start();
    EXPECT_EQ(wait(), CameraStatus::ok) << device;
  }
}

TEST_F(V4l2, NamesWhatIsThere) {
  options_.device = "serial:DEAD";
  EXPECT_THAT(error(),
              AllOf(HasSubstr("'left'"), HasSubstr("serial:DEAD"), HasSubstr("/dev/video2"), HasSubstr("C0FFEE")));
  options_.device = "/dev/video0";
  EXPECT_THAT(error(), HasSubstr("does not capture"));
  options_.device = "video2";
  EXPECT_THAT(error(), HasSubstr("names no device"));
  options_.device = "/dev/video2";
  options_.settings.format = PixelFormat::nv12;
  EXPECT_THAT(error(), AllOf(HasSubstr("nv12"), HasSubstr("yuyv, mjpeg")));
  options_.settings.format = PixelFormat::yuyv;
  options_.settings.width = 80;
  EXPECT_THAT(error(), AllOf(HasSubstr("80x48"), HasSubstr("64x48")));
  options_.settings.width = 64;
  options_.settings.controls = {{"exposure_time", 10}};
  EXPECT_THAT(error(), AllOf(HasSubstr("'exposure_time'"), HasSubstr("'exposure_time_absolute'")));
  options_.settings.controls = {{"brightness", 256}};
  EXPECT_THAT(error(), AllOf(HasSubstr("brightness = 256"), HasSubstr("0 to 255")));
  EXPECT_EQ(kernel_.mapped, 0);
}

TEST_F(V4l2, TheExposureIsFixedOrRefused) {
  options_.settings.exposure = 5ms;
  start();
  EXPECT_EQ(kernel_.controls[V4L2_CID_EXPOSURE_AUTO], V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(kernel_.exposure, 50u);
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(Duration{frame_.time.ns}, 12500us) << "and counts for the capture time";
  kernel_.failures = {{VIDIOC_S_CTRL, ERANGE}};
  options_.settings.exposure = 20ms;
  EXPECT_THAT(error(), AllOf(HasSubstr("0.020000 s"), HasSubstr("stands at 0.005000 s")));
  kernel_.failures.clear();
  kernel_.failures = {{VIDIOC_G_CTRL, EINVAL}};
  EXPECT_THAT(error(), HasSubstr("cannot be set"));
}

TEST_F(V4l2, SetUpFailuresNameTheCallAndLeaveNothingBehind) {
  for (const unsigned long call : {VIDIOC_REQBUFS, VIDIOC_QUERYBUF, VIDIOC_QBUF, VIDIOC_STREAMON}) {
    kernel_.failures = {{call, EBUSY}};
    EXPECT_THAT(error(), HasSubstr("errno 16")) << call;
    EXPECT_EQ(kernel_.mapped, 0);
  }
}

TEST_F(V4l2, WithoutExportThereIsStillTheMapping) {
  kernel_.failures = {{VIDIOC_EXPBUF, ENOTTY}};
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(frame_.dmabuf, -1);
}

TEST_F(V4l2, DamagedFramesAreSkippedAndCounted) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  const std::uint64_t last = frame_.sequence;
  kernel_.extra_flags = V4L2_BUF_FLAG_ERROR;
  EXPECT_EQ(waits(3), CameraStatus::corrupt);
  kernel_.extra_flags = 0;
  kernel_.bytes_used = 1000;
  EXPECT_EQ(wait(), CameraStatus::corrupt) << "truncated";
  EXPECT_EQ(frame_.sequence, last) << "untouched";
  kernel_.bytes_used = 0;
  EXPECT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().corrupt, 4u);
  EXPECT_EQ(camera_->counters().gaps, 0u);
  EXPECT_EQ(kernel_.queued(), 3u) << "all but the lent buffer are with the driver";
}

TEST_F(V4l2, GapsAreCounted) {
  start();
  waits(2);
  kernel_.skip = 3;
  EXPECT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().gaps, 3u);
}

TEST_F(V4l2, AHangingStreamIsRestarted) {
  start();
  waits(2);
  kernel_.hangs = true;
  for (int i = 0; i < 20 && wait() != CameraStatus::ok; ++i) {
  }
  EXPECT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().restarts, 1u);
  EXPECT_EQ(camera_->counters().gaps, 0u) << "the count began anew";
  EXPECT_EQ(camera_->counters().losses, 0u);
}

TEST_F(V4l2, OneThatHangsForGoodIsLost) {
  start();
  kernel_.hangs_for_good = true;
  for (int i = 0; i < 100 && wait() != CameraStatus::lost; ++i) {
  }
  EXPECT_EQ(camera_->counters().losses, 1u);
  EXPECT_EQ(camera_->counters().restarts, 3u);
  kernel_.hangs_for_good = false;
  waits(10);
  EXPECT_EQ(wait(), CameraStatus::ok);
}

TEST_F(V4l2, ComesBackWithItsSettingsAfterAnUnplug) {
  options_.device = "serial:C0FFEE";
  options_.settings.controls = {{"brightness", 7}};
  start();
  waits(3);
  camera_->set_control("brightness", 9);
  kernel_.present = false;
  EXPECT_EQ(wait(), CameraStatus::lost);
  EXPECT_EQ(kernel_.mapped, 0);
  const int opened = kernel_.opened;
  EXPECT_EQ(waits(20), CameraStatus::lost);
  kernel_.present = true;
  kernel_.controls.clear();
  for (int i = 0; i < 10 && wait() != CameraStatus::ok; ++i) {
  }
  EXPECT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(kernel_.controls[V4L2_CID_BRIGHTNESS], 9);
  EXPECT_LE(kernel_.opened - opened, 4) << "does not hammer the device";
  EXPECT_EQ(camera_->counters().losses, 1u);
}

TEST_F(V4l2, ErrorsOfDequeueRestartTheStream) {
  start();
  kernel_.failures = {{VIDIOC_DQBUF, EIO}};
  EXPECT_EQ(wait(), CameraStatus::corrupt);
  kernel_.failures.clear();
  EXPECT_EQ(waits(2), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().restarts, 1u);
}

TEST_F(V4l2, LeaksNoDescriptors) {
  const auto next_free = [] {
    const UniqueFd fd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    return fd.get();
  };
  const int before = next_free();
  for (int i = 0; i < 5; ++i) {
    start();
    wait();
    kernel_.present = false;
    wait();
    kernel_.present = true;
    waits(20);
    camera_.reset();
  }
  EXPECT_EQ(next_free(), before);
}

TEST_F(V4l2, ListsControls) {
  start();
  const auto controls = camera_->controls();
  ASSERT_EQ(controls.size(), 2u);
  EXPECT_EQ(controls[1].name, "exposure_time_absolute");
  EXPECT_EQ(controls[1].value, 100);
}

TEST(SystemV4l2, SaysWhatIsMissing) {
  MonotonicClock clock;
  V4l2Camera camera("left", {.device = "serial:no such camera", .settings = {}}, clock);
  EXPECT_THROW(camera.start(), InputError);
  CameraFrame frame;
  EXPECT_EQ(camera.wait_frame(0ms, frame), CameraStatus::lost);
}

}  // namespace
}  // namespace foresight::v4l2_camera_test
