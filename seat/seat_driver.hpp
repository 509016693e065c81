// Who drives at an operator's seat: hands at devices, a script, a test.
#pragma once

#include <string>

#include "input/hand_control.hpp"
#include "link/control/control_seat.hpp"
#include "link/messages/foresight_messages.hpp"
#include "prediction/robot_future.hpp"

namespace foresight {

/// What a driver is told each time.
struct SeatView {
  OperatorTime now;
  ControlSeatStatus control;
  HandRobot robot;  ///< as far as its newest state tells; unknown where that is too old
  /// The switch counts. Where it is held and does not, the robot was lost meanwhile: let go, and press again.
  bool engaged = false;
  /// Where the robot is shown: at the instant at which what is commanded now acts.
  PredictedRobot shown;
};

struct SeatWish {
  bool deadman = false;    ///< the switch is held
  bool refused = false;    ///< it is held, but cannot count until it was let go of
  JointValues position{};  ///< with it: where the robot shall be, rad or m, in the rig's order
  LineRequest request = LineRequest::none;
  bool control = true;     ///< wants to be the one who commands
  bool hand_over = false;  ///< to who asks for it
};

/// One thread: the seat's.
class SeatDriver {
 public:
  virtual ~SeatDriver() = default;
  virtual SeatWish tick(const SeatView& view) = 0;
};

}  // namespace foresight
