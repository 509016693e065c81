// Calibration in a robot's URDF: where cameras sit, and what its joints add to their encoders.
//
//   mount          <joint type="fixed"> parent -> child, origin = T_parent_child
//   head           two turning joints and a camera on them, about the z axes of their frames; joints of these names
//                  that are there keep their axes, and get origins with which they do the same
//   joint offset   q = q_encoder + offset: the joint's origin is turned (moved) by `offset` about (along)
//                  its axis, so that the encoder's value poses the link
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct UrdfMount {
  std::string parent;                      ///< name of a link
  std::string child;                       ///< name of a link; added, with its joint, where there is none
  Pose T_parent_child = Pose::Identity();  ///< child to parent coordinates
};

struct UrdfHead {
  std::string parent;  ///< name of the link in whose frame the head stands
  std::array<std::string, 2> joints{"pan", "tilt"};
  std::string camera = "camera";          ///< name of a link; added, with its joint, where there is none
  Pose T_parent_pan = Pose::Identity();   ///< both joints at 0; the axes are z
  Pose T_pan_tilt = Pose::Identity();     ///< tilt's frame to that of pan
  Pose T_tilt_camera = Pose::Identity();  ///< optical frame of the camera
};

struct UrdfOffsets {
  std::vector<UrdfMount> mounts;
  std::map<std::string, double> joints;  ///< name -> rad or m
  std::optional<UrdfHead> head = {};
};

/// `urdf` (the text of a file, named `where` in messages) with the offsets worked in; the rest is kept.
/// Throws InputError: not XML, no <robot>, a link or joint that is not there (with the nearest name), a
/// mount whose child hangs elsewhere or on a joint that is not fixed, an offset of a fixed joint.
std::string with_offsets(const std::string& urdf, const UrdfOffsets& offsets, const std::string& where);

/// The mount as it hangs on `link` of the URDF: where that has no link `mount.parent`, `link` is what it is called
/// there; else both must be joined by fixed joints only. Throws InputError as above, and where a joint between them
/// moves.
UrdfMount attached(const UrdfMount& mount, const std::string& link, const std::string& urdf, const std::string& where);

/// T_parent_child of the joint whose child is `child`. Throws InputError as above.
UrdfMount read_mount(const std::string& urdf, const std::string& child, const std::string& where);

/// Text of a URDF with the one link `root`.
std::string empty_urdf(const std::string& root);

}  // namespace foresight
