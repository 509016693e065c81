#include "seat/ways_to_pose.hpp"

#include <algorithm>
#include <numbers>

namespace foresight {
namespace {

constexpr double kEndOfRange = 0.05;  // of a joint's range, that is left at both ends
constexpr double kSame = 1e-3;        // rad or m

}  // namespace

JointVector any_joints(const ArmChain& chain, std::mt19937& random) {
  JointVector q = chain.middle();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double low = std::max(chain.lower()[i], q[i] - std::numbers::pi);
    const double high = std::min(chain.upper()[i], q[i] + std::numbers::pi);
    const double end = kEndOfRange * (high - low);
    q[i] = std::uniform_real_distribution<double>(low + end, high - end)(random);
  }
  return q;
}

std::vector<JointVector> ways_to_pose(const InverseKinematics& kinematics, const Pose& T_base_tip,
                                      const JointVector& first, int tries, std::mt19937& random) {
  std::vector<JointVector> out;
  const auto is_known = [&](const JointVector& q) {
    return std::ranges::any_of(out,
                               [&](const JointVector& other) { return (q - other).cwiseAbs().maxCoeff() < kSame; });
  };
  for (int i = 0; i < tries; ++i) {
    const IkAnswer answer = kinematics.solve(T_base_tip, i == 0 ? first : any_joints(kinematics.chain(), random));
    if (answer.status == IkStatus::solved && !is_known(answer.q)) out.push_back(answer.q);
  }
  return out;
}

}  // namespace foresight
