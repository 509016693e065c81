// What each node of a view is drawn with, frame after frame.
//
//   view, seen nodes --> size, acuity of each --> rule --> goals --> ways to them --> plan --> drawn --> it took so
//   long
//                                                  ^                                                          |
//                                                  '----------- tolerance, or costs learnt -------------------'
#pragma once

#include <memory>
#include <optional>

#include "scene/lod/acuity.hpp"
#include "scene/lod/frame_cost.hpp"
#include "scene/lod/level_rules.hpp"
#include "scene/lod/level_walk.hpp"
#include "scene/lod/scene_levels.hpp"

namespace foresight {

enum class LevelRule : std::uint8_t {
  full,       ///< no level but the mesh itself
  by_size,    ///< static: by how large it is seen
  by_acuity,  ///< psychophysical: and how sharply
  reactive,   ///< by size, coarser while frames take too long
  predictive  ///< by cost and benefit, so that the next frame does not take too long
};

struct LevelSettings {
  LevelRule rule = LevelRule::by_size;
  double px = 1;            ///< error that is allowed, of the view's pixels; with a budget: where there is time
  double hysteresis = 0.3;  ///< share by which the reason to change a level has to be clear; 0: none
  LevelTransition transition = LevelTransition::geomorph;
  double seconds = 0.4;  ///< that a transition takes
  double budget_ms = 0;  ///< of a frame; reactive and predictive only
  bool eye_looks_ahead =
      true;  ///< by_acuity, predictive: the eye looks where the view does, so that beside it less is seen
  AcuityOptions acuity{};
  FrameCostOptions cost{};

  /// Things are judged by where the eye looks.
  bool looks_ahead() const {
    return eye_looks_ahead && (rule == LevelRule::by_acuity || rule == LevelRule::predictive);
  }
};

/// Where a frame is seen from, and when.
struct LevelView {
  Pose T_world_camera = Pose::Identity();
  double focal_px = 0;  ///< in the middle of the view
  double seconds = 0;   ///< of any clock; where it stands still or goes back, transitions end at once
};

struct LevelPlan {
  std::vector<LevelBlend> blends;  ///< one for each node; of nodes that are not seen it does not count
  LevelTransition transition = LevelTransition::hard;
  FrameWork work;              ///< that drawing it is
  double expected_ms = 0;      ///< predictive: that it will take
  bool is_usable_view = true;  ///< false: a view of no size, or numbers that are none; all is drawn in full
};

struct LevelCounts {
  std::uint64_t frames = 0;
  std::uint64_t changes = 0;    ///< of goals of nodes
  std::uint64_t reversals = 0;  ///< of them, back within a second: what oscillates
  std::uint64_t cut_short = 0;  ///< transitions that ended early as there was no time for them
};

/// One thread.
class LevelDirector {
 public:
  LevelDirector(std::shared_ptr<const SceneLevels> scene, const LevelSettings& settings);

  const SceneLevels& scene() const { return *scene_; }
  const LevelSettings& settings() const { return settings_; }

  /// `seen`: one for each node. The plan is valid until the next call.
  const LevelPlan& plan(const LevelView& view, const SceneState& state, const std::vector<bool>& seen);
  const LevelPlan& last() const { return plan_; }
  /// Drawing `work`, that of a plan, took so long, as the budget counts time.
  void took(const FrameWork& work, double ms);

  const LevelCounts& counts() const { return counts_; }

 private:
  struct History {
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // in which it was seen; zero: it was not
    double acuity = 1;
    int direction_of_change = 0;
    double changed = 0;  // s
  };
  LevelCandidate candidate(std::size_t node, const LevelView& view, const Pose& T_world_node, double elapsed);
  std::vector<int> choose(const std::vector<LevelCandidate>& candidates) const;
  void note_change(std::size_t node, int from, int to, double seconds);
  void cut_short(const std::vector<LevelCandidate>& candidates);
  FrameWork node_work(std::size_t node) const;
  void draw_all_in_full(const std::vector<bool>& seen);

  std::shared_ptr<const SceneLevels> scene_;
  LevelSettings settings_;
  LevelWalk walk_;
  FrameCost cost_;
  ReactiveTolerance tolerance_;
  LevelPlan plan_;
  std::vector<History> history_;
  std::vector<std::size_t> nodes_;  // of the candidates in work
  std::optional<double> gaze_distance_;
  std::optional<double> last_;  // s
  LevelCounts counts_;
};

}  // namespace foresight
