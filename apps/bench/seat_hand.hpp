// A program's hand at the devices of a seat: what it means to do goes the way of a person's hand.
//
//   ScriptedDriver --joints that are meant--> SeatHand --its hand's moves--> controller, gamepad
//                                                                                    |
//                                      set-points <-- HandControl <-- HandDriver <---'
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/bench/pretended_gamepad.hpp"
#include "display/frame_source.hpp"
#include "display/head/head_hands.hpp"
#include "seat/hand_driver.hpp"

namespace foresight {

/// What a tracked controller does while it lasts.
enum class ControllerFault : std::uint8_t {
  none,
  off,          ///< it has gone
  not_seen,     ///< its tracker does not see it
  frozen,       ///< it says nothing any more, its switch held
  late,         ///< what it says was captured a second ago
  no_number,    ///< its pose is none
  other_clock,  ///< its instants are of another clock
};

/// Drives by a tracked controller under a head display, each third time by a gamepad. One thread.
class SeatHand {
 public:
  /// `rig` must outlive this. Throws what HandDriver and PretendedGamepad do.
  SeatHand(const Rig& rig, std::shared_ptr<const SceneModel> scene);

  /// What becomes of what is meant: the wish of the product's own driver.
  SeatWish pass_on(const SeatView& view, const SeatWish& meant);
  /// The view that was drawn last.
  void look(const ViewPlace& place);
  /// The lines of the display that the driver has.
  std::vector<SeatLine> lines() const { return driver_.lines(); }

  /// The switch that is held, or was last, is the gamepad's.
  bool at_gamepad() const { return at_gamepad_; }
  void fail(ControllerFault fault) { fault_ = fault; }
  /// All at once, and it stays there.
  void jump_hand(const Pose& by) { T_space_hand_ = by * T_space_hand_; }
  void plug_gamepad(bool in) { gamepad_.plug(in); }

 private:
  std::vector<std::unique_ptr<Tracker>> devices() const;
  Pose tool(const JointValues& positions) const;
  void go_by_controller(const Pose& from, const Pose& to);
  void go_by_gamepad(const Pose& from, const Pose& to, double dt);
  TrackerState controller(const SeatView& view, const SeatWish& meant) const;
  double look_rate(const std::optional<std::size_t>& joint, const SeatWish& meant) const;

  const Rig& rig_;
  PretendedGamepad gamepad_;
  std::shared_ptr<head::HeldControllers> controllers_ = std::make_shared<head::HeldControllers>();
  HandDriver driver_;
  Pose T_world_space_ = Pose::Identity();   // of the head display
  Pose T_space_hand_ = Pose::Identity();    // in truth
  Pose T_world_camera_ = Pose::Identity();  // that the gamepad's sticks are meant by
  ControllerFault fault_ = ControllerFault::none;
  PadSticks sticks_;
  bool at_gamepad_ = false;
  int presses_ = 0;
  std::optional<Pose> T_base_tool_;  // that was meant last, while the switch is held
  std::optional<OperatorTime> last_;
  SeatWish sent_;
};

}  // namespace foresight
