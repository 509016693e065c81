// Joint vectors spread uniformly over an arm's limits: always the same ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "prediction/arm_chain.hpp"

namespace foresight {

class UniformJoints {
 public:
  UniformJoints(const ArmChain& chain, std::uint64_t seed) : chain_(chain), random_(seed) {}

  /// Joints without an end get a whole turn.
  JointVector next() {
    JointVector q(chain_.lower().size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double low = std::isfinite(chain_.lower()[i]) ? chain_.lower()[i] : chain_.middle()[i] - std::numbers::pi;
      const double high = std::isfinite(chain_.upper()[i]) ? chain_.upper()[i] : chain_.middle()[i] + std::numbers::pi;
      const double share = static_cast<double>(random_() >> 11) * 0x1p-53;
      q[i] = std::clamp(low + share * (high - low), low, high);
    }
    return q;
  }
  std::uint64_t any() { return random_(); }

 private:
  const ArmChain& chain_;
  std::mt19937_64 random_;
};

}  // namespace foresight
