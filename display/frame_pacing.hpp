// When to wake, draw and swap, so that a frame shows what is newest and is there when the display takes it.
//
//      swap    rest: for all other work     wake    look, draw   swap by the target
//   -----x--------------------------------------|=================:--x-------
//        |<------------------- interval ---------------------------->|
//                                               '<--- cost ----->' reserve
//
// Instants come in, instants go out; nothing waits here, and the same instants give the same answers.
#pragma once

#include <vector>

#include "common/time.hpp"

namespace foresight {

struct FramePacingOptions {
  double rate_hz = 30;  ///< of frames; on a display the nearest rate that its refreshes allow; > 0
  Duration reserve = std::chrono::microseconds(1500);  ///< that a drawing is to be finished before the target
  double quantile = 0.9;                               ///< of the drawings' costs that is counted on
};

enum class PacingPhase : std::uint8_t {
  own_clock,  ///< swaps do not wait for a display
  probing,    ///< they may: frames end at different phases, to see whether swaps still end at the same one
  locked,     ///< targets are refreshes of the display
};

struct PacingFigures {
  std::uint64_t frames = 0;
  std::uint64_t late = 0;  ///< swapped more than half an interval (locked: half a refresh) after their target
  Duration cost{0};        ///< of a drawing, as it is counted on
  Duration last{0};        ///< of the last drawing
  Duration refresh{0};     ///< of the display; 0: not known
  PacingPhase phase = PacingPhase::own_clock;
};

/// For each frame: sleep until wake(), look and draw, drawn(), swap, swapped(). A sleep that ends late counts as part
/// of the drawing's cost: the next one is to begin sooner. One thread. Instants may repeat (a clock that stands) but
/// not go back.
class FramePacing {
 public:
  FramePacing(const FramePacingOptions& options, RobotTime now);

  /// When the next frame is to begin: never before the last one was swapped.
  RobotTime wake() const { return wake_; }
  /// When it shall have been swapped; grows from frame to frame.
  RobotTime target() const { return target_; }

  void drawn(RobotTime now);  ///< the GPU has finished, the swap begins
  /// `rest`: that other work is to have before the next frame, which is later for it where need be
  /// (SliceBudget::rest_due); of that, no more than an interval or a drawing lasts.
  void swapped(RobotTime now, Duration rest = Duration{0});

  /// Something else than a frame has kept the display's thread until `now`: that is no drawing's cost.
  void held_up(RobotTime now) { plan(now, Duration{0}); }

  /// Another screen, or another mode of it: what was learnt of refreshes is forgotten.
  void display_changed();

  PacingFigures figures() const;

 private:
  struct Swap {
    RobotTime begin, end;
  };
  Duration expected_cost() const;
  void plan(RobotTime now, Duration rest);
  void learn(const Swap& swap);
  void look_for_display();
  bool lock_to(const std::vector<Swap>& swaps);
  void follow(const Swap& swap);
  Duration off_grid(RobotTime at) const;

  FramePacingOptions options_;
  Duration interval_;
  std::vector<double> costs_;  // ns, the last ones, in a ring
  std::size_t next_cost_ = 0;
  RobotTime wake_, target_, drawn_;
  std::vector<Swap> swaps_;  // of this phase
  PacingPhase phase_ = PacingPhase::own_clock;
  std::uint64_t unlocked_for_ = 0;  // frames since a probe found no display
  bool probed_ = false;
  RobotTime anchor_;  // a refresh
  double refresh_ns_ = 0, found_ns_ = 0;
  std::vector<bool> strayed_;  // the last swaps that waited: off the grid?
  std::size_t without_wait_ = 0;
  PacingFigures figures_;
};

}  // namespace foresight
