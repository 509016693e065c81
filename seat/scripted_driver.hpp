// An operator who is a program: starts the robot over the line, presses the switch, follows a motion, lets go.
//
//   wanting control --> enabling --> homing --> ready --> pressed, moving --> done
//                                                 ^            |
//                                                 '-- lost ----'  lets go, waits, presses again: goes on from there;
//                                                                 likewise where it is shown not to follow
//
// It knows what comes over the line and nothing else.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "seat/seat_driver.hpp"

namespace foresight {

/// A motion that is asked for step by step. One thread.
class ScriptedMotion {
 public:
  virtual ~ScriptedMotion() = default;
  /// The robot stands at `begin` and will follow from now on; also after a loss.
  virtual void begin_at(const JointValues& begin) = 0;
  /// Where it shall be `dt` seconds after the step before; `shown`: where it is shown. Nothing: the motion has ended.
  virtual std::optional<JointValues> step(double dt, const PredictedRobot& shown) = 0;
  /// Where the display shows a node of the scene at the moment, in the world; nothing: it does not. Called in the
  /// thread of step().
  using Sees = std::function<std::optional<Pose>(const std::string& node)>;
  virtual void look_by(Sees /*sees*/) {}
};

struct ScriptedDriverOptions {
  bool may_home = true;                                   ///< consents to homing
  Duration open_before = std::chrono::milliseconds(300);  ///< the switch is seen open so long before each press
  Duration gives_up_after = std::chrono::seconds(600);    ///< without having driven
  int most_losses = 100;
};

/// What became of a script so far.
struct ScriptState {
  bool driving = false, done = false;
  std::string failure = {};  ///< "" where all is well
  int losses = 0;            ///< that it went on after
};

/// One thread.
class ScriptedDriver final : public SeatDriver {
 public:
  ScriptedDriver(ScriptedMotion& motion, const ScriptedDriverOptions& options = {});
  /// The robot as it says it is; nothing before the first.
  using RobotSays = std::function<std::optional<link::RobotState>()>;
  void listen_to(RobotSays says) { says_ = std::move(says); }

  SeatWish tick(const SeatView& view) override;
  ScriptState state() const { return {driving_, done(), failure_, losses_}; }
  bool done() const { return done_ || !failure_.empty(); }

 private:
  LineRequest request(const SeatView& view);
  void press(const SeatView& view);
  void lose(const std::string& why);
  void drive(const SeatView& view, SeatWish& wish);

  ScriptedMotion& motion_;
  ScriptedDriverOptions options_;
  RobotSays says_;
  std::optional<OperatorTime> first_, opened_, last_;
  OperatorTime followed_;  // when it was shown last where it is commanded to be, or as good as that
  std::optional<OperatorTime> asked_;
  LineRequest request_ = LineRequest::none;
  bool driving_ = false, done_ = false;
  int losses_ = 0;
  double driven_s_ = 0;
  JointValues target_{};
  std::string failure_;
};

}  // namespace foresight
