// What can be chosen in the thesis' pipeline, as in its chapters 4, 5 and 7.2.2.
#pragma once

namespace foresight::thesis {

/// How invalid areas grow (section 5.1).
enum class Expansion {
  none,
  alternating,  ///< halve and double the mask, again and again (figure 5.7)
  progressive,  ///< halve several times, then double as often (figure 5.8)
  shader,       ///< dilation by a fragment shader, one texel per iteration (eq. 5.5)
};

/// How holes are filled (section 5.2).
enum class HoleFilling {
  none,
  pyramid,           ///< sections 5.2.2 to 5.2.4
  shader_one_stage,  ///< only the first filter (eqs. 5.26, 5.27); leaves hard edges (figure 5.23 b)
  shader,            ///< both filters (eqs. 5.28, 5.29), as many passes as the largest hole could need (eq. 5.30)
  shader_query,      ///< the same, ended by an occlusion query as soon as nothing changes
};

struct Options {
  double texels_per_metre = 500;  ///< d of eqs. 4.28 and 4.29
  int max_texture = 256;          ///< r_max of eqs. 4.28 and 4.29, texels
  bool occlusion = true;          ///< section 4.2; false: figure 4.4
  bool clean_borders = true;      ///< section 4.5.3: line border and the bounding box normalised; false: figure 4.15
  Expansion expansion = Expansion::shader;
  int iterations = 3;  ///< of the expansion
  HoleFilling hole_filling = HoleFilling::pyramid;
  bool profile = false;  ///< report the stages one by one: on software renderers each step then waits for the last
};

}  // namespace foresight::thesis
