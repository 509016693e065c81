// Calibration in a robot's URDF: where cameras sit, and what its joints add to their encoders.
//
//   mount          <joint type="fixed"> parent -> child, origin = T_parent_child
//   joint offset   q = q_encoder + offset: the joint's origin is turned (moved) by `offset` about (along)
//                  its axis, so that the encoder's value poses the link
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct UrdfMount {
  std::string parent;                      ///< name of a link
  std::string child;                       ///< name of a link; added, with its joint, where there is none
  Pose T_parent_child = Pose::Identity();  ///< child to parent coordinates
};

struct UrdfOffsets {
  std::vector<UrdfMount> mounts;
  std::map<std::string, double> joints;  ///< name -> rad or m
};

/// `urdf` (the text of a file, named `where` in messages) with the offsets worked in; the rest is kept.
/// Throws InputError: not XML, no <robot>, a link or joint that is not there (with the nearest name), a
/// mount whose child hangs elsewhere or on a joint that is not fixed, an offset of a fixed joint.
std::string with_offsets(const std::string& urdf, const UrdfOffsets& offsets, const std::string& where);

/// T_parent_child of the joint whose child is `child`. Throws InputError as above.
UrdfMount read_mount(const std::string& urdf, const std::string& child, const std::string& where);

/// Text of a URDF with the one link `root`.
std::string empty_urdf(const std::string& root);

}  // namespace foresight
