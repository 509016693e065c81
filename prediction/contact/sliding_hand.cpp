#include "prediction/contact/sliding_hand.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/rotation.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr int kMostParts = 48;          // of the way of a picture
constexpr int kHalvings = 5;            // of a part that turned out too long
constexpr double kLeastShare = 1e-3;    // of a step along surfaces: less is standing
constexpr double kLeastAdvance = 0.02;  // of what is left of a way straight ahead: less is left to steps along surfaces
constexpr double kClose = 3 * kSkin;    // nearer than this, parts may be longer than the distance, and are checked
constexpr double kDrift = 1e-5;         // m that a part may come nearer than the skin
constexpr double kDepthExact = 2e-5;    // m to which depths are compared
constexpr double kGateNear = 0.03;      // m of margin within which the gate's couples close ways
constexpr double kUnmoved = 1e-5;       // rad or m that a step changes once the tool is as near as it gets
constexpr double kDamping = 1e-4;       // of bounded_step, where 1 rad of the joints moves the tool by about 1
constexpr double kThere = 1e-4;         // m and rad from the hand that need no reason
constexpr double kTurnLess = 4;  // by how much more turning weighs than in the open: tools do not twist to get deeper
constexpr double kTurnSecond = 0.02;  // of that, for arms that cannot choose how their tool is turned
constexpr double kSideways = 0.5;     // of what is pushed: the most that the way out may go up or down
constexpr double kGhostAhead = 0.002, kGhostTurned = 0.0175;  // from which on the ghost is shown

GhostReason ghost_reason(FollowReason reason) {
  switch (reason) {
    case FollowReason::none: return GhostReason::none;
    case FollowReason::joint_speed: return GhostReason::joint_speed;
    case FollowReason::joint_limit: return GhostReason::joint_limit;
    case FollowReason::singularity: return GhostReason::singularity;
    case FollowReason::out_of_reach: return GhostReason::out_of_reach;
    case FollowReason::few_joints: return GhostReason::few_joints;
    case FollowReason::other_branch: return GhostReason::other_branch;
    case FollowReason::contact: return GhostReason::contact;
    case FollowReason::unknown: return GhostReason::unknown;
    case FollowReason::bad_target: return GhostReason::bad_target;
  }
  return GhostReason::unknown;
}

std::vector<double> times(double share, const std::vector<double>& change) {
  std::vector<double> out(change);
  for (double& x : out) x *= share;
  return out;
}

bool same(std::span<const Pose> a, std::span<const Pose> b) {
  return std::ranges::equal(a, b, [](const Pose& s, const Pose& t) { return s.matrix() == t.matrix(); });
}

}  // namespace

const char* name_of(GhostReason reason) noexcept {
  switch (reason) {
    case GhostReason::none: return "none";
    case GhostReason::contact: return "contact";
    case GhostReason::gate: return "too close for the robot";
    case GhostReason::joint_speed: return "joint speed";
    case GhostReason::joint_limit: return "joint limit";
    case GhostReason::singularity: return "singularity";
    case GhostReason::out_of_reach: return "out of reach";
    case GhostReason::few_joints: return "too few joints";
    case GhostReason::other_branch: return "other branch";
    case GhostReason::bad_target: return "bad target";
    case GhostReason::unknown: return "unknown";
  }
  return "";
}

// What is near where the joints are.
struct SlidingHand::Look {
  double within = 0;  // all couples that are nearer are in `near`, but those that give way
  std::vector<Nearness> near;
  std::map<std::size_t, Penetration> deep;  // of those that touch
  std::vector<double> margins;              // the gate's
  std::vector<Nearness> pushed;             // what gives way, the nearest first

  double distance(std::size_t couple) const {
    const auto found = std::ranges::find(near, couple, &Nearness::couple);
    return found == near.end() ? within : found->distance;
  }
  Eigen::Vector3d direction(const Nearness& n) const {
    return n.distance > 0 ? n.direction : deep.at(n.couple).direction;
  }
};

SlidingHand::SlidingHand(ContactModel& model, const InverseKinematics& kinematics,
                         const std::vector<std::string>& joints, std::span<const double> start,
                         const Pose& T_world_base, RobotShape* gate, const std::string& where)
    : model_(model),
      kinematics_(kinematics),
      T_world_base_(T_world_base),
      gate_(gate),
      follower_(kinematics, {}),
      positions_(start.begin(), start.end()) {
  if (start.size() != model.joints() || joints.size() != model.joints() ||
      !std::ranges::all_of(start, [](double q) { return std::isfinite(q); }))
    throw InputError(where, "there is not one finite position for each joint", "say where every joint is");
  for (const ArmJoint& joint : kinematics.chain().joints()) {
    const auto at = std::ranges::find(joints, joint.name);
    if (at == joints.end())
      throw InputError(where, "joint " + in_quotes(joint.name) + " of the arm is not among those that contact is for",
                       "name all joints between base and tip");
    arm_.push_back(static_cast<std::size_t>(at - joints.begin()));
  }
  follower_.stand_at(joints_of(positions_, arm_));
  const JointVector& q = follower_.joints();
  for (std::size_t i = 0; i < arm_.size(); ++i) positions_[arm_[i]] = q[static_cast<Eigen::Index>(i)];
}

std::vector<double> SlidingHand::spread(const JointVector& change) const {
  std::vector<double> out(positions_.size(), 0);
  for (std::size_t i = 0; i < arm_.size(); ++i) out[arm_[i]] = change[static_cast<Eigen::Index>(i)];
  return out;
}

SlidingHand::Look SlidingHand::look(double within) {
  Look now;
  now.within = std::min(within, kContactReach);
  now.near = model_.near(now.within);
  for (const Nearness& n : now.near)
    if (n.distance <= 0) now.deep[n.couple] = model_.penetration(n.couple);
  for (const Nearness& n : now.near)
    if (gives_way(n, now)) now.pushed.push_back(n);
  if (!now.pushed.empty()) std::erase_if(now.near, [&](const Nearness& n) { return gives_way(n, now); });
  if (gate_) {
    now.margins.resize(gate_->couples());
    gate_->margins(positions_, now.margins);
  }
  return now;
}

bool SlidingHand::gives_way(const Nearness& near, const Look& now) const {
  if (!pushes_ || std::ranges::find(pushed_, model_.parts_of(near.couple)[1]) == pushed_.end()) return false;
  const Eigen::Vector3d out = now.direction(near);
  if (out.isZero() || std::abs(out.z()) > kSideways) return false;
  return near.distance > 0 || now.deep.at(near.couple).depth <= kPushDepth;
}

// What came to the arm may touch it as deep as it does; what the arm goes into may not, by no small step either.
void SlidingHand::settle_depths(Look& now, std::span<const Pose> T_world_node) {
  if (arrangement_ != model_.arrangement() || !same(nodes_, T_world_node)) depths_.clear();
  arrangement_ = model_.arrangement();
  nodes_.assign(T_world_node.begin(), T_world_node.end());
  std::map<std::size_t, double> depths;
  for (const auto& [couple, deep] : now.deep) {
    const auto before = depths_.find(couple);
    const bool pushed = std::ranges::find(pushed_, model_.parts_of(couple)[1]) != pushed_.end();
    depths[couple] = pushed || before == depths_.end() ? deep.depth : std::min(before->second, deep.depth);
  }
  depths_ = std::move(depths);
}

// How much of a change of joints may be gone at once, by what is near.
double SlidingHand::allowed(const Look& now, std::span<const double> change, double drift) const {
  double share = 1;
  const double most = model_.farthest(change), room = now.within - kSkin;
  if (most > room) share = room / most;
  for (const Nearness& n : now.near) {
    const double way = model_.farthest(n.couple, change);
    if (way <= 0) continue;
    if (n.distance > kClose) {
      share = std::min(share, (n.distance - kSkin) / way);
      continue;
    }
    const double after = n.distance > kLeastSkin ? 0.7 * std::min(n.distance, kSkin) : kSkin;
    share = std::min(share, 0.9 * (n.distance + after) / way);
    const std::vector<double> row = model_.change_of(n, now.direction(n));
    double nearing = 0;
    for (std::size_t i = 0; i < row.size(); ++i) nearing -= row[i] * change[i];
    if (nearing > 0) share = std::min(share, (std::max(n.distance - kSkin, 0.0) + drift) / nearing);
  }
  return share;
}

// Did nothing meet on the way? A point that met a surface came from `before`'s distance and went on to `after`'s: its
// way was no shorter than both together. Parts closer than the arm ever goes came to it, as what was grasped off a
// table: by that rule they could not part again. They do not get nearer (`allowed`), and no part of a way passes a
// skin.
bool SlidingHand::clear(const Look& before, const Look& after, std::span<const double> change) const {
  for (const auto* look : {&before, &after})
    for (const Nearness& n : look->near) {
      const double from = before.distance(n.couple), to = after.distance(n.couple);  // or at least so much
      if (from > 0) {
        if (to < std::min(from, kLeastSkin)) return false;
        if (from > kLeastSkin && model_.farthest(n.couple, change) >= from + to) return false;
      } else if (to <= 0) {
        const Penetration& deep = after.deep.at(n.couple);
        const auto may = depths_.find(n.couple);
        const bool judged = !deep.direction.isZero() && may != depths_.end();
        if (judged && deep.depth > may->second + kDepthExact) return false;
      }
    }
  for (std::size_t i = 0; i < after.margins.size(); ++i)
    if (after.margins[i] < (before.margins[i] >= 0 ? 0 : before.margins[i] - 1e-9)) return false;
  return true;
}

bool SlidingHand::go(const std::vector<double>& change, Look& now) {
  const std::vector<double> before = positions_;
  for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] += change[i];
  if (!model_.move(positions_)) {
    // Far enough for parts that grow, and no farther: looking far is what costs.
    Look after = look(std::max(2 * kClose, 4 * model_.farthest(change)));
    if (clear(now, after, change)) {
      now = std::move(after);
      return true;
    }
  }
  positions_ = before;
  model_.move(positions_);
  return false;
}

// `share` of the change, or half of it, and so on; returns what was gone, 0 where less than `least` would be left of
// it.
double SlidingHand::go_part(const std::vector<double>& change, double share, double least, Look& now) {
  for (int k = 0; k < kHalvings && share >= least; ++k, share *= 0.5) {
    ++parts_;
    if (go(times(share, change), now)) return share;
  }
  return 0;
}

// All of the change, or as much as is free: then false.
bool SlidingHand::advance(const std::vector<double>& change, Look& now) {
  std::vector<double> left = change;
  while (parts_ < kMostParts) {
    if (std::ranges::all_of(left, [](double x) { return x == 0; })) return true;
    const double share = go_part(left, allowed(now, left, 0), kLeastAdvance, now);
    if (share <= 0) return false;
    left = times(1 - share, left);
  }
  return false;
}

SlidingHand::ClosedWays SlidingHand::closed_ways(const Look& now) {
  ClosedWays out;
  std::vector<ClosedWay>& ways = out.ways;
  for (const Nearness& n : now.near) {
    if (ways.size() + 4 >= kMostClosedWays) break;  // four for the gate's
    const double least = n.distance > 0 ? kSkin - n.distance : 0;
    ways.push_back({joints_of(model_.change_of(n, now.direction(n)), arm_), least});
  }
  std::vector<std::pair<double, std::size_t>> tight;
  for (std::size_t i = 0; i < now.margins.size(); ++i)
    if (now.margins[i] < kGateNear) tight.emplace_back(now.margins[i], i);
  std::ranges::sort(tight);
  tight.resize(std::min<std::size_t>(tight.size(), kMostClosedWays - ways.size()));
  const std::size_t first = ways.size();
  for (const auto& [margin, couple] : tight) {
    out.of_gate.push_back(couple);
    ways.push_back({JointVector::Zero(static_cast<Eigen::Index>(arm_.size())), std::min(0.0, kDrift - margin)});
  }
  constexpr double kNudge = 1e-5;
  std::vector<double> nudged = positions_, margins(now.margins.size());
  for (std::size_t j = 0; !tight.empty() && j < arm_.size(); ++j) {
    nudged[arm_[j]] += kNudge;
    gate_->margins(nudged, margins);
    for (std::size_t k = 0; k < tight.size(); ++k)
      ways[first + k].row[static_cast<Eigen::Index>(j)] = (margins[tight[k].second] - tight[k].first) / kNudge;
    nudged[arm_[j]] = positions_[arm_[j]];
  }
  return out;
}

std::string SlidingHand::touch_words(std::size_t couple) const {
  return model_.name(couple) + " touches " + model_.other_name(couple);
}

// On what the last step leant hardest.
void SlidingHand::lean(const Look& now, const ClosedWays& closed) {
  leans_ = GhostReason::none;
  const auto hardest = std::ranges::max_element(closed.ways, {}, &ClosedWay::pressed);
  if (hardest == closed.ways.end() || !(hardest->pressed > 1e-9)) return;
  const auto index = static_cast<std::size_t>(hardest - closed.ways.begin());
  const std::size_t of_contact = closed.ways.size() - closed.of_gate.size();
  if (index < of_contact) {
    const Nearness& n = now.near[index];
    leans_ = GhostReason::contact;
    out_ = now.direction(n);
    words_ = touch_words(n.couple);
    return;
  }
  leans_ = GhostReason::gate;
  words_ = gate_->message(closed.of_gate[index - of_contact]);
}

// What gives way no more.
void SlidingHand::lean_on_pushed(const Look& now) {
  for (const Nearness& n : now.pushed) {
    if (n.distance > 0 || now.deep.at(n.couple).depth < 0.7 * kPushDepth) continue;
    leans_ = GhostReason::contact;
    out_ = now.direction(n);
    words_ = touch_words(n.couple);
    return;
  }
}

void SlidingHand::slide(const Pose& hand, double dt, const JointVector& start, Look& now) {
  const ArmChain& chain = kinematics_.chain();
  const DescentGoal goal{hand, false, kTurnLess * kinematics_.length()};
  const double turns = kinematics_.position_first() ? kTurnSecond : 1;
  while (parts_ < kMostParts) {
    const JointVector q = joints_of(positions_, arm_);
    JointVector lower = chain.lower() - q, upper = chain.upper() - q;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double room = chain.joints()[static_cast<std::size_t>(i)].velocity * dt * (1 - 1e-9);
      lower[i] = std::min(0.0, std::max(lower[i], start[i] - room - q[i]));
      upper[i] = std::max(0.0, std::min(upper[i], start[i] + room - q[i]));
    }
    TipChange change;
    Vector6 e = weighted_error(chain.tip_pose(q, change), goal);
    e.tail<3>() *= turns;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      change[i].head<3>() /= goal.length;
      change[i].tail<3>() *= turns;
    }
    ClosedWays closed = closed_ways(now);
    const JointVector dq = bounded_step(change, e, kDamping, lower, upper, closed.ways);
    lean(now, closed);
    if (dq.cwiseAbs().maxCoeff() < kUnmoved) return;
    const std::vector<double> wanted = spread(dq);
    if (go_part(wanted, allowed(now, wanted, kDrift), kLeastShare, now) <= 0) return;
  }
}

// The arm is taken to be within its limits, to the last bit.
void SlidingHand::settle_arm() {
  follower_.stand_at(joints_of(positions_, arm_));
  for (std::size_t i = 0; i < arm_.size(); ++i) positions_[arm_[i]] = follower_.joints()[static_cast<Eigen::Index>(i)];
}

bool SlidingHand::fits(std::span<const double> positions) const {
  return positions.size() == positions_.size() &&
         std::ranges::all_of(positions, [](double q) { return std::isfinite(q); });
}

bool SlidingHand::stand_at(std::span<const double> positions) {
  if (!fits(positions)) return false;
  positions_.assign(positions.begin(), positions.end());
  depths_.clear();
  settle_arm();
  return true;
}

// What a way that ended early ended at.
void SlidingHand::blame(const Look& now) {
  if (!now.near.empty() && now.near.front().distance < kClose) {
    const Nearness& n = now.near.front();
    leans_ = GhostReason::contact;
    out_ = now.direction(n);
    words_ = touch_words(n.couple);
    return;
  }
  const auto tightest = std::ranges::min_element(now.margins);
  if (tightest == now.margins.end() || *tightest > kGateNear) return;
  leans_ = GhostReason::gate;
  words_ = gate_->message(static_cast<std::size_t>(tightest - now.margins.begin()));
}

HandStep SlidingHand::unknown(const Pose& hand, std::string why) const {
  HandStep out;
  out.positions = positions_;
  out.T_base_tip = follower_.hand();
  out.ghost.shown = is_rigid(hand);
  if (out.ghost.shown) out.ghost.T_base_hand = hand;
  out.ghost.reason = out.ghost.shown ? GhostReason::unknown : GhostReason::bad_target;
  out.ghost.words = std::move(why);
  return out;
}

GhostHand SlidingHand::ghost(const Pose& hand, GhostReason otherwise) const {
  GhostHand out;
  out.T_base_hand = hand;
  const Vector6 left = pose_difference(follower_.hand(), hand);
  out.ahead = left.head<3>().norm();
  out.turned = left.tail<3>().norm();
  const bool turns = !kinematics_.position_first();  // else no ghost for what the arm cannot do: its words are enough
  out.shown = out.ahead > kGhostAhead || (turns && out.turned > kGhostTurned);
  const bool there = out.ahead < kThere && out.turned < kThere;
  out.reason = there ? GhostReason::none : leans_ != GhostReason::none ? leans_ : otherwise;
  if (out.reason == GhostReason::contact || out.reason == GhostReason::gate)
    out.words = words_;
  else if (out.reason != GhostReason::none)
    out.words = name_of(out.reason);
  if (out.reason == GhostReason::contact) {
    out.out = out_;
    out.depth = std::max(0.0, -out_.dot(T_world_base_.linear() * left.head<3>()));
  }
  return out;
}

HandStep SlidingHand::step(const Pose& hand, std::span<const double> others, std::span<const Pose> T_world_node,
                           double dt) {
  if (!fits(others)) return unknown(hand, "not one finite position for each joint");
  if (const char* why = model_.pose(positions_, T_world_node)) return unknown(hand, why);
  parts_ = 0;
  leans_ = GhostReason::none;
  const JointVector start = joints_of(positions_, arm_);
  const FollowStep follow = follower_.step(hand, dt);
  if (follow.reason == FollowReason::bad_target) return unknown(hand, "the hand has no finite rigid pose");

  std::vector<double> change(positions_.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = others[i] - positions_[i];
  for (const std::size_t i : arm_) change[i] = 0;
  const std::vector<double> way = spread(follow.q - start);
  // Nothing farther than the most that can be gone matters before the end.
  const double within = 2 * kClose + model_.farthest(change) + model_.farthest(way);
  pushes_ = false;
  Look now = look(within);
  settle_depths(now, T_world_node);
  advance(change, now);
  pushes_ = !pushed_.empty();
  if (pushes_) now = look(within);
  GhostReason reason = ghost_reason(follow.reason);
  if (!advance(way, now)) {
    slide(hand, dt, start, now);
    if (leans_ == GhostReason::none) lean_on_pushed(now);
    if (leans_ == GhostReason::none) reason = GhostReason::joint_speed;
  } else {  // without what rounding left of it
    for (std::size_t i = 0; i < arm_.size(); ++i) positions_[arm_[i]] = follow.q[static_cast<Eigen::Index>(i)];
  }
  if (!(joints_of(positions_, arm_) == follower_.joints())) settle_arm();
  HandStep out = finish(now);
  out.ghost = ghost(hand, reason);
  out.joint = out.ghost.reason == ghost_reason(follow.reason) ? follow.joint : -1;
  return out;
}

HandStep SlidingHand::go_to(std::span<const double> positions, std::span<const Pose> T_world_node) {
  if (!fits(positions)) return unknown(follower_.hand(), "not one finite position for each joint");
  if (const char* why = model_.pose(positions_, T_world_node)) return unknown(follower_.hand(), why);
  parts_ = 0;
  leans_ = GhostReason::none;
  std::vector<double> change(positions.begin(), positions.end());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= positions_[i];
  const JointVector arm_change = joints_of(change, arm_);
  pushes_ = !pushed_.empty() && spread(arm_change) == change;  // jaws stay as they are
  Look now = look(2 * kClose + model_.farthest(change));
  settle_depths(now, T_world_node);
  const bool all = advance(change, now);
  if (all)
    positions_.assign(positions.begin(), positions.end());
  else
    blame(now);
  settle_arm();
  HandStep out = finish(now);
  const Pose hand = kinematics_.chain().tip_pose(joints_of(positions, arm_));
  out.ghost = ghost(hand, all ? GhostReason::none : GhostReason::joint_speed);
  if (!all && out.ghost.reason == GhostReason::none) {  // so short a way that the tool is almost there
    out.ghost.reason = leans_ == GhostReason::none ? GhostReason::joint_speed : leans_;
    out.ghost.words = leans_ == GhostReason::none ? name_of(out.ghost.reason) : words_;
  }
  return out;
}

HandStep SlidingHand::finish(Look& now) {
  HandStep out;
  out.valid = true;
  out.positions = positions_;
  out.T_base_tip = follower_.hand();
  out.near = now.within < kContactReach || !now.pushed.empty() ? model_.near(kContactReach) : std::move(now.near);
  out.parts = parts_;
  return out;
}

}  // namespace foresight
