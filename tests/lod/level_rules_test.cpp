#include "scene/lod/level_rules.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "scene/lod/acuity.hpp"
#include "scene/lod/frame_cost.hpp"
#include "scene/lod/level_walk.hpp"

namespace foresight::level_rules_test {
namespace {

const std::vector<double> kErrors{0, 0.001, 0.002, 0.004, 0.008};
const std::vector<std::size_t> kTriangles{16'000, 8'000, 4'000, 2'000, 1'000};

LevelCandidate candidate(double px_per_m, int last = -1) {
  LevelCandidate out;
  out.errors = kErrors;
  out.triangles = kTriangles;
  out.px_per_m = px_per_m;
  out.area_px = px_per_m * px_per_m * 0.1;
  out.last = last;
  return out;
}

TEST(LevelRules, TheCoarsestLevelWithinTheErrorIsTaken) {
  EXPECT_EQ(coarsest_within(candidate(100), 1, 0), 4) << "0.8 px";
  EXPECT_EQ(coarsest_within(candidate(300), 1, 0), 2);
  EXPECT_EQ(coarsest_within(candidate(2000), 1, 0), 0);
  EXPECT_EQ(coarsest_within(candidate(std::numeric_limits<double>::infinity()), 1, 0), 0);
  LevelCandidate beside = candidate(300);
  beside.acuity = 0.25;
  EXPECT_EQ(coarsest_within(beside, 1, 0), 4) << "a quarter as sharp: four times the error";
}

TEST(LevelRules, HysteresisKeepsALevelThatIsNearlyRight) {
  int changes = 0, without = 0, last = -1, other = -1;
  for (int i = 0; i < 100; ++i) {  // sways by 8 % about where level 3 gives way to level 2
    const double px_per_m = 250 * (1 + 0.08 * std::sin(2.0 * i));
    const int now = coarsest_within(candidate(px_per_m, last), 1, 0.2);
    changes += last >= 0 && now != last;
    last = now;
    const int hard = coarsest_within(candidate(px_per_m, other), 1, 0);
    without += other >= 0 && hard != other;
    other = hard;
  }
  EXPECT_EQ(changes, 0);
  EXPECT_GT(without, 30);
  EXPECT_EQ(coarsest_within(candidate(1000, 3), 1, 0.2), 1) << "far off, it goes";
  EXPECT_EQ(coarsest_within(candidate(60, 1), 1, 0.2), 4);
}

double benefit(const LevelCandidate& node, int level, const BudgetRule& rule) {
  const double px = std::max(0.0, kErrors[static_cast<std::size_t>(level)] * node.px_per_m - rule.invisible_px);
  return node.area_px / (1 + px / rule.px);
}

// Against all ways of choosing: within the budget, and nearly as good as can be.
TEST(LevelRules, ABudgetIsKeptAndSpentWell) {
  std::mt19937 random(1);
  std::uniform_real_distribution any(0.0, 1.0);
  double worst = 1;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<LevelCandidate> nodes;
    for (int i = 0; i < 4; ++i)
      nodes.push_back(candidate(50 * std::pow(40.0, any(random)), static_cast<int>(any(random) * 5)));
    BudgetRule rule;
    rule.ms_per_triangle = 1e-3;
    rule.ms_per_node = 0.1;
    rule.budget_ms = 5 + 50 * any(random);
    rule.hysteresis = 0;
    const std::vector<int> chosen = levels_within_budget(nodes, rule);
    double cost = 0, value = 0, best = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      cost += rule.ms_per_node +
              rule.ms_per_triangle * static_cast<double>(kTriangles[static_cast<std::size_t>(chosen[i])]);
      value += benefit(nodes[i], chosen[i], rule);
    }
    EXPECT_LE(cost, rule.budget_ms);
    for (int code = 0; code < 625; ++code) {
      double other_cost = 0, other = 0;
      for (int i = 0, rest = code; i < 4; ++i, rest /= 5) {
        const auto level = static_cast<std::size_t>(rest % 5);
        other_cost += rule.ms_per_node + rule.ms_per_triangle * static_cast<double>(kTriangles[level]);
        other += benefit(nodes[static_cast<std::size_t>(i)], static_cast<int>(level), rule);
      }
      if (other_cost <= rule.budget_ms) best = std::max(best, other);
    }
    worst = std::min(worst, value / best);
  }
  EXPECT_GT(worst, 0.7) << "of the best benefit";
}

TEST(LevelRules, BeyondTheBudgetAllAreCoarsestAndWithTimeToSpareNothingInvisibleIsDrawn) {
  const std::vector<LevelCandidate> nodes{candidate(1000, 0), candidate(30, 0), candidate(400, 2)};
  BudgetRule rule;
  rule.ms_per_triangle = 1e-3;
  rule.budget_ms = 0.1;
  EXPECT_EQ(levels_within_budget(nodes, rule), (std::vector<int>{4, 4, 4}));
  rule.budget_ms = -3;
  EXPECT_EQ(levels_within_budget(nodes, rule), (std::vector<int>{4, 4, 4}));
  rule.budget_ms = 1000;
  EXPECT_EQ(levels_within_budget(nodes, rule), (std::vector<int>{0, 2, 0})) << "0.06 px nobody sees";
  EXPECT_TRUE(levels_within_budget({}, rule).empty());
}

TEST(LevelRules, WhatWasChosenIsChosenAgain) {
  std::vector<LevelCandidate> nodes{candidate(900), candidate(700), candidate(500), candidate(300)};
  BudgetRule rule;
  rule.ms_per_triangle = 1e-3;
  rule.budget_ms = 20;
  for (int i = 0; i < 3; ++i) {
    const auto chosen = levels_within_budget(nodes, rule);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      EXPECT_TRUE(i == 0 || chosen[k] == nodes[k].last) << k;
      nodes[k].last = chosen[k];
    }
  }
}

TEST(ReactiveTolerance, GrowsWhileFramesTakeTooLongAndShrinksWhileTheyDoNot) {
  ReactiveTolerance tolerance(1);
  for (int i = 0; i < 4; ++i) tolerance.took(200, 100);
  EXPECT_NEAR(tolerance.px(), 4, 1e-9);
  tolerance.took(std::numeric_limits<double>::quiet_NaN(), 100);
  tolerance.took(-1, 100);
  tolerance.took(50, 0);
  EXPECT_NEAR(tolerance.px(), 4, 1e-9);
  for (int i = 0; i < 20; ++i) tolerance.took(10, 100);
  EXPECT_EQ(tolerance.px(), 1) << "never finer than is asked for";
}

TEST(FrameCost, LearnsWhatTrianglesAndNodesCost) {
  std::mt19937 random(1);
  std::normal_distribution noise(0.0, 3.0);
  std::uniform_real_distribution any(0.0, 1.0);
  FrameCost cost;
  int late = 0;
  for (int i = 0; i < 400; ++i) {
    const FrameWork work{1e6 * (0.2 + any(random)), 50 + 200 * any(random)};
    const double ms = 12 + 90e-6 * work.triangles + 0.05 * work.nodes + noise(random);
    if (i >= 50) late += ms > cost.expected(work) + cost.margin();
    cost.took(work, ms);
  }
  EXPECT_NEAR(cost.expected({1e6, 100}), 12 + 90 + 5, 4);
  EXPECT_NEAR(cost.expected({2e5, 100}), 12 + 18 + 5, 4);
  EXPECT_LT(late, 0.05 * 350);
  EXPECT_GT(late, 0) << "a margin for the rarest frame would waste the budget";
  const double before = cost.expected({1e6, 100});
  cost.took({1e6, 100}, std::numeric_limits<double>::quiet_NaN());
  cost.took({1e6, 100}, -5);
  EXPECT_EQ(cost.expected({1e6, 100}), before);
  cost.took({1e6, 100}, 5000);  // somebody else had the machine
  EXPECT_LT(cost.expected({1e6, 100}), 1.3 * before);
}

TEST(FrameCost, WhatFramesDoNotTellIsGuessedInProportion) {
  FrameCost cost;  // frames that are all alike, on a machine ten times as fast as the guess
  for (int i = 0; i < 200; ++i) cost.took({2e5, 100}, 2.2 + 0.1 * std::sin(3.0 * i));
  EXPECT_NEAR(cost.expected({2e5, 100}), 2.2, 0.1);
  EXPECT_GT(cost.expected({2e6, 100}), 8) << "guessed: 16.6";
  EXPECT_LT(cost.expected({2e6, 100}), 25);
  EXPECT_GT(cost.expected({2e4, 100}), 0.3);
  EXPECT_LT(cost.margin(), 0.5);
}

TEST(Acuity, FallsBesideTheMiddleWithSpeedAndOffTheDepthThatIsLookedAt) {
  const AcuityOptions o;
  EXPECT_EQ(acuity({}), 1);
  EXPECT_EQ(acuity({.eccentricity = 0.26}), 1) << "eyes turn that far";
  EXPECT_NEAR(acuity({.eccentricity = o.eccentricity_from + o.eccentricity_scale}), std::exp(-1), 1e-9);
  EXPECT_NEAR(acuity({.speed = o.speed_from + 2 * o.speed_scale}), std::exp(-2), 1e-9);
  EXPECT_EQ(acuity({.distance = 5, .gaze_distance = 5}), 1);
  EXPECT_LT(acuity({.distance = 5, .gaze_distance = 0.4}), 0.1);
  EXPECT_EQ(acuity({.distance = 20, .gaze_distance = 3}), 1) << "far away eyes hardly turn to each other";
  EXPECT_NEAR(acuity({.eccentricity = 0.4, .speed = 1}), std::min(acuity({.eccentricity = 0.4}), acuity({.speed = 1})),
              1e-12);
  EXPECT_GT(acuity({.eccentricity = 3}), 0);
  EXPECT_EQ(acuity({.eccentricity = std::numeric_limits<double>::quiet_NaN()}), 1);
}

TEST(LevelWalk, GoesThereInItsTimeAndIsAtOnceWhereNobodyLooked) {
  LevelWalk walk(2, LevelTransition::geomorph, 0.4);
  walk.aim(0, 1);
  EXPECT_EQ(walk.blend(0).level, 1) << "seen for the first time, it is there";
  walk.step(0.1);
  walk.aim(0, 2);
  walk.step(0.1);
  walk.aim(0, 2);
  EXPECT_EQ(walk.blend(0).level, 1);
  EXPECT_NEAR(walk.blend(0).share, 0.25, 1e-6);
  walk.step(0.2);
  walk.aim(0, 1);  // back from where it is
  walk.step(0.1);
  EXPECT_NEAR(walk.blend(0).share, 0.5, 1e-6);
  walk.aim(0, 4);
  for (int i = 0; i < 4; ++i) {
    walk.step(0.1);
    walk.aim(0, 4);
  }
  EXPECT_EQ(walk.blend(0).level, 4) << "however many levels it is";
  EXPECT_FALSE(walk.is_on_the_way(0));
  walk.aim(0, 0);
  walk.step(0);
  EXPECT_EQ(walk.blend(0).level, 0) << "time stands still: no way has an end";
  walk.aim(0, 3);
  walk.arrive(0);
  EXPECT_EQ(walk.blend(0).level, 3);
  LevelWalk hard(1, LevelTransition::hard, 0.4);
  hard.aim(0, 0);
  hard.step(0.1);
  hard.aim(0, 3);
  EXPECT_EQ(hard.blend(0).level, 3);
  EXPECT_EQ(hard.blend(0).share, 0);
}

}  // namespace
}  // namespace foresight::level_rules_test
