// Things that come from files, such as a user's robot, as parts of the lab.
#pragma once

#include "scene/robot_scene.hpp"
#include "sim/lab_builder.hpp"

namespace foresight::sim {

/// A part for each node, in their order; one without triangles has no facets. Files' own colours and textures are not
/// known: each part gets a print of its own, wound around its node's box side by side, and shading that is smooth but
/// for edges of more than 40 degrees.
void add_things(LabBuilder& builder, const RobotScene& things);

}  // namespace foresight::sim
