#include "link/dds/pretended_line.hpp"

#include "common/real_time.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kDatagram = 1344;  // of a sample, as settings.cpp has it for a LAN
constexpr std::size_t kHeaders = 100;    // of RTPS, UDP and IP
constexpr Duration kAsked = 2ms;         // NackDelay
constexpr int kTries = 8;
constexpr Duration kLook = 100ms;

}  // namespace

PretendedLine::PretendedLine(const LineSpec& spec, Side side, const Clock& clock)
    : clock_(clock),
      again_(spec.up.delay + spec.down.delay + kAsked),
      out_(side == Side::robot ? spec.up : spec.down, clock.now(), spec.seed + (side == Side::robot ? 0 : 1)),
      in_(side == Side::robot ? spec.down : spec.up, clock.now(), spec.seed + (side == Side::robot ? 1 : 0)) {}

PretendedLine::~PretendedLine() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::optional<RobotTime> PretendedLine::cross(DelayLine& way, std::size_t bytes, bool repaired) {
  const RobotTime now = clock_.now();
  std::optional<RobotTime> there;
  for (std::size_t at = 0; at == 0 || at < bytes; at += kDatagram) {
    std::optional<RobotTime> arrival;
    Duration late{0};
    for (int i = 0; i < (repaired ? kTries : 1) && !arrival; ++i, late += again_)
      if (arrival = way.send(now, std::min(kDatagram, bytes - at) + kHeaders); arrival) arrival = *arrival + late;
    if (!arrival) {
      ++counts_.lost;
      return std::nullopt;
    }
    there = there ? std::max(*there, *arrival) : *arrival;
  }
  ++counts_.crossed;
  return there;
}

void PretendedLine::send(std::size_t bytes, bool repaired, std::function<void()> deliver) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_bytes_ + bytes > kMostWaiting) {
      ++counts_.lost;
      ++counts_.dropped;
      return;
    }
    const auto there = cross(out_, bytes, repaired);
    if (!there) return;
    waiting_.emplace(*there, Waiting{bytes, std::move(deliver)});
    waiting_bytes_ += bytes;
  }
  earlier_.notify_one();
}

std::optional<RobotTime> PretendedLine::receive(std::size_t bytes, bool repaired) {
  const std::lock_guard lock(mutex_);
  return cross(in_, bytes, repaired);
}

void PretendedLine::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    make_real_time(priority::kLine);  // where allowed: a real line does not wait for this machine
    run(stop);
  });
}

void PretendedLine::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    step();
    std::unique_lock lock(mutex_);
    const std::optional<RobotTime> first = waiting_.empty() ? std::nullopt : std::optional(waiting_.begin()->first);
    const Duration wait = first ? std::min<Duration>(kLook, *first - clock_.now()) : kLook;
    if (wait.count() > 0)
      earlier_.wait_for(lock, stop, wait,
                        [&] { return !waiting_.empty() && (!first || waiting_.begin()->first < *first); });
  }
}

void PretendedLine::step() {
  for (;;) {
    std::function<void()> deliver;  // called without the lock
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.empty() || waiting_.begin()->first > clock_.now()) return;
      deliver = std::move(waiting_.begin()->second.deliver);
      waiting_bytes_ -= waiting_.begin()->second.bytes;
      waiting_.erase(waiting_.begin());
    }
    deliver();
  }
}

PretendedLine::Counts PretendedLine::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace foresight::link
