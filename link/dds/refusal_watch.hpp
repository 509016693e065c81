// What a program has refused, in words for its log.
#pragma once

#include <fmt/core.h>

#include "common/time.hpp"
#include "link/dds/participant.hpp"

namespace foresight::link {

/// One thread. `now` never goes back.
class RefusalWatch {
 public:
  static constexpr Duration kEvery = std::chrono::seconds(10);  ///< words come, at most

  /// What was refused since it told the last time; mostly "".
  std::string news(const Participant& program, RobotTime now) {
    const std::uint64_t refused = program.refused();
    if (refused == told_ || (told_at_ && now - *told_at_ < kEvery)) return "";
    const auto more = static_cast<unsigned long long>(refused - told_);
    told_ = refused;
    told_at_ = now;
    return fmt::format("{} message{} refused, the last on {}", more, more == 1 ? "" : "s", program.refusal());
  }

 private:
  std::uint64_t told_ = 0;
  std::optional<RobotTime> told_at_;
};

}  // namespace foresight::link
