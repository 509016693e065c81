// What cells and portals leave out of a building.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace foresight {

struct PortalTrial {
  std::size_t triangles = 200'000;
  int views = 40;
  unsigned seed = 1;
};

/// Random views in a building of 4 x 3 rooms (sim/building.hpp), depth and surface, 320 x 240 px: triangles and CPU-ms
/// with all nodes, with those in view, with those that portals show, and with those of them that nothing hides, once
/// after another view and once after the same one, with portals and without; and at how many pixels they differ from
/// the first. Prints them; keys: all, frustum, portals, hidden, hidden_again, hidden_without_cells,
/// hidden_without_cells_again, different_pixels, ties. In the current context.
nlohmann::json portal_figures(const PortalTrial& trial);

}  // namespace foresight
