// The operator's end of the line: everything that comes from the robot, and what goes back.
//
//   /foresight/frames, /foresight/pieces --> PairIntake --> frames()         in a thread of its own, as decoding takes
//                                               '--> /foresight/reports        milliseconds
//   control, robot's state <--> ControlSeat, RobotState                      in another one, every few milliseconds
#pragma once

#include <deque>
#include <mutex>
#include <thread>

#include "common/bounded_queue.hpp"
#include "common/priority_mutex.hpp"
#include "common/suspension.hpp"
#include "link/control_wire/control_lines.hpp"
#include "link/operator_side/pair_intake.hpp"

namespace foresight::link {

struct OperatorEndOptions {
  ControlSeatOptions seat;  ///< who this is
  Expected expected = {};   ///< names and sizes by the rig of this side; empty: any
  bool frames = true;       ///< pairs are wanted: of a robot that codes for one reader, this asks to be that one
  std::size_t room = 2;     ///< pairs that wait to be taken; > 0
  SuspensionWatch::Asleep asleep = SuspensionWatch::machine_asleep;  ///< of this host
};

/// What is known of a line, for people.
struct LineFigures {
  std::optional<Duration> round_trip;   ///< the last
  std::optional<OffsetInterval> clock;  ///< the robot's minus ours
  std::uint64_t clock_jumps = 0;
  std::string coding;      ///< of the pairs that came; "" before the first
  Duration lasted{0};      ///< from the arrival of the first pair to that of the last
  double pairs_per_s = 0;  ///< of the last kRateOver
  IntakeCounts pairs;
  std::uint64_t samples_lost = 0;  ///< messages of pairs that DDS knows it has lost
  std::uint64_t refused = 0;       ///< messages of any topic that are none, or say what cannot be
  std::string refusal;             ///< the last of them, with its topic
  std::deque<BoundedDelay> ages;   ///< on their arrival, since capture: of the last pairs of this start of the robot
};

/// frames(), seat(), robot_state() and figures() from any thread. start() gives it threads; step() does the same in the
/// caller's. `participant` and `clock` must outlive it.
class OperatorEnd {
 public:
  static constexpr std::size_t kMostAges = 1000, kMostMotions = 256;
  static constexpr Duration kRateOver = std::chrono::seconds(5);

  /// Throws RuntimeFailure where this program's certificate does not permit to write what an operator writes.
  OperatorEnd(Participant& participant, const OperatorEndOptions& options, Clock& clock);
  ~OperatorEnd() { stop(); }

  /// Whole pairs; take_newest() is what a display wants. Closed once this has stopped.
  BoundedQueue<LineFramePtr>& frames() { return queue_; }

  /// `use(seat, now)` in the caller's thread, while nothing else touches the seat: to command, to ask, to look.
  template <typename Use>
  auto seat(Use&& use) {
    const std::lock_guard lock(seat_mutex_);
    return use(seat_, OperatorTime{clock_.now().ns});
  }
  struct HeardState {
    RobotState state;
    OperatorTime came;
    std::optional<BoundedTime<OperatorClock>> time;  ///< RobotState::time_ns on our clock
  };
  OperatorTime now() const { return {clock_.now().ns}; }
  /// The robot's newest; nothing before the first.
  std::optional<HeardState> robot_state() const;
  struct HeardMotion {
    GateMotion motion;
    OperatorTime came;
  };
  /// What came since the last call, oldest first; of the newest kMostMotions.
  std::vector<HeardMotion> take_motions();
  LineFigures figures() const;
  /// The clocks, as they are known now.
  RobotClockTracker robot_clock() const;

  void start();
  void stop() noexcept;
  void step();

 private:
  struct Pictures {
    Pictures(Participant& participant, const OperatorEndOptions& options, const Clock& clock);
    PairIntake intake;
    Reader pieces, pairs;
    Writer reports;
  };
  void run_control(const std::stop_token& stop);
  void run_frames(const std::stop_token& stop);
  void step_control();
  void step_frames();
  void hand_out(LineFramePtr frame, const char* coding);

  const Participant& participant_;
  Clock& clock_;
  const Expected expected_;

  // Of the control thread, but for what is locked.
  SeatLine line_;
  Reader states_, motions_;
  mutable PriorityMutex seat_mutex_;  // seat_
  ControlSeat seat_;
  SuspensionWatch suspension_;
  mutable PriorityMutex heard_mutex_;  // robot_clock_, heard_, heard_motions_
  RobotClockTracker robot_clock_;
  std::optional<HeardState> heard_;
  std::deque<HeardMotion> heard_motions_;

  // Of the frames' thread, but for what is locked.
  std::optional<Pictures> pictures_;  // where they are wanted
  mutable std::mutex figures_mutex_;  // what follows, but for the queue
  LineFigures figures_;
  std::optional<OperatorTime> first_;  // pair
  std::deque<OperatorTime> arrivals_;  // of pairs within kRateOver
  std::uint64_t session_ = 0;          // of the last pair

  BoundedQueue<LineFramePtr> queue_;
  std::jthread frames_thread_, control_thread_;
};

}  // namespace foresight::link
