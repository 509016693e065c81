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
/// with all nodes, with those in view, and with those that portals show; and at how many pixels they differ. Prints
/// them; keys: all, frustum, portals, different_pixels. In the current context.
nlohmann::json portal_figures(const PortalTrial& trial);

}  // namespace foresight
