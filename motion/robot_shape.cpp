#include "motion/robot_shape.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace foresight {
namespace {

constexpr int kSamples = 16;  // of a segment, against boxes

// Around all vertices: along the longest side of their box.
Capsule capsule_around(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& v : mesh.vertices) box.extend(v.cast<double>());
  int along = 0;
  box.sizes().maxCoeff(&along);
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(along), center = box.center();
  double radius = 0;
  for (const auto& v : mesh.vertices) {
    const Eigen::Vector3d d = v.cast<double>() - center;
    radius = std::max(radius, (d - d.dot(axis) * axis).norm());
  }
  // The caps need not reach beyond the mesh where its ends are round; they do, to be safe, where flat.
  double half = 0;
  for (const auto& v : mesh.vertices) {
    const Eigen::Vector3d d = v.cast<double>() - center;
    const double across = (d - d.dot(axis) * axis).norm();
    half = std::max(half, std::abs(d.dot(axis)) - std::sqrt(std::max(0.0, radius * radius - across * across)));
  }
  return {center - half * axis, center + half * axis, radius};
}

// Least distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
double segment_distance(const Capsule& s, const Capsule& t) {
  const Eigen::Vector3d d1 = s.b - s.a, d2 = t.b - t.a, r = s.a - t.a;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  const auto unit = [](double x) { return std::clamp(x, 0.0, 1.0); };
  double u = 0, v = 0;
  if (a < 1e-12) {
    v = e < 1e-12 ? 0 : unit(f / e);
  } else if (e < 1e-12) {
    u = unit(-c / a);
  } else {
    const double denominator = a * e - b * b;
    u = denominator > 1e-12 ? unit((b * f - c * e) / denominator) : 0;
    v = (b * u + f) / e;
    if (v < 0 || v > 1) {
      v = unit(v);
      u = unit((b * v - c) / a);
    }
  }
  return (s.a + u * d1 - t.a - v * d2).norm();
}

/// Negative inside: the way to the nearest face.
double signed_distance(const Eigen::Vector3d& p, const Eigen::AlignedBox3d& box) {
  if (!box.contains(p)) return box.exteriorDistance(p);
  return -std::min((p - box.min()).minCoeff(), (box.max() - p).minCoeff());
}

}  // namespace

double distance(const Capsule& one, const Capsule& other) {
  return segment_distance(one, other) - one.radius - other.radius;
}

double distance(const Capsule& capsule, const Eigen::AlignedBox3d& box) {
  double least = 1e30;
  for (int i = 0; i <= kSamples; ++i)
    least = std::min(least, signed_distance(capsule.a + i * (1.0 / kSamples) * (capsule.b - capsule.a), box));
  return least - capsule.radius - 0.5 * (capsule.b - capsule.a).norm() / kSamples;
}

GuardedLinks guarded_links(const UrdfRobot& robot) {
  GuardedLinks out;
  out.links = robot.links.size();
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Mesh& body = robot.body(i);
    if (body.vertices.empty())
      out.unguarded.push_back(robot.links[i].name);
    else
      ++(&body == &robot.links[i].mesh ? out.by_visual : out.by_collision);
  }
  return out;
}

std::string to_text(const GuardedLinks& guarded) {
  const std::size_t all = guarded.by_collision + guarded.by_visual;
  std::string out = fmt::format("{} of {} links guarded", all, guarded.links);
  if (guarded.by_visual == 0 && all > 0)
    out += " by their collision shapes";
  else if (guarded.by_collision == 0 && all > 0)
    out += " by their visual shapes; the URDF has no collision shapes";
  else if (all > 0)
    out += fmt::format(" ({} by collision shapes, {} by visual ones)", guarded.by_collision, guarded.by_visual);
  if (guarded.unguarded.empty()) return out;
  out += "; without a shape, as frames are:";
  for (const std::string& name : guarded.unguarded) out += (&name == &guarded.unguarded.front() ? " " : ", ") + name;
  return out;
}

RobotShape::RobotShape(UrdfRobot robot, const std::vector<std::string>& joints, const Pose& T_world_root,
                       const std::string& where, std::vector<bool> jaws, double clearance)
    : robot_(std::move(robot)),
      joints_(joints),
      jaws_(std::move(jaws)),
      posed_(robot_, joints, T_world_root, where),
      positions_(joints.size()) {
  jaws_.resize(joints.size());
  placed_.resize(robot_.links.size());
  around_.resize(robot_.links.size());
  links_.resize(robot_.links.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    const Mesh& body = robot_.body(i);
    link.has_body = !body.vertices.empty();
    if (link.has_body) link.body = capsule_around(body);
    link.moves = posed_.moves(i);
  }
  surround({.workspace = {}, .obstacles = {}, .clearance = clearance});
}

void RobotShape::surround(const Surroundings& surroundings) {
  surroundings_ = surroundings;
  const double clearance = surroundings.clearance;
  if (!near_ || near_->clearance != clearance) near_ = NearCouples::of({robot_, joints_, jaws_, posed_}, clearance);
  couples_.clear();
  const auto link_name = [this](std::size_t i) { return "link '" + robot_.links[i].name + "'"; };
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (!links_[i].has_body || !links_[i].moves) continue;
    if (!surroundings_.workspace.isEmpty())
      couples_.push_back({Against::workspace, i, 0, 0, link_name(i) + " leaves the workspace"});
    for (std::size_t k = 0; k < surroundings_.obstacles.size(); ++k)
      couples_.push_back({Against::obstacle, i, k, clearance,
                          link_name(i) + " comes too close to obstacle '" + surroundings_.obstacles[k].name + "'"});
  }
  const auto too_close = [&](std::size_t i, std::size_t k) {
    return link_name(i) + " comes too close to " + link_name(k);
  };
  for (const auto& [i, k] : near_->far) couples_.push_back({Against::link, i, k, clearance, too_close(i, k)});
  for (std::size_t n = 0; n < near_->couples.size(); ++n) {
    const NearCouples::Couple& near = near_->couples[n];
    couples_.push_back({Against::near_link, near.link, n, near.apart.kept(), too_close(near.link, near.other)});
  }
}

void RobotShape::pose(std::span<const double> positions) noexcept {
  std::copy_n(positions.begin(), positions_.size(), positions_.begin());
  posed_.pose(positions);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Pose& T = posed_.T_world_link(i);
    const Capsule& body = placed_[i] = {T * links_[i].body.a, T * links_[i].body.b, links_[i].body.radius};
    around_[i] = {0.5 * (body.a + body.b), 0.5 * (body.a - body.b).norm() + body.radius};
  }
}

// By balls around the bodies; what this leaves open, margin() decides. That takes half of a step off what it samples of
// the distance to a box.
bool RobotShape::surely_clear(const Couple& couple) const noexcept {
  const Ball& ball = around_[couple.link];
  const auto beyond = [&](double squared_distance, double other) {
    const double kept = ball.radius + other + surroundings_.clearance;
    return squared_distance > kept * kept;
  };
  switch (couple.what) {
    case Against::workspace:
    case Against::near_link: return false;  // as quick by themselves
    case Against::obstacle: {
      const double step = (ball.radius - placed_[couple.link].radius) / kSamples;
      return beyond(surroundings_.obstacles[couple.other].box.squaredExteriorDistance(ball.middle), step);
    }
    case Against::link: {
      const Ball& other = around_[couple.other];
      return beyond((ball.middle - other.middle).squaredNorm(), other.radius);
    }
  }
  return false;
}

double RobotShape::margin(const Couple& couple) const noexcept {
  const Capsule& body = placed_[couple.link];
  switch (couple.what) {
    case Against::workspace: {
      const Eigen::AlignedBox3d& space = surroundings_.workspace;
      const Eigen::Vector3d low = body.a.cwiseMin(body.b) - space.min(), high = space.max() - body.a.cwiseMax(body.b);
      return std::min(low.minCoeff(), high.minCoeff()) - body.radius;
    }
    case Against::obstacle: return distance(body, surroundings_.obstacles[couple.other].box) - couple.kept;
    case Against::link: return distance(body, placed_[couple.other]) - couple.kept;
    case Against::near_link: return near_->couples[couple.other].apart.margin(positions_);
  }
  return 0;
}

void RobotShape::margins(std::span<const double> positions, std::span<double> out) noexcept {
  pose(positions);
  for (std::size_t i = 0; i < couples_.size(); ++i) out[i] = margin(couples_[i]);
}

void RobotShape::margins_by_meshes(std::span<const double> positions, std::span<double> out) noexcept {
  margins(positions, out);
  for (std::size_t i = 0; i < couples_.size(); ++i)
    if (const Couple& couple = couples_[i]; couple.what == Against::near_link && out[i] >= 0)
      out[i] = std::max(0.0, near_->distance(near_->couples[couple.other], posed_) - couple.kept);
}

std::optional<std::size_t> RobotShape::too_close(std::span<const double> positions) noexcept {
  pose(positions);
  std::optional<std::size_t> out;
  double least = 0;
  for (std::size_t i = 0; i < couples_.size(); ++i) {
    if (surely_clear(couples_[i])) continue;
    const double here = margin(couples_[i]);
    if (here >= least) continue;
    least = here;
    out = i;
  }
  return out;
}

std::vector<GuardedLink> RobotShape::guarded(std::span<const double> positions) {
  pose(positions);
  std::vector<GuardedLink> out;
  for (std::size_t i = 0; i < links_.size(); ++i)
    if (links_[i].has_body) out.push_back({robot_.links[i].name, placed_[i], links_[i].moves});
  return out;
}

const char* RobotShape::obstructed(std::span<const double> positions) noexcept {
  pose(positions);
  for (const Couple& couple : couples_)
    if (margin(couple) < 0) return couple.message.c_str();
  return nullptr;
}

}  // namespace foresight
