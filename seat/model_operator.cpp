#include "seat/model_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prediction/grasp/hand_path.hpp"

namespace foresight {
namespace {

constexpr double kSeenToMove = 0.002, kSeenToTurn = 0.02;  // m (also of the jaws), rad: less is taken for rest
constexpr double kNeverSeen = 4;                           // s beyond the lag: then it looks again
constexpr double kGhostBeyond = 0.005;                     // m from the tool: the hand is drawn as a ghost
constexpr double kAboveThing = 0.012, kAtThing = 0.006, kAboveTray = 0.02, kInTray = 0.012;  // m, near enough
constexpr double kAligned = 0.08;                                                            // rad
constexpr double kTrayFloor = 0.014, kTrayReach = 0.065;  // m: where a thing is let go of; from the tray's middle
constexpr double kInHand = 0.045;                         // m from where it should be in the hand

double yaw_of(const Pose& T) {
  return std::atan2(T.linear()(1, 0), T.linear()(0, 0));
}

/// The smallest turn from one yaw to another of a thing that looks alike after each quarter.
double quarter_turn(double from, double to) {
  constexpr double kQuarter = std::numbers::pi / 2;
  return std::remainder(to - from, kQuarter);
}

bool seen_apart(const OperatorSees& a, const OperatorSees& b) {
  const Eigen::AngleAxisd turn(a.T_world_tool.linear().transpose() * b.T_world_tool.linear());
  return (a.T_world_tool.translation() - b.T_world_tool.translation()).norm() > kSeenToMove ||
         std::abs(turn.angle()) > kSeenToTurn || std::abs(a.opening - b.opening) > kSeenToMove;
}

}  // namespace

ModelOperator::ModelOperator(const ModelOperatorOptions& options, const OperatorHand& hand)
    : options_(options), random_(options.seed), from_(hand), to_(hand) {}

OperatorHand ModelOperator::hand(double t) const {
  const double share = ends_ > begun_ ? minimum_jerk(std::clamp((t - begun_) / (ends_ - begun_), 0.0, 1.0)) : 1;
  OperatorHand out = to_;
  out.T_world_tool.translation() += (1 - share) * (from_.T_world_tool.translation() - to_.T_world_tool.translation());
  out.T_world_tool.linear() = Eigen::Quaterniond(from_.T_world_tool.linear())
                                  .slerp(share, Eigen::Quaterniond(to_.T_world_tool.linear()))
                                  .toRotationMatrix();
  out.opening = std::lerp(from_.opening, to_.opening, share);
  return out;
}

void ModelOperator::see(double t, const OperatorSees& sees) {
  watch(t, sees);
  if (done() || waits(t, sees)) return;
  if (!decides_at_) decides_at_ = t + options_.decision;
  if (t >= *decides_at_) decide(t, sees);
}

// How late what is seen is, is learnt from the hand's own moves.
void ModelOperator::watch(double t, const OperatorSees& sees) {
  if (!any_seen_) at_begin_ = still_ = sees, still_since_ = t, any_seen_ = true;
  if (seen_apart(sees, still_)) still_ = sees, still_since_ = t;
  if (wide_ && !began_seen_ && seen_apart(sees, at_begin_)) {
    began_seen_ = true;
    lag_ = t - begun_;
  }
}

bool ModelOperator::waits(double t, const OperatorSees& /*sees*/) {
  if (t < ends_ + lag_ || t - still_since_ < options_.rests_for) return true;
  return wide_ && !began_seen_ && t < ends_ + lag_ + kNeverSeen;
}

// With the noise of one look.
OperatorSees ModelOperator::glance(const OperatorSees& sees) {
  OperatorSees out = sees;
  for (Pose* T : {&out.T_world_thing, &out.T_world_tray}) {
    for (int k = 0; k < 3; ++k) T->translation()[k] += normal(options_.sight);
    T->linear() = Eigen::AngleAxisd(normal(options_.sight_rad), Eigen::Vector3d::UnitZ()) * T->linear();
  }
  return out;
}

bool ModelOperator::holds(const OperatorSees& seen) const {
  const Eigen::Vector3d grip = seen.T_world_tool.translation() - Eigen::Vector3d(0, 0, options_.grasp_height);
  return (seen.T_world_thing.translation() - grip).norm() < kInHand;
}

ModelOperator::Way ModelOperator::way_to(const OperatorSees& seen) const {
  const Eigen::Vector3d tool = seen.T_world_tool.translation(), thing = seen.T_world_thing.translation(),
                        tray = seen.T_world_tray.translation();
  Way out;
  double near = kAboveTray;
  switch (aim_) {
    case Aim::above:
    case Aim::down: {
      const double height = options_.grasp_height + (aim_ == Aim::above ? options_.above : 0);
      out.shift = thing + Eigen::Vector3d(0, 0, height) - tool;
      out.turn = quarter_turn(yaw_of(seen.T_world_tool), yaw_of(seen.T_world_thing));
      near = aim_ == Aim::above ? kAboveThing : kAtThing;
      break;
    }
    case Aim::carry: out.shift = Eigen::Vector3d(tray.x() - thing.x(), tray.y() - thing.y(), 0); break;
    case Aim::lower:
      out.shift = tray + Eigen::Vector3d(0, 0, kTrayFloor) - thing;
      near = kInTray;
      break;
    default: out.shift.z() = options_.above; break;
  }
  out.good = out.shift.norm() < near && std::abs(out.turn) < kAligned;
  return out;
}

// Where something held the tool back, the hand is ahead of it as a ghost, and is brought back to it: what was asked for
// in vain is not added to what is asked for next.
OperatorHand ModelOperator::at_tool(double t, const OperatorSees& seen) const {
  OperatorHand out = hand(t);
  const double ahead = (out.T_world_tool.translation() - seen.T_world_tool.translation()).norm();
  if (ahead > kGhostBeyond) out.T_world_tool = seen.T_world_tool;
  return out;
}

void ModelOperator::go(double t, const Way& way, const OperatorSees& seen) {
  const double far = way.shift.norm(), left = options_.left_of_move;
  from_ = hand(t);
  to_ = at_tool(t, seen);
  for (int k = 0; k < 3; ++k) to_.T_world_tool.translation()[k] += way.shift[k] + normal(left * far / std::sqrt(3.0));
  to_.T_world_tool.linear() =
      Eigen::AngleAxisd(way.turn + normal(left * std::abs(way.turn)), Eigen::Vector3d::UnitZ()) *
      to_.T_world_tool.linear();
  begun_ = t;
  ends_ = t + std::max({options_.shortest_move, far / options_.speed, std::abs(way.turn) / options_.turning});
  wide_ = far > 2 * kSeenToMove || std::abs(way.turn) > 2 * kSeenToTurn;
  ++moves_;
}

void ModelOperator::use_jaws(double t, double opening, Aim next) {
  from_ = hand(t);
  to_ = from_;
  to_.opening = opening;
  begun_ = t;
  ends_ = t + 1;
  wide_ = std::abs(to_.opening - from_.opening) > 2 * kSeenToMove;
  aim_ = next;
}

// It is not where the task needs it: from the beginning.
void ModelOperator::lost(double t, const OperatorSees& /*seen*/) {
  ++regrasps_;
  use_jaws(t, options_.open, Aim::rise);
}

void ModelOperator::decide(double t, const OperatorSees& sees) {
  decides_at_.reset();
  OperatorSees seen = glance(sees);
  while (!pursue(t, seen)) {
  }
  at_begin_ = sees;
  began_seen_ = false;
}

// One decision; false: there was nothing to do for this aim, and the next one counts at once.
bool ModelOperator::pursue(double t, const OperatorSees& seen) {
  using enum Aim;
  const auto then = [&](Aim next) {
    aim_ = next;
    return false;
  };
  const bool carrying = aim_ == carry || aim_ == lower;
  if (carrying && !holds(seen)) {
    lost(t, seen);
    return true;
  }
  switch (aim_) {
    case close: use_jaws(t, options_.closed, lift); return true;
    case open: use_jaws(t, options_.open, leave); return true;
    case judge: {
      const Eigen::Vector3d off = seen.T_world_thing.translation() - seen.T_world_tray.translation();
      if (off.head<2>().cwiseAbs().maxCoeff() < kTrayReach) {
        aim_ = done;
        return true;
      }
      ++regrasps_;
      return then(above);
    }
    case lift:
    case leave:
    case rise: {
      const Aim next = aim_ == lift ? carry : aim_ == leave ? judge : above;
      if (next == above && to_.T_world_tool.translation().z() > seen.T_world_thing.translation().z() + options_.above)
        return then(above);
      Way up;
      up.shift.z() = options_.above;
      go(t, up, seen);
      aim_ = next;
      return true;
    }
    case done: return true;
    default: break;
  }
  const Way way = way_to(seen);
  if (way.good) return then(aim_ == above ? down : aim_ == down ? close : aim_ == carry ? lower : open);
  go(t, way, seen);
  return true;
}

}  // namespace foresight
