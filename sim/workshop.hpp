// A workshop: one large hall, full of finely divided things, where no wall hides anything.
#pragma once

#include "scene/scene_model.hpp"

namespace foresight::sim {

struct WorkshopOptions {
  std::size_t triangles = 5'000'000;  ///< about so many in all; at least 20,000
  unsigned seed = 1;
};

/// A hall of 24 x 16 x 6 m around the origin, z up: machines in rows with an aisle along x, shelves with what lies on
/// them, pipes along the walls, a crane, carts and wheels. Two of its things cannot be simplified: racks, at whose
/// edges three sheets meet, and swarf, which is loose triangles.
SceneModel make_workshop(const WorkshopOptions& options);

/// After so many seconds: the crane travels, carts go to and fro along the aisle, wheels turn.
SceneState workshop_state(const SceneModel& workshop, double seconds);

}  // namespace foresight::sim
