// Two threads, and a time that moves only where a test says so: nothing depends on how busy the machine is.
#include "drivers/camera/stereo_camera.hpp"

#include <gtest/gtest.h>

#include <condition_variable>

#include "common/error.hpp"

namespace foresight::stereo_camera_test {
namespace {

using namespace std::chrono_literals;

/// Stands still until somebody waits, which takes no time. Any thread.
class HandClock final : public Clock {
 public:
  RobotTime now() const noexcept override { return RobotTime{ns_}; }
  void sleep_until(RobotTime time) noexcept override { ns_ = std::max(ns_.load(), time.ns); }

 private:
  std::atomic<std::int64_t> ns_ = 1'000'000'000;
};

/// Delivers the images that a test hands it.
class FedCamera final : public Camera {
 public:
  FedCamera(std::string name, Clock& clock) : name_(std::move(name)), clock_(clock), pixels_(8 * 6 * 3, 7) {}

  bool refuses = false;  ///< to start
  std::atomic<bool> running = false;

  /// Delivers an image of this instant; returns when whoever waited for it has come back for the next.
  void deliver(bool damaged = false) {
    std::unique_lock lock(mutex_);
    CameraFrame& frame = fed_.emplace();
    frame.width = 8;
    frame.height = 6;
    frame.stride = 24;
    frame.bytes = std::span(pixels_).first(damaged ? 10 : pixels_.size());
    frame.sequence = ++sequence_;
    frame.time = clock_.now();
    changed_.notify_all();
    changed_.wait(lock, [&] { return !fed_ && waits_; });
  }
  void unplug(bool unplugged) {
    const std::lock_guard lock(mutex_);
    gone_ = unplugged;
    changed_.notify_all();
  }

  const std::string& name() const noexcept override { return name_; }
  void start() override {
    if (refuses) throw RuntimeFailure("no", "yes");
    running = true;
  }
  void stop() noexcept override { running = false; }
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override {
    std::unique_lock lock(mutex_);
    waits_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, timeout, [&] { return fed_ || gone_; });
    waits_ = false;
    if (gone_) return CameraStatus::lost;
    if (!fed_) return CameraStatus::timeout;
    out = *fed_;
    fed_.reset();
    return CameraStatus::ok;
  }
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override { return {}; }
  void set_control(const std::string&, std::int64_t) override {}
  CameraCounters counters() const noexcept override { return {}; }

 private:
  std::string name_;
  Clock& clock_;
  std::vector<std::uint8_t> pixels_;
  CameraSettings settings_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<CameraFrame> fed_;
  bool waits_ = false, gone_ = false;
  std::uint64_t sequence_ = 0;
};

class Stereo : public testing::Test {
 protected:
  static constexpr Duration kPeriod = 5ms, kFrozenAfter = 150ms;

  Stereo() {
    auto left = std::make_unique<FedCamera>("left", clock_), right = std::make_unique<FedCamera>("right", clock_);
    left_ = left.get();
    right_ = right.get();
    PairingOptions options;
    options.tolerance = 2ms;
    options.frozen_after = kFrozenAfter;
    stereo_ = std::make_unique<StereoCamera>(std::move(left), std::move(right), clock_, options);
  }

  void pass(Duration time) { clock_.sleep_until(clock_.now() + time); }
  void deliver_pair() {
    pass(kPeriod);
    left_->deliver();
    right_->deliver();
  }
  std::string reason() const { return stereo_->status().reason; }
  CameraStatus left_status() const { return stereo_->status().cameras[0]; }

  HandClock clock_;
  FedCamera* left_;
  FedCamera* right_;
  std::unique_ptr<StereoCamera> stereo_;
};

TEST_F(Stereo, GivesTheNewestPairToASlowConsumer) {
  stereo_->start();
  EXPECT_EQ(reason(), "no image yet");
  deliver_pair();
  ASSERT_TRUE(stereo_->take(0ms));
  for (int i = 0; i < 40; ++i) deliver_pair();
  const auto pair = stereo_->take(0ms);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.sequence, 41u) << "not from a queue";
  EXPECT_EQ(pair->right.sequence, 41u);
  EXPECT_EQ(pair->left.time, clock_.now());
  EXPECT_EQ(pair->left.bgr.at<cv::Vec3b>(5, 7), cv::Vec3b::all(7));
  EXPECT_EQ(stereo_->status().dropped, 39u);
  EXPECT_EQ(reason(), "");
  EXPECT_FALSE(stereo_->take(0ms)) << "once";
}

TEST_F(Stereo, FaultsAreNamedAndPass) {
  stereo_->start();
  deliver_pair();
  const auto left_alone = [&](Duration time) {
    for (Duration t{0}; t < time; t += kPeriod) {
      pass(kPeriod);
      left_->deliver();
    }
  };
  left_alone(kFrozenAfter);
  EXPECT_EQ(reason(), "");
  left_alone(kPeriod);
  EXPECT_EQ(reason(), "the right camera is frozen");
  deliver_pair();
  EXPECT_EQ(reason(), "");
  for (int i = 0; i < 31; ++i) {
    pass(kPeriod);
    left_->deliver(true);
    right_->deliver();
  }
  EXPECT_EQ(reason(), "the left camera is frozen") << "nothing usable comes";
  EXPECT_EQ(stereo_->status().corrupt[0], 31u);
  EXPECT_EQ(stereo_->status().corrupt[1], 0u);

  left_->unplug(true);
  while (left_status() != CameraStatus::lost) std::this_thread::yield();
  EXPECT_EQ(reason(), "the left camera is frozen");
  EXPECT_EQ(fault_text(stereo_->status()).substr(0, 23), "the left camera is lost");
  left_->unplug(false);
  deliver_pair();
  EXPECT_EQ(left_status(), CameraStatus::ok);
  EXPECT_EQ(fault_text(stereo_->status()), "");
  EXPECT_TRUE(stereo_->take(0ms));
}

TEST_F(Stereo, StartsBothOrNone) {
  right_->refuses = true;
  EXPECT_THROW(stereo_->start(), RuntimeFailure);
  EXPECT_FALSE(left_->running);
  right_->refuses = false;
  for (int i = 0; i < 2; ++i) {
    stereo_->start();
    EXPECT_TRUE(left_->running && right_->running);
    deliver_pair();
    EXPECT_TRUE(stereo_->take(0ms));
    stereo_->stop();
    EXPECT_FALSE(left_->running || right_->running);
  }
}

}  // namespace
}  // namespace foresight::stereo_camera_test
