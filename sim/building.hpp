// A building of rooms with doors, as large as is asked for: for what must not depend on how much there is.
#pragma once

#include "scene/scene_model.hpp"

namespace foresight::sim {

struct BuildingOptions {
  int rooms_x = 4, rooms_y = 3;     ///< at least 1 each
  std::size_t triangles = 100'000;  ///< about so many in all
  unsigned seed = 1;                ///< of doors and things
};

constexpr double kHalfWall = 0.08;  ///< m, of a building: what of a wall belongs to each room

/// Rooms of 5 x 4 x 2.8 m beside each other from the origin on, z up: a node for each room's walls, and one for each of
/// its things. Its cells are the rooms, its portals the doors; from every room there is a way to every other.
SceneModel make_building(const BuildingOptions& options);

}  // namespace foresight::sim
