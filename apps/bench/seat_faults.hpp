// Faults at a seat and at its robot, made one after the other, and whether the display names each.
#pragma once

#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "apps/bench/seat_hand.hpp"
#include "apps/operator/seat_trial.hpp"
#include "seat/seat_words.hpp"

namespace foresight {

/// What can fail, and the lines of the head-up display that have to tell.
struct Fault {
  std::string name;
  double seconds = 0;               ///< that it lasts; 0: it is an event
  std::vector<std::string> labels;  ///< one of these lines has to be marked while it lasts, or soon after
  std::function<void(const SeatMoment&, bool begins)> make;
  std::function<bool(const SeatMoment&)> would_show{};  ///< else there is nothing to tell; empty: it always would
  std::string words{};                                  ///< that such a line has to have; "": any
  std::optional<double> lets_go_within{};               ///< s after its begin the switch must have ceased to count
};

/// Of a rig's robot side in stepped time; `stands`: set while the operator's program stands still. Which drive fails is
/// drawn from `random` each time. Both must outlive the faults.
std::vector<Fault> seat_faults(std::size_t drives, std::mt19937& random, bool& stands);

/// Of the devices in the operator's hand, which must outlive the faults.
std::vector<Fault> hand_faults(SeatHand& hand, std::mt19937& random);

/// Another robot's program in the place of the seat's own. One thread.
class Strangers {
 public:
  /// `rig`: of the seat, and of its robot; must outlive this.
  explicit Strangers(const Rig& rig) : rig_(rig) {}

  enum class Kind : std::uint8_t { other_joints, other_model, other_lenses };
  void come(SteppedRobotSide& robot, Kind kind);
  void go(SteppedRobotSide& robot);  ///< the seat's own is back
  /// One is there that the seat must not drive. With other lenses it may, once it is told.
  bool must_rest() const { return must_rest_; }

 private:
  const Rig& rig_;
  bool must_rest_ = false;
};

/// Of the robot's program: ended, started again, of another robot.
std::vector<Fault> start_faults(Strangers& strangers);

/// What became of one.
struct FaultRecord {
  std::string name;
  double at_s = 0;
  std::string named;  ///< what the display said of it; "" nothing
  double after_s = 0;
  std::optional<double> let_go_s;  ///< when the switch ceased to count, after its begin; nothing: it did not
  bool drove_on = false;           ///< for longer than Fault::lets_go_within
};

/// Makes them by chance, one at a time, each once before any comes again: each begins 15 to 45 s after the one before
/// has ended. One thread.
class FaultMaker {
 public:
  /// `told_within`: the display's lines may be so late, s.
  FaultMaker(std::vector<Fault> faults, std::mt19937& random, double told_within);

  /// After each cycle; `lines` are asked for only while a fault is to be named.
  void step(const SeatMoment& moment, double now_s, const std::function<std::vector<SeatLine>()>& lines);
  const std::vector<FaultRecord>& records() const { return records_; }

 private:
  void begin(const SeatMoment& moment, double now_s, const std::function<std::vector<SeatLine>()>& lines);
  void heed_switch(const SeatMoment& moment, double now_s);
  void look(const SeatMoment& moment, double now_s, const std::vector<SeatLine>& lines);
  std::size_t draw();

  std::vector<Fault> faults_;
  std::vector<std::size_t> left_;  // that are still to come in this round
  std::size_t in_vain_ = 0;        // draws since the last one that began
  std::mt19937& random_;
  double told_within_, next_s_ = 0, looked_s_ = 0;
  const Fault* now_ = nullptr;
  bool lasts_ = false;
  std::vector<FaultRecord> records_;
};

}  // namespace foresight
