// A hand's set-points that go into no contact: the arm that is commanded stops and slides as the arm that is shown.
//
//   target of the hand --> SlidingHand (scene, robot, what it carries, the gate's clearance) --> joints to send
//
// A thing between jaws that are pressed together is carried: it is part of the robot until they open, and then thought
// to stay where it was let go of, unless the scene moves it. Jaws themselves are not held back: they have to press.
// Things that are known to be loose are pushed aside, as far as the scene then shows them give way.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "input/hand_control.hpp"
#include "prediction/contact/sliding_hand.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// What is near the hand. World frame, metres.
struct NearPart {
  std::string part, other;  ///< names; `part` is of the robot or carried
  double distance = 0;
  Eigen::Vector3d point, other_point;
};

/// What is known of contact, for people.
struct TouchSight {
  bool known = false;  ///< of the newest step; else ghost.words says why not
  GhostHand ghost;
  std::vector<NearPart> near;  ///< within kContactReach, the nearest first; at most kMostNear
  std::string carried;         ///< name of what the jaws hold; "": nothing
};

/// One thread.
class ContactGuard final : public HandGuard {
 public:
  static constexpr std::size_t kMostNear = 12;

  /// `hand`: of this rig, with an arm; `scene`: what stands around, or null. `rig` must outlive this. Throws what
  /// ContactModel does.
  ContactGuard(const Rig& rig, const HandOptions& hand, std::shared_ptr<const SceneModel> scene);

  /// These nodes of the scene are loose; names that it lacks are passed over.
  void may_push(std::span<const std::string> nodes);
  /// Nodes of the scene stand there from now on; none: at rest.
  void scene_stands(std::span<const Pose> T_world_node);

  FollowStep step(const JointValues& from, const Pose& T_base_target, double dt) noexcept override;
  FollowStep go(const JointValues& from, const JointValues& to) noexcept override;

  TouchSight sight() const;
  /// Of sight().
  const GhostHand& ghost() const { return last_.ghost; }
  /// Where the robot would stand with what was told last, and its links.
  const ContactModel& model() const { return model_; }

 private:
  struct Grip {
    std::size_t node;
    std::size_t joint;  // of the gripper
    double at = 0;      // where it is shown to stand
    double closes = 0;  // +1: larger positions close it
  };
  struct LeftThere {
    std::size_t node;
    Pose T_world_given, T_world_node;  // as the scene had it then, and where it was let go of
  };
  struct Still {
    JointValues from;
    Pose T_base_target;
    FollowStep step;
  };
  void stand_at(const JointValues& from);
  std::vector<double> heed_grip(const JointValues& positions);
  void tell_loose();
  void look_for_grip(const JointValues& asked);
  std::optional<std::size_t> between_jaws() const;
  Pose T_world_of(std::size_t node) const;
  std::vector<Pose> nodes() const;
  FollowStep told(const JointValues& from, const JointValues& asked, HandStep step);

  const HandOptions hand_;
  std::shared_ptr<const SceneModel> scene_;
  InverseKinematics kinematics_;
  ContactModel model_;
  std::unique_ptr<RobotShape> gate_;
  Pose T_world_base_;
  std::size_t tool_;                    // link
  std::vector<std::string> jaw_names_;  // of links that the grippers move
  std::vector<Pose> given_;             // T_world_node; empty: at rest
  std::optional<SlidingHand> sliding_;
  std::vector<std::size_t> loose_;  // parts of the model
  std::optional<Grip> grip_;
  std::vector<LeftThere> left_;
  HandStep last_;
  std::vector<NearPart> near_;
  std::optional<Still> still_;
};

}  // namespace foresight
