#include "input/sliding_jaws.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/error.hpp"
#include "input/hand_of_rig.hpp"
#include "motion/posed_links.hpp"

namespace foresight {
namespace {

constexpr double kStill = 1e-6;       // m or rad: has not moved
constexpr double kSquare = 0.02;      // cosine between directions that are square to each other
constexpr double kRangeEnd = 0.01;    // of a joint's range, that is left at both ends
constexpr double kUnderHand = 0.003;  // m between a thing and the hand, where the jaws are short
constexpr double kFlank = 1e-4;       // m from the tips on, that are looked at at least

/// A link from the tool on. Its way is straight, and even with each of the gripper's joints.
struct Body {
  std::size_t link = 0;
  Pose T_tool_link = Pose::Identity();  // all of the gripper's joints at their least
  Eigen::Matrix3Xd travel;              // in the tool, over the whole range of each of them
  bool moves() const { return travel.cwiseAbs().maxCoeff() > kStill; }
};

class HandModel {
 public:
  explicit HandModel(const Rig& rig);
  SlidingJaws measure(double depth) const;

 private:
  struct Face {
    double place = 0;   // along y of the grip's axes, with all of the gripper's joints at their least
    double middle = 0;  // along x
    Eigen::RowVectorXd travel;
  };
  void pose_bodies();
  Body body_of(std::size_t link, const std::vector<std::vector<Pose>>& T_tool_link) const;
  const Mesh& mesh(std::size_t link) const;
  Eigen::Vector3d way() const;
  Eigen::Matrix3d axes(const Eigen::Vector3d& way) const;
  Eigen::AlignedBox3d box(const Body& body, const Eigen::Matrix3d& R_tool_grip, double from) const;
  double farthest(const Eigen::Matrix3d& R_tool_grip, bool moving) const;
  std::array<Face, 2> faces(const Eigen::Matrix3d& R_tool_grip, double from) const;
  InputError refusal(const std::string& what, const std::string& cure) const { return {rig_.name, what, cure}; }

  const Rig& rig_;
  const std::size_t tool_;  // a rig without a robot is refused before it is asked for one
  const UrdfRobot& robot_;
  std::vector<std::size_t> joints_;  // of the rig, those of the gripper
  std::vector<Body> bodies_;         // that have a shape
};

HandModel::HandModel(const Rig& rig) : rig_(rig), tool_(arm_options(rig).tip), robot_(*rig.robot) {
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    if (rig.joints[i].group == JointGroup::gripper) joints_.push_back(i);
  if (joints_.empty())
    throw refusal("has no gripper: none of its joints has `group: gripper`",
                  "give it to those that move the jaws (docs/rig-files.md)");
  pose_bodies();
  if (std::ranges::none_of(bodies_, &Body::moves))
    throw refusal("joint '" + rig.joints[joints_.front()].drive.name + "' of its gripper moves no shape beyond link '" +
                      robot_.links[tool_].name + "', the arm's last",
                  "give the jaws' links <visual> shapes, or correct the joints' groups");
}

void HandModel::pose_bodies() {
  std::vector<std::string> names;
  std::vector<double> positions;
  for (const std::size_t i : joints_) {
    names.push_back(rig_.joints[i].drive.name);
    positions.push_back(rig_.joints[i].drive.min_position);
  }
  PosedLinks posed(robot_, names, Pose::Identity(), rig_.name);
  // With all at their least, then with one after the other at its most.
  std::vector<std::vector<Pose>> T_tool_link;
  const auto look = [&] {
    posed.pose(positions);
    std::vector<Pose>& out = T_tool_link.emplace_back();
    for (std::size_t k = 0; k < posed.size(); ++k)
      out.push_back(posed.T_world_link(tool_).inverse() * posed.T_world_link(k));
  };
  look();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const double least = std::exchange(positions[j], rig_.joints[joints_[j]].drive.max_position);
    look();
    positions[j] = least;
  }
  for (std::size_t k = 0; k < posed.size(); ++k)
    if (posed.common_ancestor(k, tool_) == tool_ && !mesh(k).vertices.empty())
      bodies_.push_back(body_of(k, T_tool_link));
}

Body HandModel::body_of(std::size_t link, const std::vector<std::vector<Pose>>& T_tool_link) const {
  Body out{link, T_tool_link[0][link], Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(joints_.size()))};
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Pose& most = T_tool_link[j + 1][link];
    const double turn = Eigen::AngleAxisd(out.T_tool_link.linear().transpose() * most.linear()).angle();
    if (std::abs(turn) > 1e-4)
      throw refusal(fmt::format("joint '{}' of its gripper turns link '{}', by {:.2f} rad: its jaws do not slide",
                                rig_.joints[joints_[j]].drive.name, robot_.links[link].name, turn),
                    "use a gripper whose jaws slide");
    out.travel.col(static_cast<Eigen::Index>(j)) = most.translation() - out.T_tool_link.translation();
  }
  return out;
}

/// What is seen, and what things of the mock lab meet.
const Mesh& HandModel::mesh(std::size_t link) const {
  const Mesh& visual = robot_.links[link].mesh;
  return visual.vertices.empty() ? robot_.body(link) : visual;
}

/// Of the jaws in the tool, unit; its largest component is positive.
Eigen::Vector3d HandModel::way() const {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for (const Body& body : bodies_)
    for (const auto& travel : body.travel.colwise()) {
      if (travel.norm() < kStill) continue;
      if (out.isZero()) out = travel.normalized();
      if (out.cross(travel).norm() > kSquare * travel.norm())
        throw refusal("its jaws slide along several lines: link '" + robot_.links[body.link].name +
                          "' goes another way than those before it",
                      "use a gripper of two jaws that slide towards each other");
    }
  Eigen::Index largest = 0;
  out.cwiseAbs().maxCoeff(&largest);
  return out[largest] < 0 ? Eigen::Vector3d(-out) : out;
}

/// The grip's axes in the tool.
Eigen::Matrix3d HandModel::axes(const Eigen::Vector3d& way) const {
  // Those of the link in which the jaws slide: a joint's own frame may be turned any way.
  const Body& jaw = *std::ranges::find_if(bodies_, &Body::moves);
  Eigen::Matrix3d R_tool_parent = jaw.T_tool_link.linear();
  std::size_t parent = jaw.link;
  for (bool slides = false; !slides;) {
    const UrdfJoint& joint = robot_.joints[parent - 1];
    R_tool_parent = R_tool_parent * joint.T_parent_joint.linear().transpose();
    parent = static_cast<std::size_t>(robot_.links[parent].parent);
    slides = joint.kind == UrdfJoint::Kind::sliding;
  }
  std::optional<Eigen::Matrix3d> out;
  double most = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d z = sign * R_tool_parent.col(axis);
      if (std::abs(z.dot(way)) > kSquare) continue;
      Eigen::Matrix3d R_tool_grip;
      R_tool_grip << way.cross(z), way, z;
      const double here = farthest(R_tool_grip, true);
      if (out && here <= most) continue;
      most = here;
      out = R_tool_grip;
    }
  if (!out)
    throw refusal(
        fmt::format("its jaws slide along ({:.2f}, {:.2f}, {:.2f}) of link '{}', square to none of the axes of "
                    "link '{}', of which one would be the way their tips point",
                    way.x(), way.y(), way.z(), robot_.links[tool_].name, robot_.links[parent].name),
        "turn that link's frame in the URDF such that one of its axes points from the hand to the tips");
  return *out;
}

/// Along the grip's axes, of what lies beyond `from` along z.
Eigen::AlignedBox3d HandModel::box(const Body& body, const Eigen::Matrix3d& R_tool_grip, double from) const {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& vertex : mesh(body.link).vertices)
    points.push_back(R_tool_grip.transpose() * (body.T_tool_link * vertex.cast<double>()));
  Eigen::AlignedBox3d out;
  for (const Eigen::Vector3d& p : points)
    if (p.z() >= from) out.extend(p);
  for (const auto& corners : mesh(body.link).triangles)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d &a = points[corners[k]], &b = points[corners[(k + 1) % 3]];
      if ((a.z() < from) == (b.z() < from)) continue;
      out.extend(a + (from - a.z()) / (b.z() - a.z()) * (b - a));
    }
  return out;
}

/// Along z from the tool's origin on, of the bodies that move or of the others.
double HandModel::farthest(const Eigen::Matrix3d& R_tool_grip, bool moving) const {
  double out = -std::numeric_limits<double>::infinity();
  for (const Body& body : bodies_)
    if (body.moves() == moving)
      out = std::max(out, box(body, R_tool_grip, -std::numeric_limits<double>::infinity()).max().z());
  return out;
}

/// The inner faces of both jaws, that at the larger y first.
std::array<HandModel::Face, 2> HandModel::faces(const Eigen::Matrix3d& R_tool_grip, double from) const {
  struct Seen {
    Eigen::AlignedBox3d box;
    Eigen::RowVectorXd travel;
    bool moves;
  };
  std::vector<Seen> seen;
  for (const Body& body : bodies_)
    if (const Eigen::AlignedBox3d here = box(body, R_tool_grip, from); !here.isEmpty())
      seen.push_back({here, R_tool_grip.col(1).transpose() * body.travel, body.moves()});
  const auto goes_elsewhere = [&](const Seen& one) {
    return one.moves && (one.travel - std::ranges::find_if(seen, &Seen::moves)->travel).norm() > kStill;
  };
  // What stands still is a jaw where one alone moves.
  if (std::ranges::any_of(seen, goes_elsewhere)) std::erase_if(seen, [](const Seen& one) { return !one.moves; });
  const auto y = [](const Seen& one) { return one.box.center().y(); };
  const auto [lowest, highest] = std::ranges::minmax(seen, {}, y);
  const double middle = 0.5 * (y(lowest) + y(highest));
  if (y(highest) - y(lowest) < kStill) throw refusal("its gripper has a single jaw, with nothing opposite", "add one");
  std::array<Face, 2> out;
  out[0].place = std::numeric_limits<double>::infinity();
  out[1].place = -out[0].place;
  for (const Seen& one : seen) {
    const bool upper = y(one) > middle;
    const double place = upper ? one.box.min().y() : one.box.max().y();
    Face& face = out[upper ? 0 : 1];
    if (upper ? place < face.place : place > face.place) face = {place, one.box.center().x(), one.travel};
  }
  return out;
}

SlidingJaws HandModel::measure(double depth) const {
  const Eigen::Matrix3d R_tool_grip = axes(way());
  const double tips = farthest(R_tool_grip, true), hand = farthest(R_tool_grip, false);
  SlidingJaws out;
  // A jaw that stands still is part of the hand, and reaches as far.
  const bool free = tips - hand > kUnderHand + kFlank;
  out.depth = free ? std::min(depth, tips - hand - kUnderHand) : depth;
  const std::array<Face, 2> jaws = faces(R_tool_grip, tips - out.depth);
  const Eigen::RowVectorXd opens = jaws[0].travel - jaws[1].travel;
  const auto place = [&](double end) {  // 1: as wide as can be
    SlidingJaws::Place at;
    at.gap = jaws[0].place - jaws[1].place;
    double middle = 0.5 * (jaws[0].place + jaws[1].place);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      const DriveConfig& drive = rig_.joints[joints_[j]].drive;
      const double share = opens[k] > 0 ? end : 1 - end;
      at.joints.push_back(std::lerp(drive.min_position, drive.max_position, share));
      at.gap += share * opens[k];
      middle += 0.5 * share * (jaws[0].travel[k] + jaws[1].travel[k]);
    }
    at.T_tool_grip.linear() = R_tool_grip;
    at.T_tool_grip.translation() = R_tool_grip * Eigen::Vector3d(0.5 * (jaws[0].middle + jaws[1].middle), middle,
                                                                 std::max(tips, free ? tips : hand));
    return at;
  };
  out.widest = place(1 - kRangeEnd);
  out.narrowest = place(kRangeEnd);
  if (out.widest.gap - out.narrowest.gap < kStill)
    throw refusal("its jaws neither open nor close: they slide the same way", "correct their axes in the URDF");
  return out;
}

}  // namespace

SlidingJaws::Place SlidingJaws::at(double gap) const {
  const double share = std::clamp((gap - narrowest.gap) / (widest.gap - narrowest.gap), 0.0, 1.0);
  Place out = narrowest;
  out.gap = std::lerp(narrowest.gap, widest.gap, share);
  out.T_tool_grip.translation() += share * (widest.T_tool_grip.translation() - narrowest.T_tool_grip.translation());
  for (std::size_t i = 0; i < out.joints.size(); ++i)
    out.joints[i] = std::lerp(narrowest.joints[i], widest.joints[i], share);
  return out;
}

SlidingJaws sliding_jaws(const Rig& rig, double depth) {
  return HandModel(rig).measure(depth);
}

}  // namespace foresight
