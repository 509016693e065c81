// A rig at one position of its joints as shapes and words: what the gate guards, where joints may go, what cameras see.
#pragma once

#include <array>
#include <cstdint>

#include "rig_view/drawing.hpp"
#include "rig_view/rig_body.hpp"

namespace foresight {

/// What may be shown or left out.
enum class Layer : std::uint8_t { links, guards, obstacles, workspace, limits, frames, cameras, names };
inline constexpr std::size_t kLayers = 8;
using Layers = std::array<bool, kLayers>;  ///< by Layer
inline constexpr Layers kAllLayers{true, true, true, true, true, true, true, true};

inline bool shows(const Layers& layers, Layer layer) {
  return layers[static_cast<std::size_t>(layer)];
}

/// As the legend has it.
struct LayerStyle {
  const char* name;
  Colour colour;
};
const LayerStyle& style_of(Layer layer);

inline const Colour kBadColour{0.85f, 0.10f, 0.10f, 1};
inline const Colour kClearanceColour{0.93f, 0.50f, 0.10f, 1};

/// All but the meshes. `selected`: joint of the rig that is drawn bolder; -1: none.
Drawing draw_rig(const RigBody& body, const PlacedRig& placed, std::span<const double> positions, const Layers& layers,
                 int selected);

/// The link of a couple that the gate would stop for, by its name: its guard is red.
bool is_too_close(const PlacedRig& placed, const std::string& link);

}  // namespace foresight
