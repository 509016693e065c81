// Two joints of a head over time: where they were, how quickly they moved, and from which side they came.
#pragma once

#include <optional>

#include "calibration/robot/pan_tilt.hpp"
#include "calibration/robot/pose_stream.hpp"

namespace foresight {

class HeadEncoders {
 public:
  struct Options {
    double largest_gap_s = 0.1;  ///< a larger one between two samples is not interpolated
    double turn_rad = 0.002;     ///< a joint turned round once it went back by so much; beyond the encoders' noise
    double settled_rad = 0.02;   ///< and has come from that side once it went on so far; beyond the backlash
  };
  struct Answer {
    PanTiltAngles angles;
    std::array<double, 2> rate{0, 0};  ///< rad/s
  };

  /// Rows of pan and tilt, ascending in time.
  HeadEncoders(const std::vector<JointRow>& rows, const Options& options);

  /// Interpolated linearly; nothing outside of the samples or in a gap.
  std::optional<Answer> at(RobotTime time) const;

 private:
  struct Sample {
    RobotTime time;
    PanTiltAngles angles;
  };
  Options options_;
  std::vector<Sample> samples_;
};

}  // namespace foresight
