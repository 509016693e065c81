#include "scene/lod/level_director.hpp"

#include <algorithm>
#include <cmath>

#include "scene/lod/box_outline.hpp"

namespace foresight {
namespace {

constexpr double kBackWithin = 1;       // s
constexpr double kMovedImportance = 2;  // of what does not stand where it did: most likely it is being worked with
constexpr double kInside = 0.1;         // of a box's diagonal: how far its surface is where the eye is inside
constexpr double kClosest = 0.05;       // m
constexpr double kAcuityTime = 0.4;     // s
constexpr double kInvisible = 0.1;      // of the allowed error

bool is_usable(const LevelView& view) {
  return view.T_world_camera.matrix().allFinite() && std::isfinite(view.focal_px) && view.focal_px > 0 &&
         std::isfinite(view.seconds);
}

/// How far the view's middle line goes until it meets the box; nothing where it does not, or starts within.
std::optional<double> met_at(const Eigen::AlignedBox3d& box, const Pose& T_node_camera) {
  const Eigen::Vector3d eye = T_node_camera.translation(), ahead = T_node_camera.linear().col(2);
  double enters = 0, leaves = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min()[axis] - eye[axis]) / ahead[axis], b = (box.max()[axis] - eye[axis]) / ahead[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  if (!(enters > 0 && enters <= leaves)) return std::nullopt;
  return enters;
}

}  // namespace

LevelDirector::LevelDirector(std::shared_ptr<const SceneLevels> scene, const LevelSettings& settings)
    : scene_(std::move(scene)),
      settings_(settings),
      walk_(scene_->nodes().size(), settings.transition, settings.seconds),
      cost_(settings.cost),
      tolerance_(settings.px),
      history_(scene_->nodes().size()) {
  plan_.transition = settings.transition;
  plan_.blends.resize(scene_->nodes().size());
}

const LevelPlan& LevelDirector::plan(const LevelView& view, const SceneState& state, const std::vector<bool>& seen) {
  ++counts_.frames;
  plan_.is_usable_view = is_usable(view);
  if (!plan_.is_usable_view || settings_.rule == LevelRule::full) {
    draw_all_in_full(seen);
    return plan_;
  }
  const double elapsed = last_ ? view.seconds - *last_ : 0;
  last_ = view.seconds;
  walk_.step(elapsed);
  gaze_distance_.reset();
  nodes_.clear();
  for (std::size_t n = 0; n < seen.size(); ++n) {
    if (!seen[n] || scene_->nodes()[n].levels.empty()) continue;
    nodes_.push_back(n);
    const auto met = met_at(scene_->boxes().box[n], state.T_world_node[n].inverse() * view.T_world_camera);
    if (met && (!gaze_distance_ || *met < *gaze_distance_)) gaze_distance_ = met;
  }
  std::vector<LevelCandidate> candidates;
  candidates.reserve(nodes_.size());
  for (const std::size_t n : nodes_) candidates.push_back(candidate(n, view, state.T_world_node[n], elapsed));
  const std::vector<int> goals = choose(candidates);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (candidates[i].last >= 0 && candidates[i].last != goals[i])
      note_change(nodes_[i], candidates[i].last, goals[i], view.seconds);
    walk_.aim(static_cast<int>(nodes_[i]), goals[i]);
  }
  plan_.work = {};
  for (const std::size_t n : nodes_) {
    const FrameWork work = node_work(n);
    plan_.work.triangles += work.triangles;
    plan_.work.nodes += work.nodes;
  }
  if (settings_.rule == LevelRule::predictive) cut_short(candidates);
  for (const std::size_t n : nodes_) plan_.blends[n] = walk_.blend(static_cast<int>(n));
  plan_.expected_ms = cost_.expected(plan_.work);
  return plan_;
}

void LevelDirector::took(const FrameWork& work, double ms) {
  cost_.took(work, ms);
  tolerance_.took(ms, settings_.budget_ms);
}

LevelCandidate LevelDirector::candidate(std::size_t node, const LevelView& view, const Pose& T_world_node,
                                        double elapsed) {
  const Eigen::AlignedBox3d& box = scene_->boxes().box[node];
  const Pose T_node_camera = T_world_node.inverse() * view.T_world_camera;
  const Eigen::Vector3d eye = T_node_camera.translation();
  LevelCandidate out;
  out.errors = scene_->errors(node);
  out.triangles = scene_->triangles(node);
  out.last = walk_.is_known(static_cast<int>(node)) ? walk_.goal(static_cast<int>(node)) : -1;
  out.importance = T_world_node.isApprox(scene_->boxes().T_world_rest[node], 1e-9) ? 1 : kMovedImportance;

  const SeenSize size = seen_size(box, eye);
  const double nearest =
      std::max(box.contains(eye) ? kInside * box.diagonal().norm() : box.exteriorDistance(eye), kClosest);
  out.area_px = size.area * view.focal_px * view.focal_px;
  out.px_per_m = view.focal_px * std::min(std::sqrt(size.share), 1 / nearest);

  const Eigen::Vector3d direction = (T_world_node * box.center() - view.T_world_camera.translation()).normalized();
  History& history = history_[node];
  if (settings_.looks_ahead()) {
    SeenMotion seen;
    const double ahead = direction.dot(view.T_world_camera.linear().col(2));
    // Its nearest side counts: large things reach into the middle.
    const double reach = std::atan2(box.diagonal().norm() / 2, (box.center() - eye).norm());
    seen.eccentricity = std::max(0.0, std::acos(std::clamp(ahead, -1.0, 1.0)) - reach);
    if (elapsed > 0 && !history.direction.isZero())
      seen.speed = std::acos(std::clamp(direction.dot(history.direction), -1.0, 1.0)) / elapsed;
    seen.distance = nearest;
    seen.gaze_distance = gaze_distance_;
    // What an eye sees does not come and go from frame to frame.
    const double now = acuity(seen, settings_.acuity);
    const double kept = history.direction.isZero() || !(elapsed > 0) ? 0 : std::exp(-elapsed / kAcuityTime);
    history.acuity = kept * history.acuity + (1 - kept) * now;
    out.acuity = history.acuity;
  }
  history.direction = direction;
  return out;
}

std::vector<int> LevelDirector::choose(const std::vector<LevelCandidate>& candidates) const {
  if (settings_.rule == LevelRule::predictive) {
    BudgetRule rule;
    rule.px = settings_.px;
    rule.invisible_px = kInvisible * settings_.px;
    rule.hysteresis = settings_.hysteresis;
    rule.ms_per_triangle = cost_.ms_per_triangle();
    rule.ms_per_node = cost_.ms_per_node();
    rule.budget_ms = settings_.budget_ms - cost_.margin() - cost_.base_ms();
    return levels_within_budget(candidates, rule);
  }
  std::vector<int> out;
  const double px = settings_.rule == LevelRule::reactive ? tolerance_.px() : settings_.px;
  for (const LevelCandidate& node : candidates) out.push_back(coarsest_within(node, px, settings_.hysteresis));
  return out;
}

void LevelDirector::note_change(std::size_t node, int from, int to, double seconds) {
  const int direction = to > from ? 1 : -1;
  History& history = history_[node];
  ++counts_.changes;
  if (history.direction_of_change == -direction && seconds - history.changed <= kBackWithin) ++counts_.reversals;
  history.direction_of_change = direction;
  history.changed = seconds;
}

/// A node on the way to a coarser level still costs what the finer one does. Where that is too much, those arrive at
/// once of which it will be noticed least.
void LevelDirector::cut_short(const std::vector<LevelCandidate>& candidates) {
  const double most = settings_.budget_ms - cost_.margin();
  if (cost_.expected(plan_.work) <= most) return;
  struct Way {
    double jump;
    std::size_t node;
  };
  std::vector<Way> ways;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const int node = static_cast<int>(nodes_[i]);
    if (!walk_.is_on_the_way(node)) continue;
    const auto at = [&](int level) { return candidates[i].errors[static_cast<std::size_t>(level)]; };
    const int now = walk_.blend(node).level, goal = walk_.goal(node);
    if (goal <= now) continue;
    ways.push_back({(at(goal) - at(now)) * candidates[i].px_per_m * std::sqrt(candidates[i].area_px), nodes_[i]});
  }
  std::ranges::sort(ways, {}, &Way::jump);
  for (const Way& way : ways) {
    if (cost_.expected(plan_.work) <= most) return;
    const FrameWork before = node_work(way.node);
    walk_.arrive(static_cast<int>(way.node));
    const FrameWork after = node_work(way.node);
    plan_.work.triangles += after.triangles - before.triangles;
    plan_.work.nodes += after.nodes - before.nodes;
    ++counts_.cut_short;
  }
}

FrameWork LevelDirector::node_work(std::size_t node) const {
  const LevelBlend blend = walk_.blend(static_cast<int>(node));
  const auto triangles = scene_->triangles(node);
  FrameWork out{static_cast<double>(triangles[static_cast<std::size_t>(blend.level)]), 1};
  if (blend.share > 0 && settings_.transition == LevelTransition::fade) {
    out.triangles += static_cast<double>(triangles[static_cast<std::size_t>(blend.level) + 1]);
    out.nodes = 2;
  }
  return out;
}

void LevelDirector::draw_all_in_full(const std::vector<bool>& seen) {
  plan_.work = {};
  for (std::size_t n = 0; n < scene_->nodes().size(); ++n) {
    plan_.blends[n] = {};
    if (n >= seen.size() || !seen[n] || scene_->nodes()[n].levels.empty()) continue;
    plan_.work.triangles += static_cast<double>(scene_->triangles(n)[0]);
    ++plan_.work.nodes;
  }
  plan_.expected_ms = cost_.expected(plan_.work);
}

}  // namespace foresight
