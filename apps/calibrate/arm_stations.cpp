#include "apps/calibrate/arm_stations.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/robot/rigid_math.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kWristTurn = 0.6, kArmTurn = 0.15;  // rad: of the last three joints, and of those before them
constexpr std::size_t kWrist = 3;
constexpr int kProposals = 60;
constexpr int kSteps = 24;           // on the way between two stations
constexpr double kFromLimit = 0.05;  // rad or m
constexpr double kFarTurn = 0.8;     // rad: farther turns are no more worth than that
constexpr double kLeastReach = 0.25, kWider = 1.1, kNarrower = 0.8;

}  // namespace

ArmStations::ArmStations(const Rig& rig, JointChain& chain, const JointValues& start, unsigned seed)
    : rig_(rig),
      chain_(chain),
      shape_(rig.shape()),
      limits_(rig.gate_options().joints),
      random_(seed),
      start_(start),
      last_(start) {
  const std::vector<std::string> names = rig.joint_names();
  for (const int joint : chain.joints) {
    const std::string& name = chain.robot.joints[static_cast<std::size_t>(joint)].name;
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      throw InputError("--rig", "it has no joint " + in_quotes(name) + ", which moves the flange",
                       "name the links between which the rig's joints lie: --base-link and --flange-link");
    rig_joints_.push_back(static_cast<std::size_t>(at - names.begin()));
  }
  if (!shape_) return;
  shape_->surround(rig.surroundings);
  margins_.resize(shape_->couples());
}

std::vector<double> ArmStations::of_chain(const JointValues& positions) const {
  std::vector<double> out;
  for (const std::size_t joint : rig_joints_) out.push_back(positions[joint]);
  return out;
}

bool ArmStations::clear(const JointValues& positions) noexcept {
  if (!shape_) return true;
  shape_->margins(std::span(positions).first(rig_.joints.size()), margins_);
  return std::all_of(margins_.begin(), margins_.end(), [](double margin) { return margin > 0; });
}

bool ArmStations::clear_way(const JointValues& to) noexcept {
  for (int step = 1; step <= kSteps; ++step) {
    JointValues between = last_;
    for (const std::size_t joint : rig_joints_) between[joint] += step * (to[joint] - last_[joint]) / kSteps;
    if (!clear(between)) return false;
  }
  return true;
}

JointValues ArmStations::propose() {
  JointValues out = start_;
  const std::size_t count = rig_joints_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t joint = rig_joints_[i];
    const JointLimits& limits = limits_[joint].limits;
    const double turn = reach_ * (i + kWrist >= count ? kWristTurn : kArmTurn);
    const double way = std::uniform_real_distribution<double>(-turn, turn)(random_);
    out[joint] = std::clamp(start_[joint] + way, limits.min_position + kFromLimit, limits.max_position - kFromLimit);
  }
  return out;
}

double ArmStations::novelty(const JointValues& positions) {
  const Pose flange = flange_pose(chain_, of_chain(positions), "station");
  double least = kFarTurn;
  for (const Pose& taken : taken_)
    least = std::min(least, rotation_vector(taken.linear().transpose() * flange.linear()).norm());
  return least;
}

std::optional<JointValues> ArmStations::next() {
  std::optional<JointValues> best;
  double most = -1;
  if (!started_) {
    started_ = true;
    proposed_ = start_;
    return start_;  // the gate says whether it can be reached, and what is in the way
  }
  for (int i = 0; i < kProposals && most < kFarTurn; ++i) {
    const JointValues one = propose();
    if (const double far = novelty(one); far > most && clear_way(one)) best = one, most = far;
  }
  if (best) proposed_ = *best;
  return best;
}

void ArmStations::judge(bool reached, bool seen) {
  if (reached) last_ = proposed_;
  if (seen) taken_.push_back(flange_pose(chain_, of_chain(proposed_), "station"));
  reach_ = seen ? std::min(1.0, kWider * reach_) : std::max(kLeastReach, kNarrower * reach_);
}

}  // namespace foresight
