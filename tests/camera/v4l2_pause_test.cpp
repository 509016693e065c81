// A caller that was held up while frames came.
#include <gtest/gtest.h>

#include "drivers/camera/v4l2_camera.hpp"
#include "fake_v4l2.hpp"

namespace foresight::v4l2_pause_test {
namespace {

using namespace std::chrono_literals;

class V4l2Pause : public testing::Test {
 protected:
  void start(int buffers) {
    V4l2Camera::Options options;
    options.device = "/dev/video2";
    options.settings.width = 64;
    options.settings.height = 48;
    options.settings.readout = 20ms;
    options.buffers = buffers;
    camera_ = std::make_unique<V4l2Camera>("left", options, clock_, kernel_);
    camera_->start();
  }
  CameraStatus wait() { return camera_->wait_frame(100ms, frame_); }
  void waits(int n) {
    for (int i = 0; i < n; ++i) wait();
  }
  void pause(Duration time) { clock_.sleep_until(clock_.now() + time); }

  SteppedClock clock_;
  FakeV4l2 kernel_{clock_};
  std::unique_ptr<V4l2Camera> camera_;
  CameraFrame frame_;
};

TEST_F(V4l2Pause, AfterAPauseTheNewestFrameComes) {
  start(8);
  waits(3);
  const std::uint64_t before = frame_.sequence;
  pause(110ms);
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(frame_.sequence, before + 3);
  EXPECT_EQ(frame_.bytes[0], frame_.sequence) << "its own buffer";
  EXPECT_LT(clock_.now() - frame_.time, 60ms);
  EXPECT_EQ(camera_->counters().dropped, 2u);
  EXPECT_EQ(camera_->counters().frames, 4u);
  EXPECT_EQ(camera_->counters().gaps, 0u) << "they came";
  EXPECT_EQ(kernel_.queued(), 7u) << "all but the lent buffer are with the driver";
}

TEST_F(V4l2Pause, AfterAPauseThatTookAllBuffersNoOldFrameComes) {
  for (const int buffers : {2, 3, 4, 8}) {
    start(buffers);
    waits(3);
    const std::uint64_t before = frame_.sequence;
    pause(2s);
    ASSERT_EQ(wait(), CameraStatus::ok) << buffers;
    if (buffers > 2) {  // with two, one is lent: one that waits is nothing strange
      EXPECT_GE(frame_.sequence, before + 60) << buffers;
      EXPECT_LT(clock_.now() - frame_.time, 60ms) << buffers;
    }
    ASSERT_EQ(wait(), CameraStatus::ok) << buffers;
    EXPECT_LT(clock_.now() - frame_.time, 60ms) << buffers;
    EXPECT_EQ(camera_->counters().dropped, buffers > 2 ? static_cast<std::size_t>(buffers) - 1 : 0) << buffers;
    EXPECT_EQ(camera_->counters().restarts + camera_->counters().losses, 0u) << buffers;
    EXPECT_EQ(kernel_.queued(), static_cast<std::size_t>(buffers) - 1) << buffers;
  }
}

TEST_F(V4l2Pause, DamagedFramesOfAPauseAreCountedAsThat) {
  start(8);
  waits(2);
  kernel_.extra_flags = V4L2_BUF_FLAG_ERROR;
  pause(110ms);
  EXPECT_EQ(wait(), CameraStatus::corrupt);
  kernel_.extra_flags = 0;
  EXPECT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().corrupt, 3u);
  EXPECT_EQ(camera_->counters().dropped, 0u);
}

TEST_F(V4l2Pause, ABufferRefusedAfterAPauseRestartsTheStream) {
  start(8);
  waits(2);
  pause(110ms);
  kernel_.refuse_after = 2;  // the lent one, and the one of the frame that is dropped
  for (int i = 0; i < 5 && wait() != CameraStatus::ok; ++i) {
  }
  EXPECT_EQ(camera_->counters().restarts, 1u);
  EXPECT_EQ(frame_.bytes[0], frame_.sequence) << "its own buffer";
  EXPECT_LT(clock_.now() - frame_.time, 60ms);
}

}  // namespace
}  // namespace foresight::v4l2_pause_test
