// A robot that carries a ball in the lab, for questions about contact.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "prediction/contact/contact_model.hpp"

namespace foresight {

struct ContactLab {
  UrdfRobot robot;
  std::vector<std::string> joints;  ///< all that move by themselves
  SceneModel scene;                 ///< node 0 is carried
  Pose T_world_root = Pose::Identity();
  std::string hand;  ///< the link that carries it
  std::unique_ptr<ContactModel> model;
  std::size_t triangles = 0;  ///< of the robot and what it carries

  /// The mesh of each of the model's parts.
  std::vector<const Mesh*> meshes() const;
};

/// The URDF's robot, or the lab's arm; each link of `triangles` triangles or a few more or less; 0: as they are. Throws
/// InputError as read_urdf and ContactModel.
ContactLab make_contact_lab(const std::optional<std::filesystem::path>& urdf, std::size_t triangles);

/// Joint vectors, one position per joint of the lab: uniform over the limits, a turn where there are none.
std::vector<std::vector<double>> uniform_poses(const ContactLab& lab, std::size_t count);
/// 60 a second, evenly from one uniform vector to the next, the fastest joint at half its velocity.
std::vector<std::vector<double>> motion_poses(const ContactLab& lab, std::size_t count);

}  // namespace foresight
