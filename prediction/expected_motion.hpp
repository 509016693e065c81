// The set-points of a robot's joints, those that its gate made and those that it will make of what is on its way.
//
//   sent      |  |  |  |  |  |  |  |  |  |now                                   s: set-points of the operator
//   robot   ----- reported -----T- - - expected by GateModel - - - now + delay
//
// Each report says where the gate truly was; where that is what was expected, nothing changes, else all cycles after it
// are made anew from there. When set-points act is known as far as the line's delay is (line_delay); those that should
// have come by a report, and have not, are held up for as long as such gaps of the line usually last.
#pragma once

#include <optional>

#include "prediction/gate_model.hpp"
#include "prediction/last_of.hpp"
#include "prediction/line_delay.hpp"
#include "prediction/line_gaps.hpp"

namespace foresight {

struct ExpectedMotionOptions {
  double tolerance = 2e-5;   ///< rad or m: a set-point that is so near is what was expected
  double sooner = 5e-4;      ///< s: a line that became so much faster or slower is another one
  double anew_every = 0.04;  ///< s: not more often, as it takes 30 ms of CPU time for a second of ten joints
  double farthest = 3;       ///< s after the newest report that cycles are expected for
  double longest_gap = 1;    ///< s that no set-point comes: what is longer counts as that
  double keeps = 5;          ///< s of cycles, and of set-points that are sent 200 times a second
  LineDelayOptions line;
};

/// One thread. Allocates at the start only; no method but the constructor throws.
class ExpectedMotion {
 public:
  using Cycles = LastOf<GateModel::State>;

  /// As GateModel's.
  ExpectedMotion(GateOptions gate, RobotShape* shape, const ExpectedMotionOptions& options = {});

  /// A set-point is sent. It must be one that fits (RobotFuture checks).
  void sent(const SentSetPoint& set_point) noexcept;
  struct Change {
    RobotTime after;         ///< cycles later than this are others than before
    bool restarted = false;  ///< and nothing is known of those until then
  };
  /// A report came at `now`; it fits, and is later than the one before. What that changes; nothing where all is as
  /// expected.
  std::optional<Change> reported(const RobotReport& report, RobotTime now) noexcept;
  /// Makes the cycles that nothing that is sent from `now` on can change any more.
  void advance(RobotTime now) noexcept;

  /// The newest cycles, ascending; empty before the first report.
  const Cycles& cycles() const noexcept { return cycles_; }
  /// The one at that instant, or half a period beside it; null: none.
  const GateModel::State* cycle_at(RobotTime time) const noexcept;
  /// When a set-point that is sent now will act, after now; and how sure that is.
  PredictedDelay delay() const noexcept { return delay_; }
  /// No cycle later than this is expected yet.
  RobotTime known_until() const noexcept { return known_until_; }
  /// How probable it is that the robot stops as set-points stay away that should have come: 0 where they come.
  double stop_chance() const noexcept { return stop_chance_; }
  /// The set-point that acts then if none is held up; null: none.
  const SentSetPoint* newest_at(RobotTime time) const noexcept;
  /// The gate follows set-points that were never told here: somebody else's.
  bool follows_others() const noexcept { return follows_others_; }

 private:
  std::size_t first_after(std::uint64_t number) const noexcept;
  const SentSetPoint* find(std::uint64_t number) const noexcept;
  void learn_delay(const RobotReport& report, RobotTime now) noexcept;
  void learn_overtaking(const RobotReport& report) noexcept;
  void learn_lateness(const RobotReport& report) noexcept;
  void learn_gaps(const RobotReport& report) noexcept;
  double missing(const RobotReport& report) const noexcept;
  double deviation(const RobotReport& report, const GateModel::State& expected) const noexcept;
  GateModel::State state_of(const RobotReport& report, const GateModel::State* expected) const noexcept;
  void correct_past(const RobotReport& report) noexcept;
  void begin_anew(const RobotReport& report, bool restarted) noexcept;
  void cycle() noexcept;

  ExpectedMotionOptions options_;
  GateModel gate_;
  Duration period_;
  LastOf<SentSetPoint> sent_;
  Cycles cycles_;
  std::size_t next_ = 0;  // of sent_: the first that was not looked at
  LineDelay line_;
  PredictedDelay line_delay_, delay_;
  Duration acts_after_{};        // the delay by which the cycles were made
  double late_ = 0;              // s that a set-point which has come waits until the gate takes it
  double overtaken_ = 0;         // s by which the gate's newest set-point is older than one that takes the line's delay
  LineGaps gaps_;                // of set-points
  double gap_ = 0;               // s that none came, of those that should have
  std::uint64_t gap_after_ = 0;  // the set-point before it
  double stop_chance_ = 0;
  RobotTime held_until_;
  std::uint64_t newest_told_ = 0;
  RobotTime confirmed_, reported_, known_until_, made_anew_, epoch_;
  bool follows_others_ = false;
};

}  // namespace foresight
