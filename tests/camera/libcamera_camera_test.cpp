// The driver above a libcamera that is made up, and what the real one says where there is no camera.
#include "drivers/camera/libcamera_camera.hpp"

#include <gmock/gmock.h>

#include <deque>

#include "common/error.hpp"

namespace foresight::libcamera_camera_test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr Duration kPeriod = 40ms;

/// One grey camera of 8x4 at 25 fps in stepped time. Stamps the start of the exposure.
class FakeLibrary final : public libcam::Library {
 public:
  explicit FakeLibrary(SteppedClock& clock) : clock_(clock) {
    clock.every(kPeriod, [this](RobotTime now) { tick(now); });
  }

  bool present = true;  ///< plugged in
  bool signals = true;  ///< tells of an unplug; else it just stalls
  bool hangs = false;   ///< until opened anew
  bool incomplete = false, cut = false, refuses = false;
  std::uint32_t skip = 0;
  std::size_t buffers = 4;  ///< at most 8
  std::optional<Duration> exposure = 10ms;
  int opened = 0, sessions = 0;
  std::map<std::string, std::int64_t> controls;

  std::vector<std::string> cameras() override {
    return present ? std::vector<std::string>{"usb-1 (Eye)"} : std::vector<std::string>{};
  }
  std::shared_ptr<libcam::Session> open_as(const CameraSettings& settings);
  std::shared_ptr<libcam::Session> open(const std::string& device, const CameraSettings& settings,
                                        const std::string& name) override {
    if (!present || device != "usb-1") throw InputError("camera '" + name + "'", "there is none", "connect it");
    return open_as(settings);
  }

 private:
  friend class FakeSession;
  void tick(RobotTime now);
  SteppedClock& clock_;
  std::array<std::vector<std::uint8_t>, 8> memory_;
  std::deque<std::size_t> queued_;
  std::deque<libcam::Finished> finished_;
  std::uint32_t sequence_ = 0;
};

class FakeSession final : public libcam::Session {
 public:
  FakeSession(FakeLibrary& library, const CameraSettings& settings) : library_(library), settings_(settings) {}
  ~FakeSession() override { --library_.sessions; }
  std::optional<libcam::Finished> wait(Duration timeout) noexcept override {
    const RobotTime until = library_.clock_.now() + timeout;
    while (library_.finished_.empty() && !gone() && library_.clock_.now() < until) library_.clock_.step_towards(until);
    if (library_.finished_.empty() || gone()) return std::nullopt;
    const auto out = library_.finished_.front();
    library_.finished_.pop_front();
    return out;
  }
  bool give_back(std::size_t buffer) noexcept override {
    if (library_.refuses) return false;
    library_.queued_.push_back(buffer);
    return true;
  }
  bool gone() const noexcept override { return !library_.present && library_.signals; }
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::size_t buffers() const noexcept override { return library_.buffers; }
  std::size_t stride() const noexcept override { return 8; }
  std::vector<CameraControl> controls() const override { return {}; }
  void set_control(const std::string& control, std::int64_t value) override { library_.controls[control] = value; }

 private:
  FakeLibrary& library_;
  CameraSettings settings_;
};

std::shared_ptr<libcam::Session> FakeLibrary::open_as(const CameraSettings& settings) {
  EXPECT_EQ(sessions, 0) << "a camera has one owner";
  ++opened;
  ++sessions;
  hangs = refuses = false;
  queued_.clear();
  for (std::size_t i = 0; i < buffers; ++i) queued_.push_back(i);
  finished_.clear();
  sequence_ = 0;
  for (auto& memory : memory_) memory.assign(32, 0);
  controls = settings.controls;
  return std::make_shared<FakeSession>(*this, settings);
}

void FakeLibrary::tick(RobotTime now) {
  if (sessions == 0 || !present || hangs) return;
  sequence_ += 1 + std::exchange(skip, 0);
  if (queued_.empty()) return;
  libcam::Finished out;
  out.buffer = queued_.front();
  queued_.pop_front();
  std::ranges::fill(memory_[out.buffer], static_cast<std::uint8_t>(sequence_));
  out.complete = !incomplete;
  out.sequence = sequence_;
  out.stamp = now - kPeriod;
  out.exposure = exposure;
  out.bytes = std::span(memory_[out.buffer]).first(cut ? 31 : 32);
  finished_.push_back(out);
}

class Libcamera : public testing::Test {
 protected:
  Libcamera() {
    options_.device = "usb-1";
    options_.settings.width = 8;
    options_.settings.height = 4;
    options_.settings.rate = 25;
    options_.settings.format = PixelFormat::grey;
    options_.settings.readout = 20ms;
  }
  void start() {
    camera_ = std::make_unique<LibcameraCamera>("left", options_, clock_, library_);
    camera_->start();
  }
  CameraStatus wait(Duration timeout = 100ms) { return camera_->wait_frame(timeout, frame_); }
  /// Waits until that comes, for `most` at most; how long it took.
  Duration until(CameraStatus status, Duration most = 10s) {
    const RobotTime before = clock_.now();
    while (clock_.now() - before < most && wait() != status) {
    }
    return clock_.now() - before;
  }

  SteppedClock clock_;
  FakeLibrary library_{clock_};
  LibcameraCamera::Options options_;
  std::unique_ptr<LibcameraCamera> camera_;
  CameraFrame frame_;
};

TEST_F(Libcamera, DeliversFramesWithMidExposureTimes) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(frame_.format, PixelFormat::grey);
  EXPECT_EQ(frame_.time, RobotTime{} + 15ms) << "10 ms exposure, 20 ms readout, from 0 on";
  EXPECT_EQ(frame_.uncertainty, 1ms);
  cv::Mat bgr;
  ASSERT_EQ(to_bgr(frame_, bgr), Conversion::ok);
  EXPECT_EQ(bgr.at<cv::Vec3b>(3, 7), cv::Vec3b::all(1));
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(wait(), CameraStatus::ok);
    ASSERT_EQ(frame_.bytes[0], frame_.sequence) << "its own buffer";
  }
  EXPECT_EQ(camera_->counters().frames, 101u);
  EXPECT_EQ(camera_->counters().gaps, 0u);
  library_.exposure.reset();
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(frame_.uncertainty, 11ms) << "an unknown exposure";
}

TEST_F(Libcamera, DamagedFramesAndGapsAreCounted) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  library_.incomplete = true;
  EXPECT_EQ(wait(), CameraStatus::corrupt);
  library_.incomplete = false;
  library_.cut = true;
  EXPECT_EQ(wait(), CameraStatus::corrupt);
  library_.cut = false;
  library_.skip = 3;
  EXPECT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().corrupt, 2u);
  EXPECT_EQ(camera_->counters().gaps, 3u);
}

TEST_F(Libcamera, AfterAPauseTheNewestFrameComes) {
  library_.buffers = 8;
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  clock_.sleep_until(clock_.now() + 130ms);
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(frame_.sequence, 4u);
  EXPECT_EQ(frame_.bytes[0], 4) << "its own buffer";
  EXPECT_EQ(camera_->counters().dropped, 2u);
  clock_.sleep_until(clock_.now() + 2s);
  ASSERT_EQ(wait(), CameraStatus::ok);
  EXPECT_EQ(camera_->counters().dropped, 2u + 7);
  EXPECT_LT(clock_.now() - frame_.time, 2 * kPeriod) << "all that waited was old";
  EXPECT_EQ(camera_->counters().frames, 3u);
}

TEST_F(Libcamera, AStreamThatStallsIsOpenedAnew) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  library_.hangs = true;
  EXPECT_LT(until(CameraStatus::ok), 1300ms);
  EXPECT_EQ(camera_->counters().restarts, 1u);
  EXPECT_EQ(camera_->counters().losses, 0u);
  EXPECT_EQ(library_.opened, 2);
}

TEST_F(Libcamera, AnUnplugThatIsSignalledIsALossAtOnce) {
  options_.settings.controls = {{"gain", 7}};
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  camera_->set_control("gain", 9);
  library_.present = false;
  EXPECT_LT(until(CameraStatus::lost), 50ms);
  EXPECT_EQ(library_.sessions, 0) << "released";
  EXPECT_EQ(until(CameraStatus::ok, 3s), 3s);
  const int before = library_.opened;
  library_.present = true;
  EXPECT_LT(until(CameraStatus::ok), 700ms);
  EXPECT_EQ(library_.opened, before + 1);
  EXPECT_EQ(library_.controls["gain"], 9);
  EXPECT_EQ(camera_->counters().losses, 1u);
}

TEST_F(Libcamera, AnUnplugThatOnlyStallsIsFoundByTheWatchdog) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  library_.signals = false;
  library_.present = false;
  const Duration noticed = until(CameraStatus::lost);
  EXPECT_GE(noticed, 900ms);
  EXPECT_LT(noticed, 1200ms);
  library_.present = true;
  EXPECT_LT(until(CameraStatus::ok), 700ms);
}

TEST_F(Libcamera, OneThatTakesNoBufferBackIsLost) {
  start();
  ASSERT_EQ(wait(), CameraStatus::ok);
  library_.refuses = true;
  EXPECT_EQ(wait(), CameraStatus::lost);
  EXPECT_LT(until(CameraStatus::ok), 700ms);
}

std::string error_of(const std::function<void()>& what) {
  try {
    what();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "(no error)";
}

TEST_F(Libcamera, RefusesSettingsThatMakeNoSense) {
  options_.settings.rate = 0;
  EXPECT_THAT(error_of([&] { start(); }), HasSubstr("rate"));
  options_.settings.rate = 1;
  EXPECT_THAT(error_of([&] { start(); }), HasSubstr("hangs_after"));
}

TEST(RealLibcamera, NamesWhatIsThereWhereACameraIsNot) {
  MonotonicClock clock;
  LibcameraCamera::Options options;
  options.device = "no-such-camera";
  LibcameraCamera camera("left", options, clock);
  const std::string error = error_of([&] { camera.start(); });
  if (!libcam::is_built_in()) {
    EXPECT_THAT(error, AllOf(HasSubstr("built without libcamera"), HasSubstr("install libcamera-dev and rebuild")));
    GTEST_SKIP() << error;
  }
  EXPECT_THAT(error, AllOf(HasSubstr("'left'"), HasSubstr("no-such-camera"), HasSubstr("knows no such camera")));
  const auto there = libcam::library().cameras();
  for (const std::string& listed : there) EXPECT_THAT(error, HasSubstr(listed));
  if (there.empty()) {
    EXPECT_THAT(error, HasSubstr("there is none"));
  }
  EXPECT_EQ(error_of([&] { camera.start(); }), error) << "the manager comes and goes";
}

}  // namespace
}  // namespace foresight::libcamera_camera_test
