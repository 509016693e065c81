// Which left image belongs to which right image.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "common/time.hpp"

namespace foresight {

enum class Side : std::uint8_t { left, right };

struct ColourImage {
  cv::Mat bgr;
  std::uint64_t sequence = 0;
  RobotTime time;  ///< middle of the exposure
  Duration uncertainty{0};
};

struct StereoPair {
  ColourImage left, right;
};

struct PairingOptions {
  /// Largest difference of capture times in a pair. Less than half a frame period, or pairs are ambiguous.
  Duration tolerance = std::chrono::milliseconds(8);
  Duration frozen_after = std::chrono::milliseconds(500);  ///< without a new image
  /// Largest distance of a capture time from its arrival; more is a jump of the camera's clock.
  Duration largest_age = std::chrono::milliseconds(500);
  int trusted_after = 5;  ///< good images in a row, until a clock that jumped is trusted again
};

struct PairingCounters {
  std::uint64_t pairs = 0;
  std::array<std::uint64_t, 2> unpaired{};  ///< index: Side. Images whose partner never came
  std::array<std::uint64_t, 2> jumps{};     ///< images thrown away for their capture time
};

/// Pure logic: takes `now` as an argument. One thread. Does not allocate.
///
///   left     |    |    |    |         an image pairs with the nearest one of the other side within the
///   right     |    |         |        tolerance; what is older than a pair on its side stays unpaired
class StereoPairing {
 public:
  explicit StereoPairing(const PairingOptions& options = {}) : options_(options) {}

  /// `image` arrived at `now`. The pair that it completes, if any; pairs come in order of time.
  std::optional<StereoPair> add(Side side, ColourImage image, RobotTime now) noexcept;
  /// Why no (good) pairs come: a frozen camera, or capture times that jump; static text, "" where all is well.
  const char* reason(RobotTime now) const noexcept;
  const PairingCounters& counters() const noexcept { return counters_; }

 private:
  static constexpr std::size_t kWaiting = 4;  ///< images per side; more without a partner are given up
  struct Stream {
    std::array<ColourImage, kWaiting> waiting;  // oldest first
    std::size_t count = 0;
    std::optional<RobotTime> arrived;
    RobotTime captured{INT64_MIN};
    int distrust = 0;  // good images still needed
  };

  bool trusted(Stream& stream, std::size_t index, const ColourImage& image, RobotTime now) noexcept;
  void drop_oldest(std::size_t index, std::size_t n, bool unpaired) noexcept;

  PairingOptions options_;
  std::array<Stream, 2> streams_;
  PairingCounters counters_;
  std::optional<RobotTime> started_;
};

}  // namespace foresight
