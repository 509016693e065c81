#include "link/dds/topic_watch.hpp"

#include <fmt/core.h>

namespace foresight::link {

std::string TopicWatch::news(std::size_t writers, std::size_t came, RobotTime now) {
  if (came > 0) {
    last_sample_ = now;
    silent_ = false;
  }
  if (writers == 0) {
    if (!had_writers_ || gone_) return "";
    gone_ = true;
    return "nobody writes " + topic_ +
           " any more: its program has ended, or the line to it is down; waiting for it to come back (Ctrl-C ends)";
  }
  had_writers_ = true;
  if (gone_) {
    gone_ = silent_ = false;
    last_sample_ = now;
    return topic_ + " is written again";
  }
  if (silent_ || now - last_sample_ < kSilent) return "";
  silent_ = true;
  return fmt::format("{} is written by a program that is there, but nothing has come for {:.0f} s; waiting", topic_,
                     to_seconds(now - last_sample_));
}

}  // namespace foresight::link
