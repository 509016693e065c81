#include "calibration/robot/head_encoders.hpp"

#include <algorithm>

namespace foresight {
namespace {

/// The way of one joint, sample by sample.
struct Way {
  int sign = 0;         // of the motion since the last turn
  double turned = 0;    // where it turned round
  double farthest = 0;  // since then

  int came(double q, bool first, const HeadEncoders::Options& options) {
    if (first) turned = farthest = q;
    if (sign == 0 && std::abs(q - turned) > options.turn_rad) sign = q > turned ? 1 : -1, farthest = q;
    if (sign * (q - farthest) > 0) farthest = q;
    if (sign != 0 && sign * (farthest - q) > options.turn_rad) turned = farthest, farthest = q, sign = -sign;
    return std::abs(farthest - turned) >= options.settled_rad ? sign : 0;
  }
};

}  // namespace

HeadEncoders::HeadEncoders(const std::vector<JointRow>& rows, const Options& options) : options_(options) {
  Way pan, tilt;
  for (const JointRow& row : rows) {
    const bool first = samples_.empty();
    const double p = row.positions[0], t = row.positions[1];
    samples_.push_back({row.time, {p, t, {pan.came(p, first, options), tilt.came(t, first, options)}}});
  }
}

std::optional<HeadEncoders::Answer> HeadEncoders::at(RobotTime time) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                      [](const Sample& sample, RobotTime t) { return sample.time < t; });
  if (after == samples_.end() || after == samples_.begin()) return std::nullopt;
  const Sample &a = *std::prev(after), &b = *after;
  const double gap = to_seconds(b.time - a.time), share = to_seconds(time - a.time) / gap;
  if (gap > options_.largest_gap_s) return std::nullopt;
  Answer out;
  const double pan = b.angles.pan - a.angles.pan, tilt = b.angles.tilt - a.angles.tilt;
  out.rate = {pan / gap, tilt / gap};
  out.angles = {a.angles.pan + share * pan, a.angles.tilt + share * tilt, b.angles.came};
  for (std::size_t joint = 0; joint < 2; ++joint)
    if (a.angles.came[joint] != b.angles.came[joint]) out.angles.came[joint] = 0;
  return out;
}

}  // namespace foresight
