// What the two sides tell each other about control. Plain values; whoever carries them may lose, double, delay and
// reorder them, or play them again another day.
//
//   operator                                      robot
//      Hello{who I am}             --->
//                                  <---           Welcome{who I am, what differs}         both draw random numbers, and
//      ClockPing, ClockPong       <--->           ClockPing, ClockPong                    name both in all that follows
//      Ask                         --->
//                                  <---           LeaseVerdict{granted: the lease} or {who holds it}
//                                  <---           ControlState{holder, consent, joints}   many times a second
//      SetPoint{lease, consent}    --->                                                   many times a second
//      Request{id}                 --->           executed once
//                                  <---           Answer{id}
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "common/time.hpp"
#include "link/clocks/clock_tracker.hpp"
#include "link/control/identity.hpp"

namespace foresight {

/// A random number that names one start of a program, one lease, one consent. 0: none.
using Nonce = std::uint64_t;

inline constexpr std::size_t kMostLineJoints = 16;
using LinePositions = std::array<double, kMostLineJoints>;  ///< rad or m, in the robot's order

// From the operator.

/// Until a Welcome comes, and again when the robot's answers stay away.
struct Hello {
  Identity identity;
};
/// May I command? Repeated, with the same number, until a LeaseVerdict comes.
struct Ask {
  std::uint64_t number = 0;
};
/// What was asked for up to this number is not wanted any more.
struct GiveBack {
  std::uint64_t number = 0;
};
/// From who holds the lease, to one that asks for it.
struct HandOver {
  Nonce lease = 0;
  Nonce to = 0;  ///< that one's `from`
};
/// Where the robot shall be. Sent many times a second, the switch held or not: the newest counts.
struct SetPoint {
  Nonce lease = 0;
  /// ControlState::consent as it was when the switch was pressed: who pressed before the robot stopped has not agreed
  /// to go on.
  Nonce consent = 0;
  std::uint64_t sequence = 0;  ///< grows strictly
  OperatorTime given;
  Duration lasts{0};     ///< from `given` on; the robot allows less where it thinks so
  bool deadman = false;  ///< the switch is held
  std::size_t joints = 0;
  LinePositions position{};
};
enum class LineRequest : std::uint8_t { none, enable, disable, home, reset, set_up, emergency_stop };
/// A set-point that was taken, as the robot's side knows it.
struct TakenSetPoint {
  Nonce from = 0;              ///< the envelope's
  std::uint64_t sequence = 0;  ///< 0: none
  RobotTime came;
};
/// Repeated, with the same id, until an Answer comes. An emergency stop needs neither lease nor consent nor haste, and
/// is repeated by the next connection, too: with the same id and the same `given`, by which it is known to the robot.
struct Request {
  std::uint64_t id = 0;  ///< grows strictly
  LineRequest what = LineRequest::none;
  Nonce lease = 0;
  Nonce consent = 0;  ///< the newest that was known
  OperatorTime given;
  Duration lasts{0};
};

// From the robot.

/// To whom said Hello. `from` of the envelope is what all later messages to the robot are addressed to.
struct Welcome {
  Nonce robot = 0;  ///< this start of the robot's program; the sender of its states
  Identity identity;
  std::vector<Difference> differences;
};
struct LeaseVerdict {
  std::uint64_t number = 0;  ///< of the Ask
  Nonce lease = 0;           ///< 0: refused
  std::string words;         ///< why, and what to do
};
enum class RequestOutcome : std::uint8_t {
  taken,       ///< handed to the robot, now or before; its state shows what comes of it
  expired,     ///< came too late
  overtaken,   ///< a later one came first
  not_holder,  ///< only who holds the lease may
  before_stop  ///< was asked for before a loss or a stop was known to the operator
};
struct Answer {
  std::uint64_t id = 0;
  RequestOutcome outcome = RequestOutcome::taken;
};
/// Why nothing moves on behalf of the line; `none` while something does.
enum class RestCause : std::uint8_t {
  none,
  nobody,         ///< nobody holds the lease
  granted,        ///< the lease is new
  let_go,         ///< the switch is open
  expired,        ///< no set-point came in time
  paused,         ///< the robot's program stood still
  clock_jumped,   ///< one of the hosts' clocks
  blind,          ///< the operator's side has not seen the robot for a while
  robot_stopped,  ///< the safety gate no longer follows
};
/// Why the last set-point that was not followed was not.
enum class SetPointFault : std::uint8_t {
  none,
  no_lease,
  out_of_order,
  malformed,        ///< joints are missing, or are no numbers
  clock_unknown,    ///< no round trip yet
  from_the_future,  ///< by more than the clocks' uncertainty
  expired,
  no_consent,    ///< the switch was pressed before the last stop was known
  not_let_go,    ///< the open switch was not seen since
  elsewhere,     ///< does not begin where the robot stands
  robot_is_busy  ///< not ready, still braking, or somebody else commands
};
/// To all, unasked.
struct ControlState {
  std::uint64_t sequence = 0;  ///< grows strictly
  RobotTime time;
  Nonce holder = 0, asking = 0;  ///< their `from`; 0: nobody
  std::string holder_name, asking_name;
  Nonce consent = 0;  ///< what presses of the switch must have known; another one after each loss
  RestCause cause = RestCause::nobody;
  SetPointFault fault = SetPointFault::none;
  Duration life{0};         ///< how long set-points may last
  Duration delay{0};        ///< of the holder's set-points, the middle of what is possible
  Duration delay_doubt{0};  ///< in either direction
  bool ready = false;       ///< would follow somebody who presses the switch now
  std::size_t joints = 0;
  LinePositions measured{}, set_point{};
  LinePositions begin{};  ///< where an operator's set-points begin: as measured, but what grips keeps its grip
};

/// `from` and `to` are drawn at random by their owners. In a Hello and a ControlState `to` is 0.
template <typename Body>
struct Envelope {
  Nonce from = 0, to = 0;
  Body body;
};
using FromOperator = Envelope<std::variant<Hello, ClockPing, ClockPong, Ask, GiveBack, HandOver, SetPoint, Request>>;
using FromRobot = Envelope<std::variant<Welcome, ClockPing, ClockPong, LeaseVerdict, Answer, ControlState>>;

}  // namespace foresight
