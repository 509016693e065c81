// What on the lab's table is loose, as a careful owner would describe it.
#pragma once

#include <string>
#include <vector>

#include "dynamics/body_world.hpp"

namespace foresight::sim {

struct LooseThing {
  std::string name;  ///< of the lab's part
  double mass = 0;   ///< kg
  Surface surface;
};

/// Those of the built-in lab with its things for a hand (LiveLab::Options::task).
const std::vector<LooseThing>& lab_things();
std::vector<std::string> lab_thing_names();

/// What jaws, the other links and all that stands still are made of.
Surface jaw_surface();
Surface link_surface();
Surface still_surface();

}  // namespace foresight::sim
