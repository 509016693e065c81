// The lab of the synthetic runs: a table with things on it, a wall behind, and a robot arm beside it.
//
// World: x away from the operator, y left, z up; the origin lies on the table top. Metres.
//
// The way to a picture: a LabState says where every part stands, LightMap::at lights that state,
// Renderer::render looks at it. Whoever drives the lab, a recorded motion or a live one, makes states.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/robot_scene.hpp"
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
  bool moves = false;                    ///< may stand elsewhere in a LabState; light on it is computed each time
};

/// Where every part stands: T_world_part, one per part, in the lab's order. Parts that do not
/// move stand at rest.
using LabState = std::vector<Pose>;

/// Immutable once built; safe to share between threads. Before a LightMap is made of it, `moves`
/// may be set for any part that is to be moved about.
struct Lab {
  std::vector<Material> materials;
  std::vector<Part> parts;
  int arm = 0;      ///< index of the arm's stand; its links follow, in the order of sim/arm.hpp; -1: has none
  int things = -1;  ///< index of the part of the first node of `things`; the others follow; -1: there are none

  LabState at_rest() const;
  int find(const std::string& name) const;  ///< index of the part; throws std::out_of_range
};

/// `texel`: metres per texel of the finest pictures. `seed` varies grain and small print.
/// With a ball, that is one more part at the end, "ball", which moves. With a task, things for it (sim/lab_task.hpp)
/// come last.
Lab make_lab(double texel, unsigned seed, bool with_ball = false, std::optional<unsigned> task = {});
/// The lab with `things` (sim/things.hpp) in place of its arm, and with the ball; without `furniture`, nothing but
/// them.
Lab make_lab_with(const RobotScene& things, bool furniture, double texel, unsigned seed,
                  std::optional<unsigned> task = {});
inline constexpr float kBallRadius = 0.03f;  ///< metres

/// The part's triangles over welded vertices, exactly as they are rendered.
Mesh mesh_of(const Part& part);

/// The model is exact; this tells thin parts from what they lie on. Metres.
inline constexpr double kLabAccuracy = 0.004;

/// The lab as a scene's nodes: node i is part i, at rest where `T_world_part` says. Every node's parent is the world.
std::vector<Node> nodes_of(const Lab& lab, const LabState& T_world_part);

}  // namespace foresight::sim
