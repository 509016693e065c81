// A drawn view warped to where the head is by now, beside what is drawn there.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/bench/head_lab.hpp"

namespace foresight {

struct WarpTrials {
  int width = 640, height = 480;  ///< px of a view
  int views = 40;
  double degrees = 2, metres = 0.02;  ///< of head motion between drawing and showing
  double eyes_apart = 0.065;          ///< m
  unsigned seed = 1;
};

/// Random motions of the head: each view drawn anew, and warped from the view before it; likewise a second eye from the
/// first, and a view through the lens of a panel. Prints, and gives for each (keys: motion, second_eye,
/// through_panel_lens): decibels over all pixels, holes before filling, CPU time of both.
nlohmann::json warp_figures(HeadLab& lab, const WarpTrials& trials);

}  // namespace foresight
