// The operator's side of control over the line: finds the robot, asks for the lease, sends set-points and requests.
//
//   connecting --Welcome--> connected --LeaseVerdict: granted--> holding --the state names another holder--> connected
//       ^---------------- no answer for long, or another start of the robot ---------------------'
//
// It agrees to motion with each press of the switch, by the consent that the robot's newest state asks for. What comes
// later, such as a robot that stopped meanwhile, needs another press: it never agrees by itself.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "link/control/messages.hpp"
#include "link/control/motion_permit.hpp"

namespace foresight {

/// The robot's clock, seen from the operator.
using RobotClockTracker = ClockTracker<OperatorClock, RobotClock>;

struct ControlSeatOptions {
  Identity identity;  ///< the operator's
  DrawNonce draw;
  /// Who looks at a robot as it was longer ago does not agree to any motion.
  Duration oldest_state = std::chrono::seconds(1);
  /// A robot that does not answer for longer is looked for anew.
  Duration answered_within = std::chrono::seconds(2);
  std::string place;  ///< where the robot is looked for (LinkConfig::place()), for messages; or ""
};

struct ControlSeatStatus {
  enum class Phase : std::uint8_t { connecting, connected, holding };
  Phase phase = Phase::connecting;
  bool wanted = false;  ///< control is asked for, or held; not any more once it was handed over
  /// The robot follows what is sent, as far as its newest state tells.
  bool follows = false;
  /// The switch is held but moves nothing: it must be let go of and pressed again.
  bool must_let_go = false;
  std::string words, cure;              ///< what keeps the robot from following; "" where nothing does
  std::vector<Difference> differences;  ///< of the two sides
  std::optional<Duration> state_age;    ///< of the newest state, since it came
  /// A robot is silent then: states come every 0.2 s on the thinnest of lines (link/robot_side/line_share.hpp).
  static constexpr Duration kSilentAfter = std::chrono::milliseconds(500);
};

/// How a request went.
struct RequestFate {
  std::uint64_t id = 0;
  LineRequest what = LineRequest::none;
  /// Nothing: no answer came, it was given up. The robot may have taken it: see its state.
  std::optional<RequestOutcome> outcome;
};

/// Pure logic: does not wait. One thread.
class ControlSeat {
 public:
  explicit ControlSeat(ControlSeatOptions options);

  void receive(const FromRobot& message, OperatorTime now);
  /// Every 10 ms or so. A quarter of a second without is a pause, or a leap of our clock: then all begins anew, as if
  /// the program had just been started.
  void advance(OperatorTime now);
  /// This host was suspended for so long: its clock stood still. All begins anew, too.
  void stood_still(Duration asleep);
  /// What to send, oldest first; each once.
  std::vector<FromOperator> take_outgoing();

  /// Asks for the lease, again and again; or gives it back.
  void want_control(bool wanted);
  /// While holding: to who asks for it now. False: nobody does.
  bool hand_over();
  /// The id by which its fate is known later. An emergency stop is repeated for half a minute, however often the robot
  /// has to be found anew meanwhile. Until it is answered its operator's switch counts as open, and what else he asks
  /// for waits. Other requests are given up with their connection.
  std::uint64_t request(LineRequest what, OperatorTime now);
  /// Each once.
  std::vector<RequestFate> take_fates();
  /// Where the robot shall be, many times a second, the switch held or not. With the switch, positions begin at
  /// begin(), or the robot does not follow. What was sent; nothing where nobody would take it.
  std::optional<SetPoint> command(OperatorTime now, const LinePositions& position, bool deadman);

  /// Where set-points have to begin: the robot, by its newest state.
  const LinePositions& begin() const { return state_.begin; }
  /// The newest; its sequence is 0 before the first.
  const ControlState& state() const { return state_; }
  ControlSeatStatus status(OperatorTime now) const;
  const RobotClockTracker& clock() const { return clock_; }
  /// By which the robot's side knows this start of the program: its messages' `from`.
  Nonce session() const { return session_; }

 private:
  struct Open {
    Request request;
    OperatorTime since;  // when it was made, however long this host was suspended meanwhile
    OperatorTime sent;   // to the present desk; 0: not yet
    bool stops() const { return request.what == LineRequest::emergency_stop; }
  };
  void take(const FromRobot& message, const Welcome& welcome, OperatorTime now);
  void take(const ClockPing& ping, OperatorTime now);
  void take(const ClockPong& pong, OperatorTime now);
  void take(const LeaseVerdict& verdict, OperatorTime now);
  void take(const Answer& answer);
  void take_state(const ControlState& state, OperatorTime now);
  void connect(OperatorTime now);
  void ask(OperatorTime now);
  void send_requests(OperatorTime now);
  void give_up_requests(OperatorTime now);
  void give_up(const Open& open);
  void make_room();
  bool stops() const;
  void withdraw() { agreed_ = 0; }
  void begin_anew();
  void drop_requests();
  bool sees_robot(OperatorTime now) const;
  template <typename Body>
  void send(Body body);

  ControlSeatOptions options_;
  Nonce session_;
  Nonce robot_ = 0;  // the start of its program
  Nonce desk_ = 0;   // what it wants to be called by us; 0: not connected
  RobotClockTracker clock_;
  std::vector<Difference> differences_;
  OperatorTime not_understood_;  // when a robot of another version of the protocol was heard last
  ControlState state_;
  bool state_timely_ = false;  // it was not too old when it came
  OperatorTime state_came_, answered_, greeted_, asked_, advanced_;
  bool wanted_ = false;
  std::uint64_t ask_number_ = 0;
  bool verdict_came_ = false;
  Nonce lease_ = 0;
  std::string refused_;
  Nonce agreed_ = 0;  // the consent that the present press has seen; 0: none
  bool held_ = false;
  std::uint64_t sequence_ = 0, request_id_ = 0;
  std::vector<Open> open_;
  std::vector<RequestFate> fates_;
  std::vector<FromOperator> out_;
};

}  // namespace foresight
