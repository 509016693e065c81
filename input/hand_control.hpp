// From a hand to set-points of all joints of a robot.
//
//   released --switch pressed, robot ready--> holding <--clutch--> driving      the tool goes with the hand, or one
//   joint
//      ^  ^                                      |                    |
//      |  '-------- switch let go ---------------'--------------------'
//      '--switch let go-- refused <-- device gone, frozen, jumped; robot lost; the program stood still
//
// What the clutch connects are changes: of the hand, since the clutch was closed, and of the tool from where the joints
// put it. A hand that is still moves nothing, bit for bit, wherever it is and whatever it did before. While the switch
// is open, all set-points are those where the robot begins (as it measured them); so they are after each loss. No
// set-point goes farther in a cycle than its joint's velocity allows, scaled by the ramp with which the safety gate
// begins.
//
// Translation and rotation of the hand are taken step by step, scaled, and along or about the axes that are not locked:
// scales, locks and frames may change at any time without a jump.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "input/hand_guard.hpp"
#include "input/hand_watch.hpp"
#include "motion/gate_options.hpp"
#include "prediction/path_follower.hpp"
#include "prediction/pose_filter.hpp"

namespace foresight {

enum class JointRole : std::uint8_t {
  arm,      ///< of the arm that the hand moves, or another arm's, which holds
  gripper,  ///< opens and closes
  other     ///< holds, or goes where HandInput::others says: a pan-tilt head
};

struct HandOptions {
  GateOptions gate;              ///< the robot's joints, in its order, and its ramp
  std::vector<JointRole> roles;  ///< one per joint
  /// The arm between the robot's base and the tool, within the gate's limits; without it single joints can be moved.
  std::optional<ArmChain> arm;
  std::vector<std::size_t> arm_joints;   ///< of the robot, per joint of `arm`
  std::size_t tip = 0;                   ///< of the URDF's links, the one that the tool is on
  std::optional<std::size_t> pan, tilt;  ///< the joints that the device's pan and tilt rates move
  bool tilt_looks_down = true;           ///< larger positions of `tilt` look farther down
  /// Where a person begins, rad or m, one per joint: the button to_start brings those that are given there.
  std::vector<std::optional<double>> start{};
  double look_speed = 0.3;       ///< share of their velocity
  bool gripper_opens_up = true;  ///< larger positions are wider open
  double joint_speed = 0.3;      ///< share of a joint's velocity at which it is jogged
  double gripper_speed = 1;      ///< share of its velocity at which a gripper opens and closes
  /// How far the target may get ahead of the tool. Beyond it, it slips: what the arm cannot follow is not made up for
  /// later.
  double leash = 0.3;       ///< m
  double leash_turn = 1.0;  ///< rad
  /// The robot has to follow within that time, or the switch has to be let go of.
  Duration follows_within = std::chrono::seconds(4);
  /// A longer time between two cycles is a pause, in which nobody knows what the hand did.
  Duration longest_cycle = std::chrono::milliseconds(250);
  HandWatchOptions watch;
  FollowOptions follow;
};

/// In which axes the hand's motion is meant: x forward, y left, z up of the view that the operator looks at, or of the
/// robot's base.
enum class HandFrame : std::uint8_t { view, base };
/// The operator's forward (x) is the view's z, left (y) its -x, up (z) its -y.
Eigen::Matrix3d R_view_operator() noexcept;
enum class HandMode : std::uint8_t { tool, joints };

/// What the operator may change at any time.
struct HandSettings {
  HandFrame frame = HandFrame::view;
  /// The view is that of a head display: a hand counts as seen from the head. Else from where recentring put it.
  bool view_turns_with_head = false;
  double translation_scale = 1;                             ///< 0 .. 10; what is no number is 0
  double rotation_scale = 1;                                ///< 0 .. 10
  std::array<bool, 3> lock_translation{}, lock_rotation{};  ///< along and about x, y, z of the frame
};

/// What is known of the robot: ControlSeat's begin() and status() (link/control/control_seat.hpp).
struct HandRobot {
  std::size_t joints = 0;    ///< 0: unknown
  JointValues begin{};       ///< where set-points have to begin: as measured, but what grips keeps its grip
  bool ready = false;        ///< would follow who presses the switch now
  bool follows = false;      ///< follows what is sent
  bool must_let_go = false;  ///< has stopped, or was lost: the switch has to be let go of
};

/// One cycle's input.
struct HandInput {
  OperatorTime now;
  TrackerState device;
  HandRobot robot;
  Pose T_base_view =
      Pose::Identity();  ///< the camera that the operator looks through (optical frame), by the arm's base
  /// Where joints with the role `other` shall go, at no more than their velocity; those that are not given hold, or go
  /// as the device's pan and tilt rates say.
  std::array<std::optional<double>, kMostJoints> others{};
};

enum class HandPhase : std::uint8_t { released, refused, holding, driving };

/// Why nothing moves.
enum class HandReason : std::uint8_t {
  none,
  device,           ///< HandCycle::fault says what is wrong with it
  not_let_go,       ///< the switch was held from the begin: it has to be seen open first
  robot_unknown,    ///< nothing is known of where its joints are
  robot_not_ready,  ///< it would not follow
  robot_lost,       ///< it followed, and no longer does
  robot_silent,     ///< it did not begin to follow in time
  paused,           ///< this program stood still
  no_arm,           ///< the robot has no arm whose tool could be moved
  no_start,         ///< it has no start position to go to
  bad_number,       ///< what is known of the robot is no number
};

/// What came of a cycle: what to send (ControlSeat::command()), and what to show.
struct HandCycle {
  HandPhase phase = HandPhase::released;
  HandReason reason =
      HandReason::none;  ///< of `refused`, of a clutch that connects nothing, and of a hand that could not
  HandFault fault = HandFault::none;
  const char* trouble = "";  ///< the device's own words for it, or ""
  const char* cure = "";
  bool deadman = false;  ///< to be sent with the positions
  std::size_t joints = 0;
  JointValues positions{};
  HandMode mode = HandMode::tool;
  std::size_t joint = 0;  ///< that joint mode moves
  /// Where the hand asks the tool to be, a ghost where that is out of reach; while driving the tool.
  std::optional<Pose> T_base_target;
  Pose T_base_tip = Pose::Identity();        ///< where the set-points put the tool
  FollowReason follow = FollowReason::none;  ///< what keeps the tool from its target
  int follow_joint = -1;                     ///< of the robot, that is the reason; -1: none in particular
  double position_error = 0;                 ///< m from the target
  double rotation_error = 0;                 ///< rad
  bool slipped = false;                      ///< the target was at the end of its leash
  bool home_view = false;                    ///< the operator has just asked for it
};

struct HandWords {
  std::string name;  ///< "the device has gone"; "" where nothing is to be said
  std::string cure;  ///< what to do; "" where nothing is to be done
};
/// `joints`: the robot's, in its order.
HandWords describe(const HandCycle& cycle, const std::vector<GateJoint>& joints);
HandWords words_for(HandFault fault);
HandWords words_for(FollowReason reason, const std::string& joint);

/// Pure logic: does not wait. One thread. cycle() neither throws nor, but for what a guard does, allocates.
class HandControl {
 public:
  /// Throws InputError at `where`: options that contradict themselves.
  HandControl(HandOptions options, const std::string& where);
  HandControl(const HandControl&) = delete;
  HandControl& operator=(const HandControl&) = delete;

  HandSettings& settings() noexcept { return settings_; }
  void set_mode(HandMode mode) noexcept;
  /// From now on the arm goes only where `guard` lets it, in both modes; null: anywhere. Borrowed.
  void set_guard(HandGuard* guard) noexcept { guard_ = guard; }
  /// Every 2 to 20 ms, with `now` that never goes back.
  const HandCycle& cycle(const HandInput& input) noexcept;
  const HandCycle& last() const noexcept { return out_; }

  /// A vector of the arm's base as the hand feels it: in the axes of the device's space. By the frame and view of the
  /// newest cycle, without its scale.
  Eigen::Vector3d in_space(const Eigen::Vector3d& v_in_base) const noexcept {
    return (R_base_operator() * R_operator_space()).transpose() * v_in_base;
  }

 private:
  struct Held {  // while the switch is held
    OperatorTime since;
    bool followed = false, clutched = false;
    bool clutch_refused = false;                  // and has to be let go of
    HandFault fault = HandFault::none;            // why
    std::optional<TrackerState> refused_by = {};  // with the words for that
    bool grip_caught = false;                     // the trigger has been where the gripper is
    std::optional<double> grip_at = {};           // the trigger, when the switch was pressed
  };
  void forget_cycle() noexcept;
  void see(const HandInput& input, const HandWatch::Verdict& verdict) noexcept;
  void take_presses(const TrackerState& device) noexcept;
  void recentre() noexcept;
  void heed_switch(const HandInput& input, const HandWatch::Verdict& verdict, bool paused) noexcept;
  void let_go(HandFault pose, const TrackerState& device) noexcept;
  bool rest(const HandRobot& robot) noexcept;
  void press(const HandInput& input) noexcept;
  void refuse(HandReason reason) noexcept;
  void refuse(HandFault fault, const TrackerState& device) noexcept;
  void stop_following(bool was_held) noexcept;
  void say(HandReason reason) noexcept;
  void say(HandFault fault, const TrackerState& device) noexcept;
  HandReason fault_of_robot(const HandInput& input) noexcept;
  void hold(const HandInput& input, const HandWatch::Verdict& verdict, double dt) noexcept;
  void heed_clutch(const TrackerState& device, HandFault fault, double dt) noexcept;
  void close_clutch() noexcept;
  void go_with_hand(double dt) noexcept;
  void follow_target(double dt) noexcept;
  void tell(const FollowStep& step) noexcept;
  void leash(const FollowStep& step) noexcept;
  void jog(double rate, double dt) noexcept;
  void go_to_start(const HandInput& input, double dt) noexcept;
  void guard_joints(const JointValues& before) noexcept;
  void look(const TrackerState& device, double dt) noexcept;
  void move_others(const HandInput& input, double dt) noexcept;
  void move_grippers(const TrackerState& device, double dt) noexcept;
  bool trigger_catches(double grip, std::size_t joint) noexcept;
  double grip_position(std::size_t joint, double grip) const noexcept;
  void move_to(std::size_t joint, double target, double dt, double share) noexcept;
  JointVector arm_positions() const noexcept;
  Eigen::Matrix3d R_base_operator() const noexcept;
  Eigen::Matrix3d R_operator_space() const noexcept;

  HandOptions options_;
  std::optional<InverseKinematics> kinematics_;
  std::optional<PathFollower> follower_;
  HandGuard* guard_ = nullptr;
  HandSettings settings_;
  HandWatch watch_;
  PoseFilter filter_;
  HandCycle out_;
  std::optional<OperatorTime> last_;
  std::optional<Held> held_;
  bool seen_open_ = false;
  double ramp_ = 0;         // share of all velocities, while held
  TrackerButtons buttons_;  // of the cycle before
  std::optional<double> grip_;
  Pose raw_ = Pose::Identity();                                    // the hand, as it came
  Pose hand_ = Pose::Identity(), hand_before_ = Pose::Identity();  // without its noise, now and a cycle before
  Pose raw_at_clutch_ = Pose::Identity();
  bool moved_ = false;  // since the clutch was closed
  Pose T_base_view_ = Pose::Identity();
  std::optional<Pose> T_space_head_;
  Eigen::Matrix3d R_recentred_space_ = Eigen::Matrix3d::Identity();
  Pose target_ = Pose::Identity();
};

}  // namespace foresight
