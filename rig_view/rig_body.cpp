#include "rig_view/rig_body.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "calibration/registration/calibrated_head.hpp"
#include "common/error.hpp"
#include "common/split.hpp"
#include "common/text.hpp"
#include "sim/live_lab.hpp"

namespace foresight {
namespace {

constexpr double kPoints = 0.02;  // metres off the axis from which on a link points somewhere

std::size_t joint_named(const Rig& rig, std::string_view name) {
  return static_cast<std::size_t>(
      std::ranges::find_if(rig.joints, [&](const RigJoint& joint) { return joint.drive.name == name; }) -
      rig.joints.begin());
}

JointPositions by_name(const Rig& rig, std::span<const double> positions) {
  return [&rig, positions](std::string_view name) -> std::optional<double> {
    const std::size_t at = joint_named(rig, shaft_name(rig, name));
    return at < positions.size() ? std::optional(positions[at]) : std::nullopt;
  };
}

Eigen::Vector3d middle_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& v : mesh.vertices) box.extend(v.cast<double>());
  return box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.center());
}

}  // namespace

RigBody::RigBody(const Rig& rig, const std::optional<std::filesystem::path>& scene_file)
    : rig_(rig), nodes_(rig_scene(&rig, scene_file)), shape_(rig.shape()) {
  if (shape_) shape_->surround(rig.surroundings);
  if (rig.robot)
    for (const Node& link : rig.robot->links)
      node_of_link_.push_back(static_cast<std::size_t>(std::ranges::find(nodes_->nodes(), link.name, &Node::name) -
                                                       nodes_->nodes().begin()));
  if (!rig.cameras) {
    about_cameras_ = "none in the rig";
    return;
  }
  const auto &left = rig.cameras->camera(Side::left).calibration, &right = rig.cameras->camera(Side::right).calibration;
  const bool mock = rig.cameras->mock();
  if (mock || (left && right && right->T_left_right)) {
    const sim::MockCameraOptions usual = mock_options(*rig.cameras);
    lenses_ = usual.lenses;
  }
  if (rig.calibration && rig.calibration->pan_tilt)
    head_ = std::make_unique<HeadModel>(read_head_model(*rig.calibration->pan_tilt, rig.calibration->time));
  mock_head_ = mock && !head_;
  if (!lenses_)
    about_cameras_ = "not drawn: no `lens`";
  else
    about_cameras_ = head_ ? "by the calibrated head" : mock ? "of the mock lab" : "not drawn: head not calibrated";
}

RigBody::~RigBody() = default;

std::vector<double> RigBody::rest() const {
  std::vector<double> out;
  for (const RigJoint& joint : rig_.joints)
    out.push_back(std::clamp(0.0, joint.drive.min_position, joint.drive.max_position));
  if (!mock_head_) return out;
  for (const char* const name : {"pan", "tilt"}) {
    const std::size_t at = joint_named(rig_, shaft_name(rig_, name));
    if (at >= out.size()) continue;
    const DriveConfig& drive = rig_.joints[at].drive;
    out[at] = std::clamp(*sim::shafts_at_rest(name), drive.min_position, drive.max_position);
  }
  return out;
}

PlacedRig RigBody::at(std::span<const double> positions) {
  PlacedRig out;
  out.T_world_node = nodes_->poses(by_name(rig_, positions));
  if (shape_) {
    out.guards = shape_->guarded(positions);
    std::vector<double> margins(shape_->couples());
    shape_->margins_by_meshes(positions, margins);
    for (std::size_t i = 0; i < margins.size(); ++i) out.couples.push_back({shape_->message(i), margins[i]});
    std::ranges::stable_sort(out.couples, {}, &NearCouple::margin_m);
    place_joints(positions, out);
  }
  place_cameras(by_name(rig_, positions), out);
  return out;
}

void RigBody::place_joints(std::span<const double> /*positions*/, PlacedRig& out) const {
  const UrdfRobot& robot = *rig_.robot;
  for (const UrdfJoint& joint : robot.joints) {
    const std::size_t at = joint_named(rig_, joint.name);
    if (joint.kind == UrdfJoint::Kind::fixed || joint.mimic || at == rig_.joints.size()) continue;
    const auto child = static_cast<std::size_t>(joint.child);
    const auto parent = static_cast<std::size_t>(robot.links[child].parent);
    const Pose T_world_joint = out.T_world_node[node_of_link_[parent]] * joint.T_parent_joint;
    PlacedJoint placed{at,
                       joint.kind == UrdfJoint::Kind::sliding,
                       T_world_joint.translation(),
                       T_world_joint.linear() * joint.axis,
                       {}};
    const Eigen::Vector3d towards = middle_of(robot.links[child].mesh);
    const Eigen::Vector3d off = towards - towards.dot(joint.axis) * joint.axis;
    placed.zero = T_world_joint.linear() *
                  (off.norm() > kPoints ? Eigen::Vector3d(off.normalized()) : joint.axis.unitOrthogonal());
    out.joints.push_back(placed);
  }
}

void RigBody::place_cameras(const JointPositions& joints, PlacedRig& out) const {
  if (!lenses_ || (!head_ && !mock_head_)) return;
  Pose T_world_left = Pose::Identity();
  if (head_) {
    const auto shaft = [&](const char* name, const HeadAxis& axis) {
      return axis.scale * joints(name).value_or(0) + axis.offset_rad;
    };
    T_world_left = T_world_camera(*head_, {shaft("pan", head_->pan), shaft("tilt", head_->tilt)});
  } else {
    T_world_left = sim::LiveLab::T_world_left_modelled(joints);
  }
  out.cameras.push_back({"left", T_world_left, lenses_->left});
  out.cameras.push_back({"right", T_world_left * lenses_->T_left_right, lenses_->right});
}

Eigen::AlignedBox3d RigBody::extent() {
  constexpr double kNear = 0.3;  // metres
  const PlacedRig placed = at(rest());
  Eigen::AlignedBox3d out, all = rig_.surroundings.workspace;
  for (std::size_t i = 0; i < nodes_->nodes().size(); ++i)
    for (const auto& v : nodes_->nodes()[i].mesh.vertices) {
      const Eigen::Vector3d p = placed.T_world_node[i] * v.cast<double>();
      (nodes_->moves(i) ? out : all).extend(p);
    }
  for (const PlacedCamera& camera : placed.cameras) out.extend(camera.T_world_camera.translation());
  for (const GuardedLink& link : placed.guards)
    out.extend(Eigen::AlignedBox3d(link.body.a.cwiseMin(link.body.b), link.body.a.cwiseMax(link.body.b)));
  if (out.isEmpty()) out = all;
  if (out.isEmpty()) out.extend(Eigen::Vector3d(-0.5, -0.5, -0.5)).extend(Eigen::Vector3d(0.5, 0.5, 0.5));
  // Of what stands around, as much as is near: beside a whole floor the robot would be small.
  const Eigen::AlignedBox3d near(out.min().array() - kNear, out.max().array() + kNear);
  for (const Obstacle& obstacle : rig_.surroundings.obstacles)
    if (near.intersects(obstacle.box)) out.extend(near.intersection(obstacle.box));
  return out;
}

void set_positions(const Rig& rig, const std::string& text, const std::string& where, std::vector<double>& positions) {
  for (const std::string& entry : split(text, ',')) {
    if (entry.empty()) continue;
    const std::size_t equals = entry.find('=');
    const std::string name = entry.substr(0, equals);
    const std::size_t at = joint_named(rig, name);
    if (at == rig.joints.size())
      throw InputError(where, "the rig has no joint " + in_quotes(name), did_you_mean(name, rig.joint_names()));
    const auto value = equals == std::string::npos ? std::nullopt : parse_number(entry.substr(equals + 1));
    if (!value)
      throw InputError(where, in_quotes(entry) + " gives no position",
                       "write " + name + "=NUMBER, in " + rig.joints[at].unit);
    const DriveConfig& drive = rig.joints[at].drive;
    if (!(*value >= drive.min_position && *value <= drive.max_position))
      throw InputError(where,
                       fmt::format("joint '{}' at {:.6g} {} is beyond its limits", name, *value, rig.joints[at].unit),
                       fmt::format("choose from {:.6g} to {:.6g}", drive.min_position, drive.max_position));
    positions[at] = *value;
  }
}

}  // namespace foresight
