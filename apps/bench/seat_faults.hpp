// Faults at a seat and at its robot, made one after the other, and whether the display names each.
#pragma once

#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

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
};

/// Of a rig's robot side in stepped time; `stands`: set while the operator's program stands still. Which drive fails is
/// drawn from `random` each time. Both must outlive the faults.
std::vector<Fault> seat_faults(std::size_t drives, std::mt19937& random, bool& stands);

/// What became of one.
struct FaultRecord {
  std::string name;
  double at_s = 0;
  std::string named;  ///< what the display said of it; "" nothing
  double after_s = 0;
};

/// Makes them by chance, one at a time: each begins 15 to 45 s after the one before has ended. One thread.
class FaultMaker {
 public:
  /// `told_within`: the display's lines may be so late, s.
  FaultMaker(std::vector<Fault> faults, std::mt19937& random, double told_within);

  /// After each cycle; `lines` are asked for only while a fault is to be named.
  void step(const SeatMoment& moment, double now_s, const std::function<std::vector<SeatLine>()>& lines);
  const std::vector<FaultRecord>& records() const { return records_; }

 private:
  void look(const SeatMoment& moment, double now_s, const std::vector<SeatLine>& lines);

  std::vector<Fault> faults_;
  std::mt19937& random_;
  double told_within_, next_s_ = 0, looked_s_ = 0;
  const Fault* now_ = nullptr;
  bool lasts_ = false;
  std::vector<FaultRecord> records_;
};

}  // namespace foresight
