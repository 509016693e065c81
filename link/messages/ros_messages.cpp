#include "link/messages/ros_messages.hpp"

#include <algorithm>

namespace foresight::link {

RosTime ros_time(std::int64_t unix_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t sec = unix_ns / kSecond - (unix_ns % kSecond < 0 ? 1 : 0);
  return {static_cast<std::int32_t>(std::clamp<std::int64_t>(sec, INT32_MIN, INT32_MAX)),
          static_cast<std::uint32_t>(unix_ns - sec * kSecond)};
}

std::int64_t unix_ns(const RosTime& time) {
  return std::int64_t{time.sec} * 1'000'000'000 + time.nanosec;
}

}  // namespace foresight::link
