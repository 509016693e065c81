#include "prediction/inverse_kinematics.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "common/rotation.hpp"

namespace foresight {
namespace {

constexpr int kStarts = 60;             // most targets within reach are found by the third
constexpr double kPastLimit = 5e-3;     // rad that joints may stand beyond limits while a swivel angle is sought
constexpr double kFinestSwivel = 1e-5;  // rad
constexpr int kTurnedStarts = 6;        // of arms that reach a position, in how many ways their tip's turn is looked at
constexpr int kTurnSteps = 20;
constexpr int kStartsOutOfReach = 6;  // then the nearest pose is what is wanted, and one valley leads there as a rule

// Places spread evenly over the limits, the same ones for every target: Kronecker's sequence with the powers of the
// generalised golden ratio of so many dimensions.
class Starts {
 public:
  explicit Starts(const ArmChain& chain) : chain_(chain) {
    double ratio = 2;
    for (int i = 0; i < 30; ++i) ratio = std::pow(1 + ratio, 1.0 / static_cast<double>(chain.size() + 1));
    ratio_ = ratio;
  }
  JointVector operator()(int index) const {
    JointVector q(chain_.middle().size());
    double power = 1;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      power /= ratio_;
      const double share = 0.5 + index * power;
      const double low = std::isfinite(chain_.lower()[i]) ? chain_.lower()[i] : chain_.middle()[i] - std::numbers::pi;
      const double high = std::isfinite(chain_.upper()[i]) ? chain_.upper()[i] : chain_.middle()[i] + std::numbers::pi;
      q[i] = low + (high - low) * (share - std::floor(share));
    }
    return q;
  }

 private:
  const ArmChain& chain_;
  double ratio_;
};

}  // namespace

InverseKinematics::InverseKinematics(ArmChain chain)
    : chain_(std::move(chain)),
      spherical_(SphericalArm::recognise(chain_)),
      length_(std::max(chain_.reach() / 3, 1e-3)) {}

std::string InverseKinematics::description() const {
  if (closed_form()) return "seven joints with spherical shoulder and wrist: closed form";
  const std::string count = std::to_string(chain_.size()) + (chain_.size() == 1 ? " joint" : " joints");
  if (position_first()) return count + ", fewer than six: the position first, then the orientation; step by step";
  return count + ": step by step";
}

DescentGoal InverseKinematics::goal(const Pose& target) const noexcept {
  return {target, position_first(), length_};
}

IkAnswer InverseKinematics::answer(IkStatus status, const JointVector& q, const Pose& target) const noexcept {
  IkAnswer a{status, q, chain_.tip_pose(q), 0, 0, 0};
  const Vector6 difference = pose_difference(a.T_base_tip, target);
  a.position_error = difference.head<3>().norm();
  a.rotation_error = difference.tail<3>().norm();
  const bool turned = position_first() || a.rotation_error <= kIkExact;
  if (status != IkStatus::bad_target)
    a.status = a.position_error <= kIkExact && turned ? IkStatus::solved : IkStatus::nearest;
  return a;
}

// The closed form is as exact as the URDF's right angles: "1.5708" is 4e-6 off. Descent does the rest, within limits.
IkAnswer InverseKinematics::refined(const JointVector& q, const Pose& target) const noexcept {
  const JointVector within = q.cwiseMax(chain_.lower()).cwiseMin(chain_.upper());
  IkAnswer direct = answer(IkStatus::solved, within, target);
  if (direct.position_error < 0.1 * kIkExact && direct.rotation_error < 0.1 * kIkExact) return direct;
  DescentLimits limits{chain_.lower(), chain_.upper(), 20, 1e-12, false};
  return answer(IkStatus::solved, descend(chain_, goal(target), limits, within).q, target);
}

// The elbow of an arm that is only nearly spherical is moved by the swivel, by about as little as its axes miss each
// other. On its limit, only some swivel angles bring it within, and steps of Newton's, to which it is then fixed,
// hardly tell which. Other joints' limits leave swivel angles that the closed form knows as little better. So: with all
// limits a little wider, how far beyond them do joints come to stand, and where do they not?
IkAnswer InverseKinematics::turned_off_limits(const Pose& target) const noexcept {
  DescentLimits limits{chain_.lower(), chain_.upper(), 20, 1e-12, false};
  limits.lower.array() -= kPastLimit;
  limits.upper.array() += kPastLimit;
  IkAnswer found;
  const auto beyond = [&](std::size_t branch, double psi) {
    const auto start = spherical_->solve_on(target, branch, psi);
    if (!start) return std::numeric_limits<double>::infinity();
    const JointVector within = start->q.cwiseMax(limits.lower).cwiseMin(limits.upper);
    const JointVector q = descend(chain_, goal(target), limits, within).q;
    found = answer(IkStatus::solved, q.cwiseMax(chain_.lower()).cwiseMin(chain_.upper()), target);
    return std::max((chain_.lower() - q).maxCoeff(), (q - chain_.upper()).maxCoeff());
  };
  for (std::size_t branch = 0; branch < SphericalArm::kBranches; ++branch) {
    const SwivelSamples samples = spherical_->swivels(target, branch);
    std::array<double, SwivelSamples::kMost> past;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      past[i] = beyond(branch, samples[i].psi);
      if (found.status == IkStatus::solved) return found;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const bool before = samples[i].joined, after = i + 1 < samples.size() && samples[i + 1].joined;
      if (!std::isfinite(past[i]) || (before && past[i - 1] < past[i]) || (after && past[i + 1] < past[i])) continue;
      double low = samples[before ? i - 1 : i].psi, high = samples[after ? i + 1 : i].psi;
      while (high - low > kFinestSwivel) {  // thirds, of a function that falls and rises once
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        const double past_a = beyond(branch, a);
        if (found.status == IkStatus::solved) return found;
        const double past_b = beyond(branch, b);
        if (found.status == IkStatus::solved) return found;
        (past_a < past_b ? high : low) = past_a < past_b ? b : a;
      }
    }
  }
  return found;
}

// The nearest pose: along the valley's floor to where nothing falls any more.
IkAnswer InverseKinematics::nearest_below(const Pose& target, const JointVector& q) const noexcept {
  const DescentLimits limits{chain_.lower(), chain_.upper(), 200, 1e-11, false};
  return answer(IkStatus::nearest, descend(chain_, goal(target), limits, q).q, target);
}

// Where all of the pose can be reached, a descent towards all of it finds that; else it ends where the tip is turned
// well, from where the position is not far.
IkAnswer InverseKinematics::search_position_first(const Pose& target, const JointVector* last) const noexcept {
  const DescentGoal place = goal(target);
  DescentGoal all = place;
  all.position_only = false;
  const DescentLimits limits{chain_.lower(), chain_.upper(), 40, 1e-11, true};
  const DescentLimits turning{chain_.lower(), chain_.upper(), kTurnSteps, 1e-11, false};
  const double exact = 0.5 * kIkExact * std::min(1.0, 1 / length_);
  const Starts starts(chain_);
  std::optional<IkAnswer> turned;
  DescentEnd nearest;
  nearest.error = std::numeric_limits<double>::infinity();
  for (int start = last ? -1 : 0, found = 0; start < kStarts && found < kTurnedStarts; ++start) {
    const JointVector from = start < 0    ? last->cwiseMax(chain_.lower()).cwiseMin(chain_.upper()).eval()
                             : start == 0 ? chain_.middle()
                                          : starts(start);
    const DescentEnd end = descend(chain_, place, limits, descend(chain_, all, limits, from).q);
    if (end.error < nearest.error) nearest = end;
    if (end.error > exact) continue;
    ++found;
    const IkAnswer here = answer(IkStatus::solved, turned_to_goal(chain_, place, turning, end.q), target);
    if (!turned || here.rotation_error < turned->rotation_error) turned = here;
    if (last || turned->rotation_error <= kIkExact) break;
  }
  return turned ? *turned : nearest_below(target, nearest.q);
}

IkAnswer InverseKinematics::search(const Pose& target, const JointVector* last) const noexcept {
  if (position_first()) return search_position_first(target, last);
  const DescentGoal wanted = goal(target);
  const DescentLimits limits{chain_.lower(), chain_.upper(), 40, 1e-11, true};
  const double exact = 0.5 * kIkExact * std::min(1.0, 1 / length_);
  const Starts starts(chain_);
  DescentEnd best;
  best.error = std::numeric_limits<double>::infinity();
  // Where a closed form has said that there is no answer, few valleys are looked at.
  const int count = spherical_ ? kStartsOutOfReach : kStarts;
  for (int start = last ? -1 : 0; start < count; ++start) {
    const JointVector from = start < 0    ? last->cwiseMax(chain_.lower()).cwiseMin(chain_.upper()).eval()
                             : start == 0 ? chain_.middle()
                                          : starts(start);
    const DescentEnd end = descend(chain_, wanted, limits, from);
    if (end.error < best.error) best = end;
    if (best.error <= exact) return answer(IkStatus::solved, best.q, target);
  }
  return nearest_below(target, best.q);
}

IkAnswer InverseKinematics::solve(const Pose& target) const noexcept {
  if (!is_rigid(target)) return answer(IkStatus::bad_target, chain_.middle(), Pose::Identity());
  if (!spherical_) return search(target, nullptr);
  if (const auto direct = spherical_->solve(target)) {
    IkAnswer a = refined(direct->q, target);
    if (a.status != IkStatus::solved) a = turned_off_limits(target);
    if (a.status == IkStatus::solved) return a;
  }
  IkAnswer found = search(target, nullptr);
  if (found.status == IkStatus::solved) return found;
  // Often only the distance is too far: then the orientation can be kept, and the way there is in closed form.
  const Pose pulled = spherical_->pulled_within_reach(target);
  if (const auto direct = spherical_->solve(pulled)) {
    const DescentLimits limits{chain_.lower(), chain_.upper(), 200, 1e-12, false};
    const JointVector within = direct->q.cwiseMax(chain_.lower()).cwiseMin(chain_.upper());
    const DescentEnd end = descend(chain_, goal(target), limits, within);
    if (end.error < weighted_error(found.T_base_tip, goal(target)).norm())
      found = answer(IkStatus::nearest, end.q, target);
  }
  return found;
}

IkAnswer InverseKinematics::solve(const Pose& target, const JointVector& last, double swivel) const noexcept {
  if (last.size() != chain_.middle().size() || !last.allFinite()) return solve(target);
  if (!is_rigid(target))
    return answer(IkStatus::bad_target, last.cwiseMax(chain_.lower()).cwiseMin(chain_.upper()), Pose::Identity());
  const auto with_change = [&](IkAnswer a) {
    a.largest_change = (a.q - last).cwiseAbs().maxCoeff();
    return a;
  };
  if (spherical_) {
    if (const auto direct = spherical_->solve_near(target, last, swivel)) {
      const IkAnswer a = refined(direct->q, target);
      if (a.status == IkStatus::solved) return with_change(a);
    }
  }
  return with_change(search(target, &last));
}

}  // namespace foresight
