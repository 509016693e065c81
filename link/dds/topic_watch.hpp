// Whether anything still comes on a topic, in words for who looks at it.
#pragma once

#include <cstddef>
#include <string>

#include "common/time.hpp"

namespace foresight::link {

/// One thread. `now` never goes back.
class TopicWatch {
 public:
  /// `topic`: as the words name it.
  TopicWatch(std::string topic, RobotTime now) : topic_(std::move(topic)), last_sample_(now) {}

  /// To be asked at least as often as the words should come: `writers` are there, `came` samples since the last call.
  /// What is new, once: that the last writer has gone, that one is there again, that those who are there have been
  /// silent for kSilent; mostly "".
  std::string news(std::size_t writers, std::size_t came, RobotTime now);

  /// A writer that was killed is missed only a second later (Cyclone's lease, link/dds/settings).
  static constexpr Duration kSilent = std::chrono::seconds(5);

 private:
  std::string topic_;
  RobotTime last_sample_;
  bool had_writers_ = false, gone_ = false, silent_ = false;
};

}  // namespace foresight::link
