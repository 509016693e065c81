#include "session/camera_watch.hpp"

#include <fmt/core.h>

#include "session/stop_latency.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTryEvery = 5s;
constexpr Duration kNoPairs = 500ms;  // both cameras deliver, and nothing pairs
constexpr const char* kStarting = "starting";

}  // namespace

CameraWatch::CameraWatch(Open open, Clock& clock, Take take)
    : open_(std::move(open)), clock_(clock), take_(std::move(take)) {
  line_.fault = kStarting;
}

void CameraWatch::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void CameraWatch::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  cameras_.reset();
}

void CameraWatch::run(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    if (!cameras_) try_to_open(false);
    if (cameras_) {
      take_in(cameras_->take(kStopLatency));
      continue;
    }
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, stop, kTryEvery, [] { return false; });
  }
}

void CameraWatch::step() noexcept {
  if (!cameras_ && clock_.now() >= next_try_) try_to_open(true);
  if (!cameras_) return;
  cameras_->poll();
  take_in(cameras_->take(Duration{0}));
}

void CameraWatch::try_to_open(bool polled) noexcept {
  next_try_ = clock_.now() + kTryEvery;
  std::string error;
  try {
    auto cameras = open_();
    polled ? cameras->start_polled() : cameras->start();
    cameras_ = std::move(cameras);
  } catch (const std::exception& failure) {
    error = failure.what();
  }
  const std::lock_guard lock(mutex_);
  if (cameras_) opened_ = clock_.now();
  if (!error.empty()) set_fault("not started: " + error, clock_.now());
}

void CameraWatch::take_in(const std::optional<StereoPair>& pair) noexcept {
  if (pair && take_) take_(*pair);
  const StereoStatus status = cameras_->status();
  const RobotTime now = clock_.now();
  const std::lock_guard lock(mutex_);
  if (pair) {
    newest_ = pair->left.time;
    last_arrival_ = now;
    arrivals_.push_back(now);
  }
  while (!arrivals_.empty() && now - arrivals_.front() > 1s) arrivals_.pop_front();
  for (std::size_t i = 0; i < 2; ++i) {
    const bool lost = status.cameras[i] == CameraStatus::lost;
    if (lost && !was_lost_[i]) ++line_.losses[i];
    was_lost_[i] = lost;
  }
  line_.status = status;
  set_fault(fault_of(status, now), now);
}

std::string CameraWatch::fault_of(const StereoStatus& status, RobotTime now) {
  if (!last_arrival_ && now - *opened_ < kNoPairs) return kStarting;
  if (std::string fault = fault_text(status); !fault.empty()) {
    last_cause_ = now;
    return fault;
  }
  if (now - std::max({last_arrival_.value_or(*opened_), last_cause_, *opened_}) > kNoPairs)
    return "no pairs: the capture times of left and right differ by more than the tolerance";
  return last_cause_ > last_arrival_.value_or(*opened_) ? line_.fault : "";  // until the first pair after it
}

void CameraWatch::set_fault(std::string fault, RobotTime now) {
  if (fault == line_.fault) return;
  // What began it is the cause; a camera that was unplugged is "frozen", too, until its first image.
  const bool goes_on = !line_.fault.empty() && line_.fault != kStarting;
  if (!goes_on && !fault.empty() && fault != kStarting) cause_ = fault;
  if (goes_on && fault.empty()) last_ended_ = now;
  line_.fault = std::move(fault);
}

CameraLine CameraWatch::line() const {
  const RobotTime now = clock_.now();
  const std::lock_guard lock(mutex_);
  CameraLine out = line_;
  const auto first = std::ranges::find_if(arrivals_, [&](RobotTime t) { return now - t <= 1s; });
  if (const auto n = arrivals_.end() - first; n > 1)
    out.pairs_per_s = static_cast<double>(n - 1) / to_seconds(now - *first);
  if (newest_) out.age = now - *newest_;
  if (last_ended_ && line_.fault.empty()) {
    out.last_fault = fmt::format("{}, until {:.0f} s ago", cause_, to_seconds(now - *last_ended_));
  }
  return out;
}

std::string camera_text(const CameraLine& line) {
  const StereoStatus& s = line.status;
  std::string out = fmt::format("  cameras: {:.0f} pairs/s, newest {} old", line.pairs_per_s,
                                line.age ? std::to_string(*line.age / 1ms) + " ms" : "-");
  out += line.fault.empty() ? (line.last_fault.empty() ? "" : "; before: " + line.last_fault) : ": " + line.fault;
  return out +
         fmt::format(
             "\n    {} pairs, {} dropped; left, right: {}, {} unpaired, {}, {} damaged, {}, {} with a wrong time, "
             "lost {}, {} times\n",
             s.pairing.pairs, s.dropped, s.pairing.unpaired[0], s.pairing.unpaired[1], s.corrupt[0], s.corrupt[1],
             s.pairing.jumps[0], s.pairing.jumps[1], line.losses[0], line.losses[1]);
}

}  // namespace foresight
