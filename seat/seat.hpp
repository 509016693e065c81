// An operator's seat without its window: what is commanded goes over the line and into the prediction.
//
//   SeatDriver --wish--> Seat --set-points, requests--> OperatorEnd ))) line ((( robot
//                          '--> RobotOutlook <--what the gate did-- OperatorEnd
//
// The switch counts from a press on until it is let go of, or the robot is lost: by the line, the gate, another holder.
// After that nothing moves until the driver lets go and presses again, and then the motion begins where the robot is.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "common/priority_mutex.hpp"
#include "link/operator_side/operator_end.hpp"
#include "seat/robot_outlook.hpp"
#include "seat/seat_driver.hpp"

namespace foresight {

/// The seat at one moment, for people.
struct SeatStatus {
  ControlSeatStatus control;
  ControlState robot_control;             ///< who holds the lease, delay of set-points
  std::optional<link::RobotState> robot;  ///< what the robot says of itself
  std::optional<Duration> robot_age;      ///< of that, since it came
  link::LineFigures line;
  PredictedDelay delay;  ///< of what is commanded
  OutlookFigures outlook;
  PredictedRobot shown;                ///< the last
  bool held = false, engaged = false;  ///< the switch is held; it counts
  bool refused = false;                ///< SeatWish::refused
  std::vector<RequestFate> fates;      ///< of the last requests, oldest first
};

/// show() and status() from any thread; start() gives it one of its own, or step() does the same in the caller's.
class Seat {
 public:
  static constexpr Duration kSetPointEvery = std::chrono::milliseconds(20);

  /// All must outlive this. Throws what RobotOutlook does.
  Seat(const Rig& rig, link::OperatorEnd& end, SeatDriver& driver, Clock& clock);
  ~Seat() { stop(); }

  /// Its thread asks for real-time priority: "", or why that was refused (make_real_time()). Set-points are late then
  /// where the machine is busy, and the robot stops between them.
  std::string start();
  void stop() noexcept;
  void step();
  /// From now on the switch counts as open, whatever the driver says. Any thread.
  void let_go();

  /// Where the robot is to be shown now; `at`: at an instant of its clock, at most the one it is now to be shown for.
  /// While its clock is not known, as after another start of its program: where it was shown last, as invalid.
  PredictedRobot show(std::optional<RobotTime> at = std::nullopt);
  /// The instant of the robot's clock to show now; nothing while the clocks have not met.
  std::optional<RobotTime> instant_to_show();
  /// As RobotFuture::was_surprised().
  bool was_surprised(RobotTime time) const;
  /// Where it would be shown now; nothing is remembered of that.
  PredictedRobot look_ahead();
  SeatStatus status() const;
  /// As RobotOutlook::learnt_responses().
  std::vector<std::string> learnt_responses() const;
  /// Where the robot will be between what is known of it and what was shown last: what it does because it was sent
  /// already. At most `count` (>= 2) instants, evenly, oldest first; those that cannot be told are left out.
  std::vector<PredictedRobot> under_way(std::size_t count) const;

 private:
  std::optional<RobotTime> robot_now() const;
  SeatView look(std::optional<RobotTime> now);
  void command(const SeatWish& wish, OperatorTime now);
  void heed_switch(const SeatWish& wish, const SeatView& view);

  const Rig& rig_;
  link::OperatorEnd& end_;
  SeatDriver& driver_;
  Clock& clock_;
  mutable PriorityMutex mutex_;  // all below
  RobotOutlook outlook_;
  PredictedRobot shown_;
  bool held_ = false, refused_ = false, engaged_ = false, followed_ = false, ended_ = false;
  OperatorTime commanded_;
  LineRequest asked_ = LineRequest::none;
  std::vector<RequestFate> fates_;
  std::jthread thread_;
};

/// Whoever leaves its scope, by an exception too, first lets go of the seat's switch, for long enough that the robot
/// hears of it, and then stops the seat: what is destroyed after that may take its time.
class SeatEnd {
 public:
  /// Both must outlive this.
  SeatEnd(Seat& seat, Clock& clock) : seat_(seat), clock_(clock) {}
  ~SeatEnd();
  SeatEnd(const SeatEnd&) = delete;

 private:
  Seat& seat_;
  Clock& clock_;
};

}  // namespace foresight
