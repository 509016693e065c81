// Whether the robot may follow what comes over the line, and how long.
//
//   at rest --the open switch seen, then pressed with the present consent, where the robot stands--> following
//   following --opened, expired, paused, a clock jumped, the robot stopped, the lease over--> at rest
//
// After a loss the consent is another one. A press of the switch names the consent that it knew, so one from before the
// loss, however late it comes, moves nothing, and neither does a switch that was held all the time.
#pragma once

#include <functional>

#include "link/control/messages.hpp"
#include "link/control/set_point_life.hpp"

namespace foresight {

/// The operator's clock, seen from the robot.
using OperatorClockTracker = ClockTracker<RobotClock, OperatorClock>;
/// Draws a number that does not come again; never 0.
using DrawNonce = std::function<Nonce()>;
/// The machine's own random numbers. Tests take seeded ones.
DrawNonce machine_nonces();

/// The robot, as the line's side of it sees it. A plain value.
struct RobotView {
  bool ready = false;    ///< at rest, nobody commands it, would follow
  bool follows = false;  ///< follows what motion() last said
  std::size_t joints = 0;
  LinePositions measured{}, set_point{};
  LinePositions begin{};  ///< where an operator's set-points should begin
  LinePositions reach{};  ///< how far from there they may begin
};

/// What the robot is to do.
struct LineMotion {
  enum class What : std::uint8_t {
    nothing,  ///< no command
    open,     ///< the switch was seen open just now
    follow    ///< `position`, but not after `until`
  };
  What what = What::nothing;
  /// Another one after each loss: what was followed before must not be followed on, and the open switch be seen anew.
  std::uint64_t round = 0;
  RobotTime until;
  LinePositions position{};
};

/// Of whoever holds the lease. One thread; does not allocate after construction.
class MotionPermit {
 public:
  static constexpr Duration kPause = std::chrono::milliseconds(100);

  MotionPermit(SetPointLifeOptions life, DrawNonce draw);

  /// A new lease, or none (0).
  void begin(Nonce lease, RobotTime now);
  /// `clock`: of who sent it.
  SetPointFault take(const SetPoint& what, const OperatorClockTracker& clock, RobotTime now, const RobotView& robot);
  /// Time has passed: whether anything came or not. More than kPause between two is a pause.
  void advance(RobotTime now, const RobotView& robot);
  /// Nothing is followed any more, and what was agreed to is void.
  void withdraw(RestCause why);

  LineMotion motion(RobotTime now) const;
  Nonce lease() const { return lease_; }
  Nonce consent() const { return consent_; }
  RestCause cause() const { return cause_; }
  Duration life() const { return life_.life(); }
  /// Of the last set-point that came in order.
  BoundedDelay delay() const { return delay_; }
  bool following() const { return following_; }

 private:
  SetPointFault judge(const SetPoint& what, const OperatorClockTracker& clock, RobotTime now);
  SetPointFault may_follow(const SetPoint& what, const RobotView& robot) const;
  SetPointFault press(const SetPoint& what, RobotTime now, const RobotView& robot);
  void see_open();
  void watch(RobotTime now, const RobotView& robot);

  SetPointLife life_;
  DrawNonce draw_;
  Nonce lease_ = 0, consent_ = 0;
  RestCause cause_ = RestCause::nobody;
  std::uint64_t sequence_ = 0, round_ = 0;
  bool following_ = false;
  bool live_ = false;                            // the newest set-point, pressed or open, has not expired
  bool seen_open_ = false;                       // since the last loss, and since the last press that was refused
  bool pressed_ = false;                         // as the newest says
  SetPointFault refused_ = SetPointFault::none;  // why this press moves nothing
  RobotTime expires_;                            // of the newest
  LinePositions position_{};
  RobotTime advanced_;
  RobotTime followed_;  // when the robot last followed, or was told to
  BoundedDelay delay_;
};

}  // namespace foresight
