// A scripted hand: the tool goes along straight lines, the gripper opens and closes, the head looks about meanwhile.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "input/hand_of_rig.hpp"
#include "prediction/path_follower.hpp"
#include "rig/home.hpp"
#include "rig/rig.hpp"
#include "seat/scripted_driver.hpp"
#include "session/live_scene.hpp"

namespace foresight {

struct ToolStep {
  enum class What : std::uint8_t {
    there,    ///< all joints at once, to where the tool is at `T_world_tool`
    line,     ///< the tool straight to it
    gripper,  ///< to `grip`
    wait
  };
  What what = What::wait;
  Pose T_world_tool = Pose::Identity();
  std::vector<double> grip = {};  ///< m or rad, of the rig's joints of `group: gripper`, in their order
  double seconds = 1;             ///< at least; longer where the joints take longer
  /// T_world_tool is meant with this node at `T_world_about`: where the node is seen elsewhere on its ground as the
  /// step begins, the tool goes elsewhere as far. "": wherever anything is seen.
  std::string about = {};
  Pose T_world_about = Pose::Identity();
  /// With `there`: the arm's joints to go to, one per joint of its chain; with `about`, those near them. Nothing: those
  /// of the pose that are nearest.
  std::optional<JointVector> joints = {};
};

/// The rig's pan-tilt head turns to and fro meanwhile, by so much (rad); 0: it stands still.
struct HeadSway {
  double pan = 0.20, tilt = 0.06;
  double pan_s = 9, tilt_s = 6.5;  ///< periods
  /// Where it looks in the middle, rad; nothing: where it stood at first. It gets there within seconds.
  std::optional<double> middle_pan = {}, middle_tilt = {};
};

/// The same rig and steps give the same motion.
class ToolScript final : public ScriptedMotion {
 public:
  /// `rig` must outlive this. Throws InputError: no arm, a pose that it cannot reach.
  ToolScript(const Rig& rig, std::vector<ToolStep> steps, const HeadSway& sway);

  void begin_at(const JointValues& begin) override;
  std::optional<JointValues> step(double dt, const PredictedRobot& shown) override;
  void look_by(Sees sees) override { sees_ = std::move(sees); }
  /// A line was given up, as the arm's joints did not get along it.
  bool fell_short() const { return fell_short_; }

 private:
  ToolScript(const Rig& rig, const HandOptions& hand, std::vector<ToolStep> steps, const HeadSway& sway);
  bool advance(const ToolStep& step, double dt);
  void begin_step();
  Pose aim_of(const ToolStep& step) const;
  void sway(double dt);
  JointVector arm() const;
  void set_arm(const JointVector& q);

  const Rig& rig_;
  InverseKinematics kinematics_;
  std::vector<std::size_t> arm_;       // of the rig, per joint of the chain
  std::vector<std::size_t> grippers_;  // of the rig
  std::vector<std::size_t> head_;
  std::vector<ToolStep> steps_;
  HeadSway sway_;
  Pose T_world_base_;
  Sees sees_;
  Pose T_base_aim_ = Pose::Identity();  // of the step under way
  JointValues position_{}, head_begin_{};
  std::size_t at_ = 0;
  double in_step_ = 0, swayed_ = 0, lasts_ = 0;
  JointVector from_, to_;
  Pose line_from_ = Pose::Identity();
  std::optional<PathFollower> follower_;
  bool began_ = false, fell_short_ = false;
};

/// Where `script` ends that begins at `from`, asked every `look_s` seconds of its motion; nothing where that is not
/// clear, or where it was clear before and is not any more: what begins too close to something may part.
std::optional<JointValues> end_of_clear_way(ToolScript& script, const JointValues& from, double look_s,
                                            const std::function<bool(const JointValues&)>& is_clear);

/// Of a node of the scene's model, while nothing has moved yet. Throws InputError: there is none of that name.
Pose place_at_rest(const LiveScene& scene, const std::string& node);

/// With any two jaws that slide (input/sliding_jaws.hpp): from above at a thing of the mock lab's own size of bricks
/// (sim/lab_task.hpp), and into a tray. Planned for where the scene's model has them at rest; gone to where they are
/// seen. Of the four ways to grasp a brick, and then of several ways of the joints to it, the first on which the arm
/// gets everywhere and stays as clear as the rig asks for, if there is one. Throws InputError: the scene lacks one of
/// the two, the jaws do not take a brick, or the arm does not reach them.
std::vector<ToolStep> pick_and_place(const Rig& rig, const LiveScene& scene, const std::string& thing,
                                     const std::string& tray);

}  // namespace foresight
