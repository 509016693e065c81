#include "sim/arm.hpp"

#include <gtest/gtest.h>

#include "sim/motion.hpp"
#include "sim/tracer.hpp"

namespace foresight::sim::arm_test {
namespace {

const Lab& lab() {
  static const Lab built = make_lab(0.004, 1);
  return built;
}

using Edges = std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>>;

void add(const Part& part, const Pose& T, std::vector<Triangle>& triangles, Edges& edges) {
  for (const Facet& f : part.facets) {
    Triangle t;
    for (int k = 0; k < 3; ++k) t[k] = (T * f.corners[k].p.cast<double>()).cast<float>();
    triangles.push_back(t);
    for (int k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
}

bool any_meets(const Edges& edges, const Tracer& tracer) {
  for (const auto& [a, b] : edges)
    if (tracer.blocked(a, b - a, 1)) return true;
  return false;
}

TEST(Arm, ReachesAsFarAsAHumanOne) {
  const auto links = arm_links_at({});
  const double reach = (links[8].translation() - links[2].translation()).norm() + 0.095;
  EXPECT_NEAR(reach, 0.9, 0.01);
}

// Two closed surfaces meet where an edge of one goes through the other.
TEST(Arm, PathTouchesNeitherTableNorThings) {
  std::vector<Triangle> still;
  Edges still_edges;
  for (const Part& part : lab().parts)
    if (!part.moves && part.name != kArmStand) add(part, part.T_world_part, still, still_edges);
  const Tracer things(still);
  for (double t = 0; t < kArmPeriod; t += 0.05) {
    const LabState state = lab_state_at(lab(), t);
    std::vector<Triangle> arm;
    Edges arm_edges;
    for (std::size_t k = 0; k < lab().parts.size(); ++k)
      if (lab().parts[k].moves) add(lab().parts[k], state[k], arm, arm_edges);
    EXPECT_FALSE(any_meets(arm_edges, things)) << t;
    EXPECT_FALSE(any_meets(still_edges, Tracer(arm))) << t;
    for (const Triangle& triangle : arm)
      for (const auto& p : triangle)
        ASSERT_TRUE(p.y() < -0.5f || p.z() > 0.01f) << "at " << t << " s under the table top";
  }
}

TEST(Arm, MovesSmoothlyWithinItsLimits) {
  const double dt = 1.0 / 30;
  for (double t = 0; t < kArmPeriod; t += dt) {
    const ArmPosition a = arm_position_at(t), b = arm_position_at(t + dt), c = arm_position_at(t + 2 * dt);
    for (std::size_t j = 0; j < 7; ++j) {
      EXPECT_GT(a.joints[j], arm_joints()[j].lower) << t;
      EXPECT_LT(a.joints[j], arm_joints()[j].upper) << t;
      EXPECT_LT(std::abs(b.joints[j] - a.joints[j]) / dt, 1.8) << t;
      EXPECT_LT(std::abs(c.joints[j] - 2 * b.joints[j] + a.joints[j]) / (dt * dt), 6) << t;
    }
    EXPECT_GT(a.opening, arm_joints()[7].lower);
    EXPECT_LT(a.opening, arm_joints()[7].upper);
  }
  for (std::size_t j = 0; j < 7; ++j)
    EXPECT_NEAR(arm_position_at(0).joints[j], arm_position_at(kArmPeriod).joints[j], 1e-9);
}

}  // namespace
}  // namespace foresight::sim::arm_test
