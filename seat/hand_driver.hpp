// Hands at devices as the seat's driver: what the window and the devices say becomes set-points.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/priority_mutex.hpp"
#include "gl/glfw_window.hpp"
#include "input/any_tracker.hpp"
#include "input/force.hpp"
#include "input/hand_control.hpp"
#include "input/keyboard_mouse.hpp"
#include "seat/hand_sight.hpp"
#include "seat/seat_driver.hpp"
#include "seat/seat_words.hpp"

namespace foresight {

/// What a rig has beside its arm.
struct DrivenParts {
  bool gripper = true, head = true;
};
DrivenParts driven_parts(const Rig& rig);

/// tick() in the seat's thread, all else in the window's.
class HandDriver final : public SeatDriver {
 public:
  /// Keyboard and mouse, and `devices`: whichever has its switch held drives, and feels what the tool leans on if it
  /// can push (ForceSink). `rig` must outlive this. `scene`: what stands around the arm, which then stops and slides
  /// where it would touch (contact_guard.hpp); null: nothing is known of it. Throws what hand_options() and
  /// ContactGuard do.
  explicit HandDriver(const Rig& rig, std::vector<std::unique_ptr<Tracker>> devices = {},
                      std::shared_ptr<const SceneModel> scene = nullptr);

  /// Since the last call; at each round of the window, or nothing drives: who does not see the robot move must not move
  /// it, and the key that stops it is the window's. A switch that was held before the first one has to be let go of.
  void take(const gl::WindowInput& input, OperatorTime now);
  /// The camera that the operator looks through: directions are meant as he sees them.
  void look_from(const Pose& T_world_camera);
  /// The operator looks through a head display, whose space lies there in the world: a hand that is tracked in it moves
  /// the tool the way it moves in the picture. Nothing: he looks at a window.
  void look_within(const std::optional<Pose>& T_world_space);
  /// The robot has to be driven anew: whoever holds a switch lets go of it first. Static text.
  void interrupt(const char* trouble, const char* cure);
  /// Nodes of the scene that the hand may push aside.
  void may_push(std::span<const std::string> nodes);
  /// Where the nodes of the scene are shown.
  void scene_stands(std::span<const Pose> T_world_node);
  void ask(LineRequest request);
  void toggle_control();
  void hand_over();

  /// What keeps the hand from driving, and which devices are missing, for the head-up display.
  std::vector<SeatLine> lines() const;
  /// What there is to see of the hand.
  HandSight sight() const;
  /// From the last event of keyboard or mouse until it was in a set-point; nothing before the first.
  std::optional<Duration> input_took() const;
  const HandOptions& options() const { return options_; }
  /// Of keyboard and mouse, for what there is to drive.
  static std::vector<std::pair<std::string, std::string>> keys(const DrivenParts& parts);

  SeatWish tick(const SeatView& view) override;

 private:
  void cycle(const SeatView& view);
  void heed_window(OperatorTime now);
  HandContact contact() const;
  void feel(OperatorTime now);

  const Rig& rig_;
  mutable PriorityMutex mutex_;  // all below
  const HandOptions options_;
  std::unique_ptr<ContactGuard> guard_;
  HandControl hand_;
  KeyboardMouse keyboard_;
  std::vector<std::unique_ptr<Tracker>> devices_;
  AnyTracker any_;
  struct Pushing {
    const Tracker* device;
    BoundedForce force;
  };
  std::vector<Pushing> pushing_;
  Pose T_world_camera_ = Pose::Identity();
  std::optional<Pose> T_world_space_;
  std::optional<TrackerState> interruption_;  // of the next cycle
  std::vector<LineRequest> requests_;
  SeatWish wish_;
  std::optional<OperatorTime> looked_, cycled_, event_;  // event_: of the oldest event that no cycle has taken yet
  std::optional<Duration> input_took_;
  bool control_ = true, hand_over_ = false, handed_over_ = false;
  bool interrupted_ = false;  // in the last cycle
};

}  // namespace foresight
