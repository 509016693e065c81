#include "common/clock.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace foresight {

RobotTime MonotonicClock::now() const noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return {std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec};
}

void MonotonicClock::sleep_until(RobotTime time) noexcept {
  const timespec t{static_cast<time_t>(time.ns / 1'000'000'000), static_cast<long>(time.ns % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

void SteppedClock::every(Duration period, std::function<void(RobotTime)> task) {
  tasks_.push_back({now_ + period, period, std::move(task)});
}

void SteppedClock::sleep_until(RobotTime time) noexcept {
  while (now_ < time) step_towards(time);
}

void SteppedClock::step_towards(RobotTime limit) noexcept {
  if (limit <= now_) return;
  const auto due =
      std::min_element(tasks_.begin(), tasks_.end(), [](const Task& a, const Task& b) { return a.next < b.next; });
  if (due == tasks_.end() || due->next > limit) {
    now_ = limit;
    return;
  }
  now_ = due->next;
  due->next = due->next + due->period;
  due->run(now_);
}

}  // namespace foresight
