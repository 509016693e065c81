// Whether the lamp that is believed still throws its shadows: asked of each image, where a search asks of dozens.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "texture_gpu/lamp/lamp.hpp"
#include "texture_gpu/lamp/lamp_record.hpp"
#include "texture_gpu/lamp/shadow_rays.hpp"

namespace foresight {

/// A lamp that was switched off, moved or exchanged leaves points bright on which shadows of what moves are foretold.
/// One thread, which alone uses the rays meanwhile.
class LampWatch {
 public:
  /// What a record shows of the witnesses, in order. `moving`: nodes whose shadows are foretold.
  void look(const ShadowRays& rays, std::span<const Witness> witnesses, const LampRecord& record,
            const std::vector<bool>& moving, const Lamp& lamp);

  /// So many of the last records show together that the lamp is gone; 0: none do.
  int against() const;

  /// Other witnesses, or another light.
  void begin_anew() { *this = {}; }

 private:
  /// Of the points of one record that the lamp does not reach.
  struct Shade {
    int points = 0;
    double darker = 0, foretold = 0;  // their darkness as seen, and the lamp's, each in terms of the lamp's
  };

  std::vector<float> lit_;  // of each witness: luma when last in the light, logarithm, exposures evened out; or NaN
  std::deque<Shade> shades_;
};

}  // namespace foresight
