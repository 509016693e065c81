// How long a pass takes, without waiting for it where there is a GPU.
#pragma once

#include <chrono>
#include <optional>
#include <utility>

#include "gl/objects.hpp"

namespace foresight::gl {

/// Belongs to one context. begin(), the pass, end(); some frames later its time is there.
class PassTimer {
 public:
  /// `is_software`: DriverInfo's. There the time is that of a clock until the pass has finished, which end() waits for:
  /// what comes next would wait for it anyway, and timer queries do not count draws there.
  explicit PassTimer(bool is_software);

  /// False: the pass before is not known yet, and this one is not measured.
  bool begin();
  void end();
  /// ms of the pass that was measured last, once.
  std::optional<double> take();

 private:
  bool is_software_;
  Query first_, last_;
  bool running_ = false, waiting_ = false;
  std::chrono::steady_clock::time_point began_;
  std::optional<double> ms_;
};

}  // namespace foresight::gl
