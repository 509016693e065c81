#include "sim/physics/lab_things.hpp"

namespace foresight::sim {

// Masses: what such things weigh (a full mug, can and bottle; wooden blocks of 600 kg/m^3; cartons of what is in them).
// Friction on rubber and wood: glazed and printed things less, wood and cardboard more.
const std::vector<LooseThing>& lab_things() {
  static const std::vector<LooseThing> things = {
      {"carton", 1.2, {.friction = 0.7, .restitution = 0.1}},
      {"servo_kit", 0.5, {.friction = 0.6, .restitution = 0.1}},
      {"block_a", 0.10, {.friction = 0.7, .restitution = 0.2}},
      {"block_b", 0.10, {.friction = 0.7, .restitution = 0.2}},
      {"block_c", 0.10, {.friction = 0.7, .restitution = 0.2}},
      {"block_d", 0.21, {.friction = 0.7, .restitution = 0.2}},
      {"mug", 0.42, {.friction = 0.5, .restitution = 0.1}},
      {"can", 0.38, {.friction = 0.5, .restitution = 0.1}},
      {"bottle", 0.60, {.friction = 0.5, .restitution = 0.1}},
      {"pencil", 0.006, {.friction = 0.5, .restitution = 0.1}},
      {"ball", 0.045, {.friction = 0.7, .rolling = 4e-4, .restitution = 0.5}},
      {"brick_red", 0.09, {.friction = 0.7, .restitution = 0.2}},
      {"brick_blue", 0.09, {.friction = 0.7, .restitution = 0.2}},
      {"tray", 0.30, {.friction = 0.8, .restitution = 0.1}},
  };
  return things;
}

std::vector<std::string> lab_thing_names() {
  std::vector<std::string> out;
  for (const LooseThing& thing : lab_things()) out.push_back(thing.name);
  return out;
}

// Rubber pads 1 to 2 mm soft at the jaws' full force; covers of the links give way a little too.
Surface jaw_surface() {
  return {.friction = 1, .restitution = 0, .stiffness = 1e4, .damping = 20};
}
Surface link_surface() {
  return {.friction = 0.6, .restitution = 0.1, .stiffness = 3e4, .damping = 60};
}
Surface still_surface() {
  return {.friction = 0.9, .restitution = 0.4};
}

}  // namespace foresight::sim
