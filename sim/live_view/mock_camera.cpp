#include "sim/live_view/mock_camera.hpp"

#include <fmt/core.h>
#include <malloc.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "sim/live_view/stereo_renderer.hpp"
#include "sim/motion.hpp"

namespace foresight::sim {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPoll = 1ms;       // for finished images
constexpr Duration kStopTime = 50ms;  // so long the renderer takes to stop in stepped time
constexpr Duration kLatest = 400ms;   // no camera takes that long; who reads it would doubt its clock
constexpr Duration kDrawTime = 60s;   // of one pair, on the slowest machine; more is a driver that hangs
constexpr Duration kExposureUnit = 100us;
constexpr int kQuicker = 4, kLightRest = 2;
constexpr double kSameLight = 1e-5;  // parts that went less are where they were
constexpr const char* kControl = "exposure_time_absolute";

void check(const MockCameraOptions& o) {
  if (!(o.rate > 0 && o.rate <= 1000))
    throw InputError("mock camera: rate", fmt::format("{:.9g} is outside 0 .. 1000", o.rate), "choose a value inside");
  for (const Lens* lens : {&o.lenses.left, &o.lenses.right})
    if (lens->width() <= 0 || lens->width() % 2)
      throw InputError("mock camera: lens", fmt::format("an image {} px wide cannot be YUYV", lens->width()),
                       "take an even width");
}

}  // namespace

MockStereo::MockStereo(std::shared_ptr<const LiveLab> world, ShaftsAt shafts, const MockCameraOptions& options,
                       Clock& clock)
    : world_(std::move(world)),
      shafts_(std::move(shafts)),
      options_(options),
      clock_(clock),
      epoch_(clock.now()),
      stepped_(dynamic_cast<SteppedClock*>(&clock) != nullptr) {
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

// What compiles a software renderer's shaders leaves gaps of 20 MB in the heap, elsewhere each time: cameras that are
// opened again and again would fill the memory with them.
void MockStereo::open(Side side) {
  const std::lock_guard lock(mutex_);
  if (!open_[0] && !open_[1]) {
    opened_ = clock_.now();
    in_hand_ = {};
  }
  open_[static_cast<std::size_t>(side)] = true;
  if (thread_.joinable()) return;
  std::promise<void> ready;
  std::future<void> opened = ready.get_future();
  thread_ = std::jthread([this, &ready](const std::stop_token& stop) { render(stop, ready); });
  try {
    opened.get();  // the thread leaves `ready` alone from here on
    ::malloc_trim(0);
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
    lit_.clear();
    light_due_ = clock_.now();
    StereoRenderer renderer(*world_, *light_, irradiance_, options_.lenses, options_.sensor);
    ready.set_value();
    stepped_ ? run_stepped(stop, renderer) : run_real(stop, renderer);
  } catch (...) {
    try {
      ready.set_exception(std::current_exception());
    } catch (const std::future_error&) {  // it ran already: its cameras time out
    }
  }
}

void MockStereo::light_anew(StereoRenderer& renderer, const LabState& state) {
  const auto alike = [](const Pose& a, const Pose& b) { return a.isApprox(b, kSameLight); };
  if (lit_.size() == state.size() && std::ranges::equal(lit_, state, alike)) return;
  const RobotTime begin = clock_.now();
  if (begin < light_due_) return;
  renderer.light_anew(*light_, light_->lit(state, kQuicker));
  lit_ = state;
  light_due_ = clock_.now() + kLightRest * (clock_.now() - begin);  // stepped time stands still meanwhile
}

bool MockStereo::draw(StereoRenderer& renderer, RobotTime end_of_exposure, std::uint64_t number) {
  const std::int64_t exposure = exposure_;
  const RobotTime middle = end_of_exposure - exposure * kExposureUnit / 2;
  const ShaftPositions shafts = [&](std::string_view joint) { return shafts_(joint, middle); };
  const double t = to_seconds(middle - epoch_);
  const LabState state = options_.state ? options_.state(middle) : world_->true_state(shafts, t);
  if (options_.moving_light) light_anew(renderer, state);
  return renderer.draw(world_->T_world_left(shafts), state, world_->true_prints(state, t),
                       static_cast<double>(exposure) / kExposure, {middle, number});
}

void MockStereo::hand_over(StereoRenderer& renderer, bool wait) {
  const double before = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
  if (auto pair = renderer.take(wait)) {
    if (stepped_ || clock_.now() - pair->front().time < kLatest)
      for (std::size_t i = 0; i < 2; ++i) newest_[i].put(std::move((*pair)[i]));
    else
      ++skipped_;
  }
  copying_cpu_s_ = copying_cpu_s_ + cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - before;
}

void MockStereo::run_real(const std::stop_token& stop, StereoRenderer& renderer) {
  std::uint64_t number = 0;
  // As a real camera, it keeps its beat: an image that could not be drawn in time never was, and none is late.
  for (RobotTime due = clock_.now() + period(); !stop.stop_requested(); ++number) {
    while (clock_.now() < due && !stop.stop_requested()) {
      hand_over(renderer, false);
      clock_.sleep_until(renderer.under_way() == 0 ? due : std::min(due, clock_.now() + kPoll));
    }
    hand_over(renderer, false);
    if (renderer.under_way() < StereoRenderer::kUnderWay)
      draw(renderer, due, number);
    else
      ++skipped_;
    due = due + period() * std::max<std::int64_t>(1, (clock_.now() - due + period()) / period());
  }
}

void MockStereo::run_stepped(const std::stop_token& stop, StereoRenderer& renderer) {
  while (!stop.stop_requested()) {
    const auto number = asked_.take(kStopTime);
    if (!number) continue;
    draw(renderer, opened_ + static_cast<std::int64_t>(*number) * period(), *number);
    hand_over(renderer, true);
  }
}

CameraStatus MockStereo::wait_stepped(Side side, std::uint64_t last, Duration timeout, CameraFrame& out) noexcept {
  const RobotTime next = opened_ + static_cast<std::int64_t>(last + 1) * period(), limit = clock_.now() + timeout;
  clock_.sleep_until(std::min(std::max(next, clock_.now()), limit));
  if (clock_.now() < next) return CameraStatus::timeout;
  const auto index = static_cast<std::size_t>(side);
  const auto number = static_cast<std::uint64_t>((clock_.now() - opened_) / period());
  if (in_hand_[index] != number) {
    for (auto& slot : newest_) slot.take();
    asked_.put(number);
    in_hand_ = {number, number};
  }
  auto frame = newest_[index].take(kDrawTime);  // of the machine: the clock stands still
  if (!frame) return CameraStatus::lost;
  out = std::move(*frame);
  return CameraStatus::ok;
}

CameraStatus MockStereo::wait_frame(Side side, std::uint64_t last, Duration timeout, CameraFrame& out) noexcept {
  if (stepped_) return wait_stepped(side, last, timeout, out);
  auto frame = newest_[static_cast<std::size_t>(side)].take(timeout);
  if (!frame) return CameraStatus::timeout;
  out = std::move(*frame);
  return CameraStatus::ok;
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
  const CameraStatus status = stereo_->wait_frame(side_, last_.value_or(0), timeout, out);
  if (status != CameraStatus::ok) return status;
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
    throw InputError("camera '" + name_ + "'", "has no control " + in_quotes(control),
                     did_you_mean(control, std::vector<std::string>{kControl}));
  if (value < 1 || value > MockStereo::kLongestExposure)
    throw InputError("camera '" + name_ + "': " + kControl,
                     fmt::format("{} is outside 1 .. {}", static_cast<long long>(value),
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
