#include "scene/lod/level_director.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/workshop.hpp"

namespace foresight::level_director_test {
namespace {

class LevelDirectorTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = new SceneModel(sim::make_workshop({.triangles = 200'000}));
    levels_ = new std::shared_ptr<const SceneLevels>(std::make_shared<const SceneLevels>(*scene_));
  }
  static void TearDownTestSuite() {
    delete scene_;
    delete levels_;
  }
  static Pose eye(double x, double turned) {
    Pose out = Pose::Identity();
    out.translation() = Eigen::Vector3d(x, 0, 1.6);
    out.linear() << std::sin(turned), 0, std::cos(turned), -std::cos(turned), 0, std::sin(turned), 0, -1, 0;
    return out;
  }
  static double full() { return static_cast<double>(scene_->triangle_count()); }
  static std::vector<bool> all() { return std::vector<bool>(scene_->nodes().size(), true); }
  /// Frames of a head that goes along the aisle, each taking what its triangles do.
  template <typename PerFrame>
  static LevelCounts walk(LevelDirector& director, PerFrame per_frame) {
    for (int i = 0; i < 120; ++i) {
      const double seconds = 0.1 * i;
      const LevelPlan& plan = director.plan({eye(-8 + 0.1 * i, 0.3 * std::sin(0.2 * i)), 400, seconds},
                                            sim::workshop_state(*scene_, seconds), all());
      const double ms = 4 + 1e-3 * plan.work.triangles;
      per_frame(i, plan, ms);
      director.took(plan.work, ms);
    }
    return director.counts();
  }
  static SceneModel* scene_;
  static std::shared_ptr<const SceneLevels>* levels_;
};
SceneModel* LevelDirectorTest::scene_ = nullptr;
std::shared_ptr<const SceneLevels>* LevelDirectorTest::levels_ = nullptr;

TEST_F(LevelDirectorTest, FarThingsAreCoarserAndBesideTheMiddleMore) {
  const SceneState rest = sim::workshop_state(*scene_, 0);
  const auto triangles = [&](LevelRule rule, double px) {
    LevelDirector director(*levels_, {.rule = rule, .px = px});
    return director.plan({eye(-8, 0), 400, 0}, rest, all()).work.triangles;
  };
  EXPECT_EQ(triangles(LevelRule::full, 1), full());
  EXPECT_LT(triangles(LevelRule::by_size, 1), 0.5 * full());
  double fixed = 0;  // of what has one level
  for (const MeshLevels& node : (*levels_)->nodes())
    if (node.levels.size() == 1) fixed += static_cast<double>(node.levels[0].triangles.size());
  const double usual = triangles(LevelRule::by_size, 1) - fixed;
  EXPECT_LT(triangles(LevelRule::by_size, 4) - fixed, 0.7 * usual);
  EXPECT_LT(triangles(LevelRule::by_acuity, 1) - fixed, 0.9 * usual);
}

TEST_F(LevelDirectorTest, ThePredictiveRuleKeepsItsBudgetWhereTheReactiveOneLearnsTooLate) {
  for (const double budget : {75.0, 120.0}) {
    std::map<LevelRule, int> late;
    for (const LevelRule rule : {LevelRule::predictive, LevelRule::reactive}) {
      LevelDirector director(*levels_, {.rule = rule, .px = 0.05, .budget_ms = budget});
      walk(director, [&](int i, const LevelPlan&, double ms) { late[rule] += i >= 10 && ms > budget; });
    }
    EXPECT_LE(late[LevelRule::predictive], 5) << budget << " ms";
    EXPECT_GT(late[LevelRule::reactive], late[LevelRule::predictive]) << budget << " ms";
  }
}

TEST_F(LevelDirectorTest, HysteresisEndsOscillation) {
  const auto reversals = [&](double hysteresis) {
    LevelDirector director(*levels_, {.rule = LevelRule::by_size, .px = 3, .hysteresis = hysteresis});
    for (int i = 0; i < 60; ++i)  // a head that sways by some centimetres
      director.plan({eye(-3 + 0.05 * std::sin(1.3 * i), 0), 400, 0.1 * i}, sim::workshop_state(*scene_, 0), all());
    return director.counts().reversals;
  };
  EXPECT_GT(reversals(0), 20u);
  EXPECT_LT(reversals(0.3), reversals(0) / 10);
}

TEST_F(LevelDirectorTest, ViewsThatAreNoneShowAllInFull) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SceneState rest = sim::workshop_state(*scene_, 0);
  Pose lost = eye(0, 0);
  lost.translation().x() = nan;
  for (const LevelView& view : {LevelView{eye(0, 0), 0, 0}, LevelView{lost, 400, 0}, LevelView{eye(0, 0), nan, 0},
                                LevelView{eye(0, 0), 400, nan}}) {
    LevelDirector director(*levels_, {.rule = LevelRule::predictive, .budget_ms = 5});
    const LevelPlan& plan = director.plan(view, rest, all());
    EXPECT_FALSE(plan.is_usable_view);
    EXPECT_EQ(plan.work.triangles, full());
    for (const LevelBlend& blend : plan.blends) EXPECT_EQ(blend.level, 0);
  }
}

}  // namespace
}  // namespace foresight::level_director_test
