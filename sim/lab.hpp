// The small lab of the sample run: a table, boxes, and a plate that moves.
//
// World: x away from the operator, y left, z up; the origin is the middle of the table top. Metres.
#pragma once

#include <string>
#include <vector>

#include "scene/scene_model.hpp"
#include "sim/shapes.hpp"
#include "sim/texture.hpp"

namespace foresight::sim {

struct Material {
  Texture picture;
  float gloss = 0;  ///< strength of the lamp's mirror image; 0 is matt
};

/// One node of the scene.
struct Part {
  std::string name;
  Facets facets;                         ///< node frame
  Pose T_world_part = Pose::Identity();  ///< at rest
  double light_step = 0.01;              ///< largest distance between light samples on it, metres
};

/// Immutable once built; safe to share between threads.
struct Lab {
  std::vector<Material> materials;
  std::vector<Part> parts;
  int plate = 0;  ///< index of the part that moves
};

/// `texel`: metres per texel of the finest pictures. `seed` varies grain and small print.
Lab make_lab(double texel, unsigned seed);

/// The part's triangles over welded vertices, exactly as they are rendered.
Mesh mesh_of(const Part& part);

}  // namespace foresight::sim
