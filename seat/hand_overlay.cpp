#include "seat/hand_overlay.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "input/hand_of_rig.hpp"

namespace foresight {
namespace {

constexpr double kDrawnWithin = 0.025;  // m: distances that are drawn
constexpr double kTouches = 1.5e-3;     // m: what a camera cannot tell from touching
constexpr std::size_t kMostDrawn = 4;   // of distances
constexpr double kStill = 0.004;        // m of path that are not worth a line
constexpr double kDial = 0.09;          // m, radius of a joint's dial
constexpr std::size_t kMostDials = 2;

const OverlayStyle kGhost{{1.0f, 0.62f, 0.15f}, 2.2f, 0.012f};
const OverlayStyle kGhostWay{{1.0f, 0.62f, 0.15f}, 2.0f, 0.006f};
const OverlayStyle kPath{{0.35f, 0.85f, 1.0f}, 2.2f};
const OverlayStyle kInstant{{0.35f, 0.85f, 1.0f}, 6.0f};
const OverlayStyle kGap{{1.0f, 1.0f, 1.0f}, 1.6f, 0.004f};
const OverlayStyle kContact{{1.0f, 0.35f, 0.3f}, 2.6f};
const OverlayStyle kDialRange{{0.9f, 0.9f, 0.9f}, 1.6f, 0.01f};
const OverlayStyle kDialAt{{1.0f, 0.86f, 0.3f}, 3.2f};

double length(const std::vector<Eigen::Vector3d>& points) {
  double out = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) out += (points[i + 1] - points[i]).norm();
  return out;
}

bool hangs_on(const UrdfRobot& robot, std::size_t link, std::size_t on) {
  for (int at = static_cast<int>(link); at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent)
    if (static_cast<std::size_t>(at) == on) return true;
  return false;
}

std::string ghost_words(const HandSight& sight, std::span<const std::string> names) {
  const GhostHand& ghost = sight.touch.ghost;
  if (ghost.reason == GhostReason::contact || ghost.reason == GhostReason::gate || !sight.touch.known)
    return ghost.words;
  const auto joint = static_cast<std::size_t>(std::max(sight.follow_joint, 0));
  const std::string name = sight.follow_joint >= 0 && joint < names.size() ? names[joint] : "";
  const HandWords words = words_for(sight.follow, name);
  return words.name.empty() ? "your hand" : words.name;
}

}  // namespace

HandOverlay::HandOverlay(const Rig& rig, const HandOptions& hand) : rig_(rig), hand_(hand), names_(rig.joint_names()) {
  if (!hand_.arm) return;
  const UrdfRobot& robot = *rig.robot;
  links_.emplace(robot, rig.urdf_joint_names(), rig.T_world_robot, rig.name);
  tool_ = hand_.tip;
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (hangs_on(robot, i, tool_) && !robot.body(i).triangles.empty()) gripper_.push_back({i, wire_of(robot.body(i))});
  T_tool_part_.resize(gripper_.size());
}

Pose HandOverlay::T_world_tool(const JointValues& joints) const {
  return rig_.T_world_robot * hand_.arm->tip_pose(joints_of(joints, hand_.arm_joints));
}

HandPicture HandOverlay::draw(const HandSight& sight, const std::vector<PredictedRobot>& under_way) {
  HandPicture out;
  if (!links_) return out;
  const JointValues* shown = !under_way.empty() ? &under_way.back().position
                             : sight.joints > 0 ? &sight.positions
                                                : nullptr;
  if (!shown) return out;
  links_->pose(std::span(shown->data(), links_->inputs()));
  const Pose T_tool_world = T_world_tool(*shown).inverse();
  for (std::size_t i = 0; i < gripper_.size(); ++i)
    T_tool_part_[i] = T_tool_world * links_->T_world_link(gripper_[i].link);
  if (sight.phase == HandPhase::driving) {
    draw_ghost(sight, out);
    draw_near(sight, out);
  }
  draw_limits(*shown, out);
  draw_path(under_way, out);
  return out;
}

// From where the robot is known to be to where it is shown, with a dot for each instant.
void HandOverlay::draw_path(const std::vector<PredictedRobot>& under_way, HandPicture& out) const {
  std::vector<Eigen::Vector3d> points;
  for (const PredictedRobot& robot : under_way) points.push_back(T_world_tool(robot.position).translation());
  if (length(points) < kStill) return;
  out.lines.polyline(points, kPath);
  for (const Eigen::Vector3d& point : points) out.lines.dot(point, kInstant);
  const Pose T_world_known = T_world_tool(under_way.front().position);
  for (const double radius : {0.012, 0.018})
    out.lines.ring(points.front(), T_world_known.linear().col(2), radius, kPath);
  const double ahead = to_seconds(under_way.back().time - under_way.front().time);
  out.labels.push_back({points.front(), fmt::format("known; sent since: {:.0f} ms", 1e3 * ahead)});
}

void HandOverlay::draw_ghost(const HandSight& sight, HandPicture& out) const {
  if (!sight.touch.ghost.shown || !sight.T_world_hand) return;
  const Pose& hand = *sight.T_world_hand;
  for (std::size_t i = 0; i < gripper_.size(); ++i) out.lines.wire(gripper_[i].wire, hand * T_tool_part_[i], kGhost);
  out.lines.line(sight.T_world_tool.translation(), hand.translation(), kGhostWay);
  out.lines.cross(hand.translation(), hand, 0.03, kGhost);
  out.labels.push_back({hand.translation(), ghost_words(sight, names_), Urgency::note});
}

void HandOverlay::draw_near(const HandSight& sight, HandPicture& out) const {
  std::size_t drawn = 0;
  bool told = false;  // the nearest gap, in words
  for (const NearPart& near : sight.touch.near) {
    if (near.distance > kDrawnWithin || ++drawn > kMostDrawn) break;
    if (near.distance > kTouches) {
      out.lines.line(near.point, near.other_point, kGap);
      out.lines.dot(near.other_point, kGap);
      if (!told)
        out.labels.push_back({near.other_point, fmt::format("{:.0f} mm to {}", 1e3 * near.distance, near.other)});
      told = true;
      continue;
    }
    const Eigen::Vector3d way = near.point - near.other_point;
    const Eigen::Vector3d out_of = way.norm() > 1e-9 ? way.normalized() : Eigen::Vector3d::UnitZ();
    for (const double radius : {0.008, 0.016}) out.lines.ring(near.other_point, out_of, radius, kContact);
    const std::string words = near.part + " touches " + near.other;
    const bool known = std::ranges::any_of(out.labels, [&](const WorldLabel& l) { return l.words == words; });
    if (!known) out.labels.push_back({near.other_point, words, Urgency::note});
  }
}

// A dial about a joint's axis: its range, and where in it the joint stands.
void HandOverlay::draw_limits(const JointValues& shown, HandPicture& out) const {
  std::size_t drawn = 0;
  for (const NearLimit& limit : near_limits(hand_, shown)) {
    if (++drawn > kMostDials) break;
    const auto joint = std::ranges::find(rig_.robot->joints, names_[limit.joint], &UrdfJoint::name);
    if (joint == rig_.robot->joints.end()) continue;
    const Pose& T_world_link = links_->T_world_link(static_cast<std::size_t>(joint->child));
    const Eigen::Vector3d axis = T_world_link.linear() * joint->axis, at = T_world_link.translation();
    out.labels.push_back({at, words_of(limit, names_), Urgency::note});
    if (joint->kind != UrdfJoint::Kind::rotating) continue;
    // The child's own frame turns with the joint: back by its position is where the range counts from.
    const Eigen::Vector3d across = std::abs(joint->axis.x()) < 0.7 ? joint->axis.cross(Eigen::Vector3d::UnitX())
                                                                   : joint->axis.cross(Eigen::Vector3d::UnitY());
    const Eigen::Vector3d hand = kDial * (T_world_link.linear() * across.normalized());
    const auto turned = [&](double by) -> Eigen::Vector3d { return at + Eigen::AngleAxisd(by, axis) * hand; };
    const double to_lower = limit.lower - limit.position, range = std::min(limit.upper - limit.lower, 2 * M_PI);
    out.lines.arc(at, axis, turned(to_lower), range, kDialRange);
    const double end =
        std::abs(to_lower) < std::abs(limit.upper - limit.position) ? to_lower : limit.upper - limit.position;
    out.lines.line(at, turned(end), kDialRange);
    out.lines.line(at, turned(0), kDialAt);
    out.lines.arc(at, axis, turned(0), end, kDialAt);
  }
}

}  // namespace foresight
