#include "prediction/contact/contact_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "common/error.hpp"
#include "common/rotation.hpp"

namespace foresight {
namespace {

// No point of either box is nearer to the other than this.
double gap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return (b.min() - a.max()).cwiseMax(a.min() - b.max()).cwiseMax(0).norm();
}

Eigen::AlignedBox3d turned(const Eigen::AlignedBox3d& box, const Pose& T) {
  const Eigen::Vector3d center = T * box.center(), half = T.linear().cwiseAbs() * (0.5 * box.sizes());
  return {center - half, center + half};
}

}  // namespace

ContactModel::ContactModel(const UrdfRobot& robot, const std::vector<std::string>& joints, const SceneModel* scene,
                           const Pose& T_world_root, const std::string& where)
    : links_(robot, joints, T_world_root, where) {
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    add_part(robot.links[i].name, robot.body(i), static_cast<int>(i), -1);
  if (parts_.empty())
    throw InputError(where, "no link of the robot has a shape: what touches cannot be known",
                     "give its links <collision> or <visual> elements");
  if (scene) {
    T_world_rest_ = scene->rest_poses();
    for (std::size_t i = 0; i < scene->nodes().size(); ++i) {
      const Node& node = scene->nodes()[i];
      if (std::ranges::none_of(robot.links, [&](const Node& link) { return link.name == node.name; }))
        add_part(node.name, node.mesh, -1, static_cast<int>(i));
    }
  }
  T_world_node_ = T_world_rest_;
  make_couples();
  leave_out_what_always_overlaps(robot, joints);
  make_couples();
  valid_ = false;
}

void ContactModel::add_part(std::string name, const Mesh& mesh, int link, int node) {
  ContactMesh shape(mesh);
  if (shape.left_out() > 0)
    remarks_.push_back(name + ": " + std::to_string(shape.left_out()) + " triangles without area are left out");
  if (shape.triangles() == 0) {
    if (link >= 0) remarks_.push_back(name + " has no shape: it touches nothing");
    return;
  }
  parts_.push_back({std::move(name), std::move(shape), link, node, {}, {}, {}, {}, {}});
  parts_.back().T_link_part.setIdentity();
}

bool ContactModel::holds(const Part& holder, const Part& carried) const {
  if (carried.node < 0 || carried.link < 0 || holder.link < 0) return false;
  if (std::ranges::find(carried.holding, static_cast<std::size_t>(holder.link)) != carried.holding.end()) return true;
  const auto link = static_cast<std::size_t>(carried.link), held_by = static_cast<std::size_t>(holder.link);
  return links_.common_ancestor(link, held_by) == link;  // the link, what hangs on it, what it carries besides
}

ContactModel::Couple ContactModel::couple_of(std::size_t one, std::size_t other) const {
  const Part &a = parts_[one], &b = parts_[other];
  if (b.link < 0) return {one, other, links_.joints_between(static_cast<std::size_t>(a.link), -1), {}};
  const auto link = static_cast<std::size_t>(a.link), other_link = static_cast<std::size_t>(b.link);
  const int common = static_cast<int>(links_.common_ancestor(link, other_link));
  return {one, other, links_.joints_between(link, common), links_.joints_between(other_link, common)};
}

void ContactModel::make_couples() {
  ++arrangement_;
  couples_.clear();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].link < 0) continue;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      if (k == i || (parts_[k].link >= 0 && k > i)) continue;
      if (holds(parts_[i], parts_[k]) || holds(parts_[k], parts_[i])) continue;
      if (std::ranges::find(left_out_, std::array{i, k}) != left_out_.end()) continue;
      Couple couple = couple_of(i, k);
      std::vector<int> moved_by;
      for (const auto* path : {&couple.path, &couple.other_path})
        for (const std::size_t joint : *path)
          if (links_.input_of(joint) >= 0) moved_by.push_back(links_.input_of(joint));
      std::ranges::sort(moved_by);
      const auto repeated = std::ranges::unique(moved_by);
      const auto different = static_cast<std::size_t>(repeated.begin() - moved_by.begin());
      if (different >= (parts_[k].link < 0 ? 1U : 2U)) couples_.push_back(std::move(couple));
    }
  }
}

// Neighbours by construction that joints_between cannot tell: covers that reach over a joint, a base in its table.
void ContactModel::leave_out_what_always_overlaps(const UrdfRobot& robot, const std::vector<std::string>& joints) {
  constexpr int kSamples = 64;
  std::vector<bool> always(couples_.size(), true);
  std::uint64_t state = 1;
  std::vector<double> q(joints.size());
  for (int sample = 0; sample < kSamples; ++sample) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;  // Knuth's MMIX
      const auto joint = std::ranges::find(robot.joints, joints[i], &UrdfJoint::name);
      if (joint == robot.joints.end()) continue;
      const double low = std::max(joint->lower, -3.1416), high = std::min(joint->upper, 3.1416);
      q[i] = low + (high - low) * static_cast<double>(state >> 11) * 0x1p-53;
    }
    move(q);
    bool any = false;
    for (std::size_t i = 0; i < couples_.size(); ++i) any = (always[i] = always[i] && touch(couples_[i])) || any;
    if (!any) return;
  }
  for (std::size_t i = 0; i < couples_.size(); ++i) {
    if (!always[i]) continue;
    left_out_.push_back({couples_[i].one, couples_[i].other});
    always_.push_back(name(i) + " and " + other_name(i));
  }
}

void ContactModel::attach(std::size_t node, std::size_t link, const Pose& T_link_node,
                          std::span<const std::size_t> holding) {
  const auto part = std::ranges::find(parts_, static_cast<int>(node), &Part::node);
  if (part == parts_.end()) throw std::invalid_argument("no node of the scene with triangles to attach");
  if (link >= links_.size()) throw std::invalid_argument("no such link to attach to");
  if (!is_rigid(T_link_node)) throw std::invalid_argument("no pose to attach at");
  part->link = static_cast<int>(link);
  part->T_link_part = T_link_node;
  part->holding.assign(holding.begin(), holding.end());
  make_couples();
  if (valid_) place();
}

void ContactModel::detach(std::size_t node) {
  const auto part = std::ranges::find(parts_, static_cast<int>(node), &Part::node);
  if (part == parts_.end() || part->link < 0) return;
  part->link = -1;
  part->holding.clear();
  make_couples();
  if (valid_) place();
}

const char* ContactModel::pose(std::span<const double> positions, std::span<const Pose> T_world_node) {
  valid_ = false;
  if (T_world_node.empty()) T_world_node = T_world_rest_;
  if (T_world_node.size() != T_world_rest_.size()) return "not one pose for each node of the scene";
  for (const Part& part : parts_)
    if (part.link < 0 && !is_rigid(T_world_node[static_cast<std::size_t>(part.node)]))
      return "a node of the scene has no finite rigid pose";
  T_world_node_.assign(T_world_node.begin(), T_world_node.end());
  return move(positions);
}

const char* ContactModel::move(std::span<const double> positions) {
  valid_ = false;
  if (positions.size() != joints()) return "not one position for each joint";
  if (!std::ranges::all_of(positions, [](double q) { return std::isfinite(q); })) return "a joint without a position";
  links_.pose(positions);
  place();
  valid_ = true;
  return nullptr;
}

void ContactModel::place() {
  for (Part& part : parts_) {
    part.T_world = part.link < 0 ? T_world_node_[static_cast<std::size_t>(part.node)]
                                 : links_.T_world_link(static_cast<std::size_t>(part.link)) * part.T_link_part;
    part.box = turned(part.mesh.box(), part.T_world);
    part.center = part.T_world * part.mesh.box().center();
  }
}

// Before any tree is entered: by boxes in the world, and each part's ball against the other's own box.
double ContactModel::at_least(const Couple& couple) const {
  const Part &a = parts_[couple.one], &b = parts_[couple.other];
  const auto ball_to_box = [](const Part& ball, const Part& box) {
    const Eigen::Vector3d center = box.T_world.inverse(Eigen::Isometry) * ball.center;
    return box.mesh.box().exteriorDistance(center) - ball.mesh.radius();
  };
  const double apart = gap(a.box, b.box);
  return std::max({apart, ball_to_box(a, b), ball_to_box(b, a)});
}

bool ContactModel::touch(const Couple& couple) const {
  const Part &a = parts_[couple.one], &b = parts_[couple.other];
  return at_least(couple) <= 0 && ContactMesh::touch(a.mesh, a.T_world, b.mesh, b.T_world);
}

std::vector<std::size_t> ContactModel::touching() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; valid_ && i < couples_.size(); ++i)
    if (touch(couples_[i])) out.push_back(i);
  return out;
}

std::optional<Nearness> ContactModel::nearest(std::size_t index, double within) {
  Couple& couple = couples_[index];
  const Part &a = parts_[couple.one], &b = parts_[couple.other];
  const auto found = ContactMesh::nearest(a.mesh, a.T_world, b.mesh, b.T_world, within, couple.hint);
  if (!found) return std::nullopt;
  couple.hint = found->triangles;
  Nearness out{index, found->distance, found->point, found->other_point, Eigen::Vector3d::Zero()};
  if (out.distance > 0) out.direction = (out.point - out.other_point).normalized();
  return out;
}

std::vector<Nearness> ContactModel::near(double within) {
  std::vector<Nearness> out;
  for (std::size_t i = 0; valid_ && i < couples_.size(); ++i) {
    if (at_least(couples_[i]) >= within) continue;
    if (const auto found = nearest(i, within)) out.push_back(*found);
  }
  std::ranges::stable_sort(out, {}, &Nearness::distance);
  return out;
}

std::optional<Nearness> ContactModel::least(double within) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; valid_ && i < couples_.size(); ++i)
    if (const double bound = at_least(couples_[i]); bound < within) order.emplace_back(bound, i);
  std::ranges::sort(order);
  std::optional<Nearness> best;
  for (const auto& [bound, i] : order) {
    if (bound >= within) break;
    const auto found = nearest(i, within);
    if (!found) continue;
    best = found;
    within = best->distance;
    if (within <= 0) break;
  }
  return best;
}

Penetration ContactModel::penetration(std::size_t couple) const {
  if (!valid_ || !touch(couples_[couple])) return {};
  const Part &a = parts_[couples_[couple].one], &b = parts_[couples_[couple].other];
  std::vector<Eigen::Vector3d> ways;
  const auto add = [&](const Eigen::Vector3d& way) {
    const bool known = std::ranges::any_of(ways, [&](const Eigen::Vector3d& w) { return w.dot(way) > 0.98; });
    if (!known && ways.size() < 24) ways.push_back(way);
  };
  for (const TrianglePair& pair : ContactMesh::crossing(a.mesh, a.T_world, b.mesh, b.T_world, 64))
    for (const Eigen::Vector3d& normal : {Eigen::Vector3d(b.T_world.linear() * b.mesh.normal(pair[1])),
                                          Eigen::Vector3d(a.T_world.linear() * a.mesh.normal(pair[0]))}) {
      add(normal);
      add(-normal);
    }
  const auto free = [&](const Eigen::Vector3d& way, double length) {
    Pose T = a.T_world;
    T.translation() += length * way;
    return !ContactMesh::touch(a.mesh, T, b.mesh, b.T_world);
  };
  constexpr double kExact = 5e-6;
  double low = 0;
  for (double high = 1e-5; high <= kDeepest; low = high, high *= 2) {
    Penetration best{high, Eigen::Vector3d::Zero()};
    for (const Eigen::Vector3d& way : ways) {
      if (!free(way, best.depth)) continue;
      double still = low;
      while (best.depth - still > kExact) {
        const double middle = 0.5 * (still + best.depth);
        (free(way, middle) ? best.depth : still) = middle;
      }
      best.direction = way;
    }
    if (!best.direction.isZero()) return best;
  }
  return {kDeepest, Eigen::Vector3d::Zero()};
}

std::vector<double> ContactModel::change_of(const Nearness& nearness, const Eigen::Vector3d& direction) const {
  std::vector<double> out(joints(), 0);
  const Couple& couple = couples_[nearness.couple];
  links_.add_change(couple.path, nearness.point, direction, 1, out);
  links_.add_change(couple.other_path, nearness.other_point, direction, -1, out);
  return out;
}

double ContactModel::farthest(std::size_t index, std::span<const double> change) const noexcept {
  const Couple& couple = couples_[index];
  const Part &a = parts_[couple.one], &b = parts_[couple.other];
  double way = links_.farthest(couple.path, a.center, a.mesh.radius(), change);
  if (!couple.other_path.empty()) way += links_.farthest(couple.other_path, b.center, b.mesh.radius(), change);
  return way;
}

double ContactModel::farthest(std::span<const double> change) const {
  std::vector<double> ways(parts_.size(), 0);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].link >= 0)
      ways[i] = links_.farthest(links_.joints_between(static_cast<std::size_t>(parts_[i].link), -1), parts_[i].center,
                                parts_[i].mesh.radius(), change);
  double most = 0;
  for (const Couple& couple : couples_) most = std::max(most, ways[couple.one] + ways[couple.other]);
  return most;
}

void ContactModel::forget() noexcept {
  for (Couple& couple : couples_) couple.hint = {-1, -1};
}

}  // namespace foresight
