// What there is of a rig to be drawn, and where it stands for given joints.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "motion/robot_shape.hpp"
#include "rig/rig_scene.hpp"
#include "scene/stereo_lenses.hpp"

namespace foresight {

struct HeadModel;

/// A joint of the rig that the URDF has.
struct PlacedJoint {
  std::size_t joint = 0;  ///< of the rig
  bool slides = false;
  Eigen::Vector3d place, axis;  ///< world; axis: unit
  Eigen::Vector3d zero;         ///< unit, upright on the axis: where the link points at position 0
};

struct PlacedCamera {
  std::string name;
  Pose T_world_camera = Pose::Identity();
  Lens lens;
};

/// A couple of parts that the gate keeps apart.
struct NearCouple {
  std::string text;     ///< as RobotShape::message()
  double margin_m = 0;  ///< by how much it is farther apart than it must be; negative: the gate stops
};

/// Everything at one position of the joints.
struct PlacedRig {
  std::vector<Pose> T_world_node;   ///< of RigBody::nodes()
  std::vector<GuardedLink> guards;  ///< world
  std::vector<NearCouple> couples;  ///< nearest first
  std::vector<PlacedJoint> joints;
  std::vector<PlacedCamera> cameras;
};

/// One thread.
class RigBody {
 public:
  /// `rig` must outlive this; `scene_file` stands in place of its scene. Throws what rig_scene(), RobotShape and
  /// read_head_model() do.
  RigBody(const Rig& rig, const std::optional<std::filesystem::path>& scene_file);
  ~RigBody();

  const Rig& rig() const { return rig_; }
  const RobotScene& nodes() const { return *nodes_; }
  /// Joints at 0 or their nearest limit, a mock lab's head where it looks at the table; in the rig's order.
  std::vector<double> rest() const;
  /// `positions`: in the rig's order, rad or m.
  PlacedRig at(std::span<const double> positions);
  /// Why no camera is drawn, or where they stand by; a few words.
  const std::string& about_cameras() const { return about_cameras_; }
  /// The robot at rest, the cameras and the obstacles near them; without any, all that there is. World.
  Eigen::AlignedBox3d extent();

 private:
  void place_joints(std::span<const double> positions, PlacedRig& out) const;
  void place_cameras(const JointPositions& joints, PlacedRig& out) const;

  const Rig& rig_;
  std::shared_ptr<const RobotScene> nodes_;
  std::vector<std::size_t> node_of_link_;
  std::unique_ptr<RobotShape> shape_;  // null: the rig has no URDF
  std::unique_ptr<HeadModel> head_;    // null: not calibrated
  std::optional<StereoLenses> lenses_;
  bool mock_head_ = false;
  std::string about_cameras_;
};

/// "elbow=0.5,finger=0.02": the positions of `positions`, in the rig's order, that are named. Throws InputError at
/// `where`: no such joint (with the nearest name), no number, beyond the rig's limits.
void set_positions(const Rig& rig, const std::string& text, const std::string& where, std::vector<double>& positions);

}  // namespace foresight
