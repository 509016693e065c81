// A run's images, as if they came over a line.
#pragma once

#include "apps/bench/head_lab.hpp"

namespace foresight {

/// Gives them to the texture thread at 5 Hz, again and again.
class ImageFeed {
 public:
  explicit ImageFeed(HeadLab& lab) : lab_(lab) {}
  void feed(RobotTime now) {
    while (lab_.session().take_report()) ++extracted_;
    if (next_ && now < *next_) return;
    next_ = now + std::chrono::milliseconds(200);
    lab_.session().submit(lab_.frames()[sent_++ % lab_.frames().size()]);
  }
  std::uint64_t extracted() const { return extracted_; }

 private:
  HeadLab& lab_;
  std::optional<RobotTime> next_;
  std::size_t sent_ = 0;
  std::uint64_t extracted_ = 0;
};

}  // namespace foresight
