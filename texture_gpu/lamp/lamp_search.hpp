// The search for the lamp whose shadows explain best what images have shown.
#pragma once

#include <deque>
#include <optional>

#include "texture_gpu/lamp/lamp.hpp"
#include "texture_gpu/lamp/lamp_record.hpp"
#include "texture_gpu/lamp/shadow_rays.hpp"

namespace foresight {

struct LampAnswer {
  std::optional<Lamp> lamp;         ///< nothing where it cannot be told
  bool told_by_what_moves = false;  ///< else single images have told it
  bool several = false;             ///< another lamp seems to be there that is not much weaker
  int dark = 0;                     ///< observations that were darker than the same point usually is
  double explained = 0;  ///< share of the squared deviations of what was looked at that the best lamp explains
  double elsewhere = 0;  ///< that the best lamp in another direction explains
  /// Likewise of how bright points are in one image beside those around them.
  double still = 0, still_elsewhere = 0;
};

struct LampQuestion {
  std::vector<Witness> witnesses;  ///< normals towards the cameras
  std::deque<LampRecord> records;
  std::vector<bool> moving;  ///< nodes whose shadows are looked for; where the others stand does not change
  LampAnswer last;           ///< to the question before; its lamp is what is thought to be it
  /// Look for the lamp everywhere. Else near the last answer, if it still explains what it did, unless it was told by
  /// single images and what moves could tell now: that takes a quarter of the time, and tells nothing new of other
  /// lamps.
  bool all_around = true;
};

/// The same question has the same answer. Takes some tenths of a second of CPU time; `rays` is of the scene, and used
/// by nobody else meanwhile.
LampAnswer find_lamp(const ShadowRays& rays, const LampQuestion& question);

}  // namespace foresight
