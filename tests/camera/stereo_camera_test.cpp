// Two threads, in real time.
#include "drivers/camera/stereo_camera.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

/// Makes frames at 200 fps; both cameras of a test share their instants.
class MadeUpCamera final : public Camera {
 public:
  MadeUpCamera(std::string name, Clock& clock) : name_(std::move(name)), clock_(clock), pixels_(8 * 6 * 3, 7) {}

  std::atomic<bool> frozen = false, damaged = false, gone = false, refuses = false, running = false;

  const std::string& name() const noexcept override { return name_; }
  void start() override {
    if (refuses) throw RuntimeFailure("no", "yes");
    running = true;
  }
  void stop() noexcept override { running = false; }
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override {
    if (gone) return CameraStatus::lost;
    const RobotTime now = clock_.now();
    if (frozen) {
      clock_.sleep_until(now + timeout);
      return CameraStatus::timeout;
    }
    const RobotTime due{(now.ns / kPeriod.count() + 1) * kPeriod.count()};
    clock_.sleep_until(due);
    out = {};
    out.width = 8;
    out.height = 6;
    out.stride = 24;
    out.bytes = std::span(pixels_).first(damaged ? 10 : pixels_.size());
    out.sequence = static_cast<std::uint64_t>(due.ns / kPeriod.count());
    out.time = due;
    return CameraStatus::ok;
  }
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override { return {}; }
  void set_control(const std::string&, std::int64_t) override {}
  CameraCounters counters() const noexcept override { return {}; }

 private:
  static constexpr Duration kPeriod = 5ms;
  std::string name_;
  Clock& clock_;
  std::vector<std::uint8_t> pixels_;
  CameraSettings settings_;
};

class Stereo : public testing::Test {
 protected:
  Stereo() {
    auto left = std::make_unique<MadeUpCamera>("left", clock_), right = std::make_unique<MadeUpCamera>("right", clock_);
    left_ = left.get();
    right_ = right.get();
    PairingOptions options;
    options.tolerance = 2ms;
    options.frozen_after = 150ms;
    stereo_ = std::make_unique<StereoCamera>(std::move(left), std::move(right), clock_, options);
  }
  /// Until `reason` is given as the status, 3 s at most.
  bool becomes(const std::string& reason) {
    for (int i = 0; i < 300 && stereo_->status().reason != reason; ++i) clock_.sleep_until(clock_.now() + 10ms);
    return stereo_->status().reason == reason;
  }

  bool becomes_lost() {
    for (int i = 0; i < 300 && stereo_->status().cameras[0] != CameraStatus::lost; ++i)
      clock_.sleep_until(clock_.now() + 10ms);
    return stereo_->status().cameras[0] == CameraStatus::lost;
  }

  MonotonicClock clock_;
  MadeUpCamera* left_;
  MadeUpCamera* right_;
  std::unique_ptr<StereoCamera> stereo_;
};

TEST_F(Stereo, GivesTheNewestPairToASlowConsumer) {
  stereo_->start();
  ASSERT_TRUE(stereo_->take(1s));
  clock_.sleep_until(clock_.now() + 200ms);
  const RobotTime before = clock_.now();
  const auto pair = stereo_->take(1s);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.sequence, pair->right.sequence);
  EXPECT_EQ(pair->left.bgr.at<cv::Vec3b>(5, 7), cv::Vec3b::all(7));
  EXPECT_LT(before - pair->left.time, 100ms) << "not from a queue; generous for a busy machine";
  EXPECT_GT(stereo_->status().dropped, 5u);
  EXPECT_STREQ(stereo_->status().reason, "");
}

TEST_F(Stereo, FaultsAreNamedAndPass) {
  stereo_->start();
  ASSERT_TRUE(stereo_->take(1s));
  right_->frozen = true;
  EXPECT_TRUE(becomes("the right camera is frozen"));
  right_->frozen = false;
  EXPECT_TRUE(becomes(""));
  left_->damaged = true;
  EXPECT_TRUE(becomes("the left camera is frozen")) << "nothing usable comes";
  EXPECT_GT(stereo_->status().corrupt[0], 3u);
  left_->damaged = false;
  left_->gone = true;
  EXPECT_TRUE(becomes_lost());
  EXPECT_TRUE(becomes("the left camera is frozen"));
  left_->gone = false;
  EXPECT_TRUE(becomes(""));
  EXPECT_TRUE(stereo_->take(1s));
}

TEST_F(Stereo, StartsBothOrNone) {
  right_->refuses = true;
  EXPECT_THROW(stereo_->start(), RuntimeFailure);
  EXPECT_FALSE(left_->running);
  right_->refuses = false;
  stereo_->start();
  EXPECT_TRUE(stereo_->take(1s));
  stereo_->stop();
  EXPECT_FALSE(left_->running);
  EXPECT_FALSE(right_->running);
  stereo_->start();
  EXPECT_TRUE(stereo_->take(1s));
}

}  // namespace
}  // namespace foresight
