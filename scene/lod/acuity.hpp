// How sharply an eye sees a thing, by where it is and how it moves.
//
//   k1 = exp(-(theta - b1) / c1)      theta: from straight ahead. Eyes turn by up to 15 degrees before the head does:
//                                     so far everything counts as looked at, without a device that tracks eyes
//   k2 = exp(-(omega - b2) / c2)      omega: how fast it moves across the view
//   k3 = exp(-(|phi0 - phi| - b3) / c3)   phi: the angle between both eyes' lines of sight to it, phi0: to what is
//   looked at
//
// each at most 1; the whole is the least of them, as one way of blurring hides the others. What the eye resolves there
// is 1 / k times as coarse. (Ohshima, Yamamoto, Tamura, "Gaze-directed adaptive rendering", VRAIS 1996.)
#pragma once

#include <optional>

namespace foresight {

/// Radians, rad/s. Why these: acuity falls as 1 / (1 + e / 2.3 degrees) beyond the fovea, which exp(-e / 11.4 degrees)
/// meets at 30 degrees; eyes follow what moves at up to 30 degrees/s, faster than that acuity is down to a third
/// within 23 degrees/s; a pupil of 4 mm blurs by the 4 arc minutes that nobody notices at 0.3 dioptres, 1.1 degrees
/// of vergence, and three times that 2.6 degrees farther.
struct AcuityOptions {
  double eccentricity_from = 0.262, eccentricity_scale = 0.199;  ///< b1, c1: 15, 11.4 degrees
  double speed_from = 0.524, speed_scale = 0.401;                ///< b2, c2: 30, 23 degrees/s
  double vergence_from = 0.0192, vergence_scale = 0.0384;        ///< b3, c3: 1.1, 2.2 degrees
  double eyes_apart = 0.065;                                     ///< m
};

struct SeenMotion {
  double eccentricity = 0;                ///< rad
  double speed = 0;                       ///< rad/s
  double distance = 1;                    ///< m
  std::optional<double> gaze_distance{};  ///< m, to what is looked at; nothing: not known, depth does not count
};

/// k, in (0, 1]. Numbers that are none count as seen sharply.
double acuity(const SeenMotion& seen, const AcuityOptions& options = {});

}  // namespace foresight
