// What a user is told of the lamp.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"
#include "texture_gpu/lamp/lamp_search.hpp"

namespace foresight {

/// What was known of the lamp over a run. One thread.
class LampHistory {
 public:
  /// Of each image, in order: what was known with it.
  void add(const LampAnswer& answer, RobotTime image);

  /// Where the lamp is, or why its shadows are not foretold, and for which images they were though nobody knows it now;
  /// empty where nothing has told of any.
  std::string in_words() const;

 private:
  struct Stretch {
    RobotTime first, last;  // images
    int images = 0;         // with a lamp
  };

  LampAnswer answer_;
  std::optional<Stretch> known_;   // up to now; none: it is not known
  std::optional<Stretch> before_;  // all that ended, from the first to the last
};

}  // namespace foresight
