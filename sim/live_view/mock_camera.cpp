#include "sim/live_view/mock_camera.hpp"

#include <pthread.h>

#include <cmath>
#include <deque>
#include <numbers>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "gl/context.hpp"
#include "sim/live_view/live_view.hpp"
#include "sim/motion.hpp"
#include "sim/run_files.hpp"

namespace foresight::sim {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPoll = 1ms;       // for finished images
constexpr std::size_t kUnderWay = 2;  // pairs: one is drawn while the other is fetched; more would only be older
constexpr const char* kControl = "exposure_time_absolute";

void check(const MockCameraOptions& o) {
  if (!(o.rate > 0 && o.rate <= 1000))
    throw InputError("mock camera: rate", format("%.9g is outside 0 .. 1000", o.rate), "choose a value inside");
  for (const Lens* lens : {&o.left, &o.right})
    if (lens->width() <= 0 || lens->width() % 2)
      throw InputError("mock camera: lens", format("an image %d px wide cannot be YUYV", lens->width()),
                       "take an even width");
}

}  // namespace

struct MockStereo::Shown {
  RobotTime time;
  Duration uncertainty;
  std::uint64_t number;
};

MockStereo::MockStereo(std::shared_ptr<const LiveLab> world, ShaftsAt shafts, const MockCameraOptions& options,
                       Clock& clock)
    : world_(std::move(world)), shafts_(std::move(shafts)), options_(options), clock_(clock), epoch_(clock.now()) {
  check(options_);
  light_ = std::make_unique<LightMap>(world_->lab(), options_.light_coarser);
  irradiance_ = light_->lit(world_->true_state(shafts_at_rest, 0));
}

MockStereo::~MockStereo() = default;

void MockStereo::set_rate(double rate) {
  options_.rate = rate;
  check(options_);
}

double MockStereo::consumers_cpu_s() const {
  double sum = 0;
  for (const auto& consumer : consumers_)
    if (const clockid_t clock = consumer; clock != 0) sum += cpu_seconds(clock);
  return sum;
}

void MockStereo::open(Side side) {
  const std::lock_guard lock(mutex_);
  open_[static_cast<std::size_t>(side)] = true;
  if (thread_.joinable()) return;
  std::promise<void> ready;
  std::future<void> opened = ready.get_future();
  thread_ = std::jthread([this, &ready](const std::stop_token& stop) { render(stop, ready); });
  try {
    opened.get();  // the thread leaves `ready` alone from here on
  } catch (...) {
    thread_.join();
    thread_ = {};
    open_[static_cast<std::size_t>(side)] = false;
    throw;
  }
}

void MockStereo::close(Side side) noexcept {
  const std::lock_guard lock(mutex_);
  open_[static_cast<std::size_t>(side)] = false;
  consumers_[static_cast<std::size_t>(side)] = 0;
  newest_[static_cast<std::size_t>(side)].take();
  if (open_[0] || open_[1] || !thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  thread_ = {};
}

void MockStereo::render(const std::stop_token& stop, std::promise<void>& ready) noexcept {
  try {
    loop(stop, ready);
  } catch (...) {
    try {
      ready.set_exception(std::current_exception());
    } catch (const std::future_error&) {  // it ran already: its cameras time out
    }
  }
}

void MockStereo::loop(const std::stop_token& stop, std::promise<void>& ready) {
  const auto context = gl::create_headless_context();
  gl::set_up_context();
  const auto buffers = std::make_shared<const LabBuffers>(world_->lab(), *light_, irradiance_);
  std::array<LiveView, 2> views{LiveView(buffers, options_.left, options_.sensor),
                                LiveView(buffers, options_.right, [&] {
                                  Sensor other = options_.sensor;
                                  other.seed += 7919;
                                  return other;
                                }())};
  for (LiveView& view : views) {  // the driver compiles with the first image, which would come too late to be trusted
    view.draw(T_world_head_left(kHeadAtTable), world_->lab().at_rest(), 1, 0);
    std::vector<std::uint8_t> unseen(std::size_t{2} * view.lens().width() * view.lens().height());
    view.take(unseen, true);
  }
  ready.set_value();

  std::deque<Shown> under_way;
  std::array<std::optional<CameraFrame>, 2> finished;
  const auto hand_over = [&] {
    const double before = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    for (std::size_t i = 0; i < 2 && !under_way.empty(); ++i) {
      if (finished[i] || views[i].under_way() == 0 || !views[i].ready()) continue;
      const Lens& lens = views[i].lens();
      CameraFrame& frame = finished[i].emplace();
      frame.pixels.create(lens.height(), lens.width(), CV_8UC2);
      frame.bytes = {frame.pixels.data, frame.pixels.total() * 2};
      views[i].take({frame.pixels.data, frame.bytes.size()}, true);
      frame.format = PixelFormat::yuyv;
      frame.width = lens.width();
      frame.height = lens.height();
      frame.stride = std::size_t{2} * lens.width();
      frame.sequence = under_way.front().number;
      frame.time = under_way.front().time;
      frame.uncertainty = under_way.front().uncertainty;
    }
    if (finished[0] && finished[1]) {
      for (std::size_t i = 0; i < 2; ++i) newest_[i].put(std::move(*finished[i]));
      finished = {};
      under_way.pop_front();
    }
    copying_cpu_s_ = copying_cpu_s_ + cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - before;
  };

  const Duration period = seconds(1 / options_.rate);
  std::uint64_t number = 0;
  for (RobotTime due = clock_.now() + period; !stop.stop_requested();) {
    while (clock_.now() < due && !stop.stop_requested()) {
      if (!under_way.empty()) hand_over();
      clock_.sleep_until(under_way.empty() ? due : std::min(due, clock_.now() + kPoll));
    }
    if (!under_way.empty()) hand_over();
    const RobotTime now = clock_.now();
    const ShaftPositions shafts = [&](std::string_view joint) { return shafts_(joint, now); };
    const LabState state = world_->true_state(shafts, to_seconds(now - epoch_));
    const Pose T_world_left = world_->T_world_left(shafts);
    const Duration uncertainty = clock_.now() - now;
    if (under_way.size() < kUnderWay) {
      const double gain = static_cast<double>(exposure_) / kExposure;
      views[0].draw(T_world_left, state, gain, number);
      views[1].draw(T_world_left * options_.T_left_right, state, gain, number);
      under_way.push_back({now, uncertainty, number});
    } else {
      ++skipped_;
    }
    ++number;
    due = std::max(due + period, clock_.now());
  }
}

MockCamera::MockCamera(std::string name, Side side, std::shared_ptr<MockStereo> stereo)
    : name_(std::move(name)), side_(side), stereo_(std::move(stereo)) {}

void MockCamera::start() {
  if (started_) return;
  settings_.width = stereo_->lens(side_).width();
  settings_.height = stereo_->lens(side_).height();
  settings_.rate = stereo_->rate();
  settings_.format = PixelFormat::yuyv;
  settings_.readout = Duration{0};
  counters_ = {};
  last_.reset();
  stereo_->open(side_);
  started_ = true;
}

void MockCamera::stop() noexcept {
  if (started_) stereo_->close(side_);
  started_ = false;
}

CameraStatus MockCamera::wait_frame(Duration timeout, CameraFrame& out) noexcept {
  const auto index = static_cast<std::size_t>(side_);
  if (!started_) return CameraStatus::lost;
  if (stereo_->consumers_[index] == 0) {
    clockid_t clock = 0;
    if (pthread_getcpuclockid(pthread_self(), &clock) == 0) stereo_->consumers_[index] = clock;
  }
  auto frame = stereo_->newest_[index].take(timeout);
  if (!frame) return CameraStatus::timeout;
  out = std::move(*frame);
  if (last_ && out.sequence > *last_ + 1) counters_.gaps += out.sequence - *last_ - 1;
  last_ = out.sequence;
  ++counters_.frames;
  return CameraStatus::ok;
}

std::vector<CameraControl> MockCamera::controls() {
  return {{kControl, 1, MockStereo::kLongestExposure, 1, stereo_->exposure_}};
}

void MockCamera::set_control(const std::string& control, std::int64_t value) {
  if (control != kControl)
    throw InputError("camera '" + name_ + "'", "has no control '" + control + "'",
                     std::string("did you mean '") + kControl + "'?");
  if (value < 1 || value > MockStereo::kLongestExposure)
    throw InputError("camera '" + name_ + "': " + kControl,
                     format("%lld is outside 1 .. %lld", static_cast<long long>(value),
                            static_cast<long long>(MockStereo::kLongestExposure)),
                     "choose a value inside");
  stereo_->exposure_ = value;
}

std::optional<double> shafts_in_motion(std::string_view joint, double t) {
  constexpr double kTurn = 2 * std::numbers::pi;
  if (joint == "pan") return kHeadAtTable.pan + 0.25 * std::sin(kTurn * t / 7);
  if (joint == "tilt") return kHeadAtTable.tilt + 0.08 * std::sin(kTurn * t / 5);
  const ArmPosition arm = arm_position_at(t);
  for (std::size_t j = 0; j < arm.joints.size(); ++j)
    if (joint == arm_joints()[j].name) return arm.joints[j];
  if (joint == arm_joints()[arm.joints.size()].name) return arm.opening;
  return std::nullopt;
}

}  // namespace foresight::sim
