// The robot that will be: where its joints are at any instant up to the one at which a set-point that is sent now acts.
//
//   set-points sent --> ExpectedMotion: the gate's own steps --> JointResponse: each drive --> joints, how sure
//                            ^ where the gate was                     ^ encoders
//   reports ----------------'----------------------------------------'-----> what was shown is scored and corrected
//
// What is shown never jumps: corrections flow in (correction_blend.hpp). What it was shown for is compared with it once
// the encoders have told, and the uncertainty is kept such that the truth lies within twice of it in 95 % of cases
// (calibrated_sigma.hpp). Where the robot cannot be predicted, that is said, and why; never a guess.
//
// Units: rad (m for joints that slide). All instants are of the robot's clock.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "prediction/correction_blend.hpp"
#include "prediction/expected_motion.hpp"
#include "prediction/joint_response.hpp"
#include "prediction/line_gaps.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Why a state is invalid.
enum class FutureReason : std::uint8_t {
  none,
  no_state,   ///< nothing came of the robot yet
  stale,      ///< nothing came for too long, or what comes is too old, of the robot or of one joint
  not_ready,  ///< it does not follow set-points: without torque, enabling, looking for home
  strangers,  ///< it follows set-points that are not known here
  too_far,    ///< later than a set-point that is sent now acts
  hole,       ///< nothing is known of about that instant
  astray,     ///< a joint keeps being elsewhere than predicted: contact, load, drift
  unsure,     ///< a joint's uncertainty is too large to be of use
};

/// Where all joints are at an instant.
struct PredictedRobot {
  RobotTime time;
  StateStatus status = StateStatus::invalid;
  FutureReason reason = FutureReason::none;  ///< of `invalid`
  int joint = -1;                            ///< the one that is the reason, or -1
  std::size_t joints = 0;
  /// Where `invalid`: as last measured, to fall back on (not a number before that).
  JointValues position{};
  /// The truth lies within twice of it in 95 % of cases; 0 where exact; infinite where invalid, and for jaws
  /// (GateJoint::keeps_grip) that cannot be predicted, as they hold something: these alone are as last measured then.
  JointValues sigma{};
  /// Some sigma is wider than it will be: it rests on what is assumed of a drive that moves, or was learnt but now; or
  /// nothing was learnt of any drive yet.
  bool settling = false;
  bool blocked = false;  ///< the gate will keep the robot from where it is asked to be: parts would come too close
};
/// In words, and what to do; "" where it is not invalid. `names`: of the joints.
std::string to_words(const PredictedRobot& robot, std::span<const std::string> names);

/// What was shown for an instant, and where the robot was then.
struct ScoredRobot {
  PredictedRobot shown;
  JointValues truth{};
};

struct RobotFutureOptions {
  GateOptions gate;
  std::vector<std::optional<KnownResponse>> responses = {};  ///< of the joints' drives; none: of none
  double stale = 1;                                          ///< s without a report beyond the line's delay
  /// s without a report, and as often as long as 95 % of the reports keep the seat waiting, after which the robot may
  /// have stopped where the newest one told of it: what keeps reports away keeps set-points away. Not where such gaps
  /// have ended in time of late: all but for this share, before the set-points that it has are outlasted.
  double overdue = 0.1, overdue_gaps = 3, overdue_chance = 0.2;
  double astray_share = 0.125;  ///< of a joint's largest following error, that is no more a matter of precision
  double astray_after = 0.2;    ///< s that it lasts before it counts, and that it is gone before it does not
  double missed_after = 0.5;    ///< likewise, of what was shown, beyond the line's delay there and back
  double unsure_share = 0.5;    ///< of a joint's largest following error, that its sigma must not exceed
  double identify_every = 1;    ///< s, for each joint until 9 s after it was identified first; then 5 s at least
  ExpectedMotionOptions motion;
};

/// One thread. Allocates at the start only; no method but the constructor throws.
class RobotFuture {
 public:
  /// Throws InputError where the gate's options contradict themselves. `shape` may be null, is nobody else's, outlives
  /// this.
  RobotFuture(RobotFutureOptions options, RobotShape* shape);

  /// A set-point is sent at `now`. Taken, or why not.
  HistoryFault sent(const SentSetPoint& set_point, RobotTime now) noexcept;
  /// A report came at `now`. Taken, or why not; those that were overtaken are out_of_order.
  HistoryFault reported(const RobotReport& report, RobotTime now) noexcept;
  /// Time has come to `now`, which never goes back; after sent() and reported() of this instant.
  void advance(RobotTime now) noexcept;

  /// Where the robot is at `time`, by all that is known now.
  PredictedRobot at(RobotTime time) const noexcept;
  /// The same for the picture of `time`, not before the one before: without jumps, and scored once the truth is known.
  PredictedRobot show(RobotTime time) noexcept;
  /// The instant to show now: when a set-point that is sent now acts. It goes on evenly, at 0.9 to 1.1 of real time,
  /// while the line changes; where a line became so much faster that nothing is known of it yet, it waits.
  RobotTime instant_to_show(RobotTime now) noexcept;
  PredictedDelay delay() const noexcept { return motion_.delay(); }

  /// Whether the gate did then something else than was expected when that instant was shown, or did it sooner or later
  /// as the line became another; as far as reports tell, and for so long as the robot may still be elsewhere for that.
  bool was_surprised(RobotTime time) const noexcept;

  /// What was shown and is known now, oldest first; only of what was not invalid. Kept for a few seconds.
  std::optional<ScoredRobot> take_scored() noexcept;
  /// Of the drives, as far as they were identified.
  const ResponseFigures& figures(std::size_t joint) const noexcept { return joints_[joint].response.figures(); }

 private:
  static constexpr double kLeastScale = 1e-3;
  // Whether something is so, by what was seen for a while.
  struct Doubt {
    bool doubted = false;
    double agreed = 0;  // s: when what was seen last agreed with it
    void see(double time, bool doubtful, double after) noexcept;
  };
  struct Joint {
    JointResponse response;
    PositionHistory measured{2048};
    // Of the response's sigma. How right what was assumed of a drive, or learnt of its first motion, was tells nothing
    // of later sigmas: what was shown for later instants than judged_from, if any, does.
    CalibratedSigma scale{1, kLeastScale, 5, CalibratedSigma::kScaleOfOne};
    RobotTime judged_from;
    CorrectionBlend correction;
    double precise = 0;  // what is farther off is no more a matter of precision
    double least_sure = 0;
    double fastest = 0;
    double identify_at = 0;  // s: not before that
    std::optional<double> identified_first;
    double at_ease = 0;  // s: when it was surely where its commands put it
    Doubt held, missed;  // it is not where its commands put it; it was not where it was predicted
  };
  struct Shown {
    PredictedRobot robot;
    bool overdue = false;     // reports are
    bool judged = false;      // there is a prediction, whether it can be trusted or not
    JointValues predicted{};  // that one
    JointValues prior{}, scale{};
    JointValues stopped{};              // how far from there it is if it has stopped
    JointValues held_up{};              // how far off it may be as set-points are held up
    GateDoing doing = GateDoing::away;  // what the gate was expected to do then
    double delay = 0;                   // s, of what was sent
    double sigma(std::size_t joint) const noexcept {
      return std::hypot(scale[joint] * prior[joint], stopped[joint], held_up[joint]);
    }
    double any_prior(std::size_t joint) const noexcept {
      return std::hypot(prior[joint], stopped[joint], held_up[joint]);
    }
    bool trusted() const noexcept { return robot.status == StateStatus::predicted; }
    double error(std::size_t joint, const JointValues& truth) const noexcept;
    std::array<bool, std::tuple_size_v<JointValues>> settling{};
  };
  HistoryFault check(const RobotReport& report, RobotTime now) const noexcept;
  double since_epoch(RobotTime time) const noexcept { return to_seconds(time - epoch_); }
  void begin_anew(RobotTime after) noexcept;
  void feed(RobotTime after) noexcept;
  void observe(const RobotReport& report) noexcept;
  static void forget_hold(Joint& joint, double noticed) noexcept;
  void identify() noexcept;
  void score() noexcept;
  void compare(const Shown& shown) noexcept;
  void learn(const Shown& shown) noexcept;
  void look_for_surprise(const Shown& shown) noexcept;
  double surprise_over() const noexcept;
  std::optional<double> measured_until() const noexcept;
  bool measured(double time, PredictedRobot& out) const noexcept;
  Shown predict(RobotTime time) const noexcept;
  /// One joint of it; false: too far ahead.
  bool predict(std::size_t joint, Shown& out) const noexcept;
  bool overdue() const noexcept;
  FutureReason obstacle(RobotTime time, int& joint) const noexcept;
  FutureReason doubt(const Shown& shown, int& joint) const noexcept;
  FutureReason doubt(const Shown& shown, std::size_t joint) const noexcept;
  void fall_back_jaws(Shown& shown) const noexcept;
  void fall_back(PredictedRobot& out, FutureReason reason, int joint) const noexcept;

  RobotFutureOptions options_;
  ExpectedMotion motion_;
  std::vector<Joint> joints_;
  RobotTime epoch_, now_, reported_, came_, fed_, shown_, sent_at_;
  LineGaps gaps_;
  Duration lasts_{};  // the newest set-point
  std::uint64_t sent_number_ = 0;
  GateDoing doing_ = GateDoing::away;
  bool any_shown_ = false;
  std::optional<RobotTime> instant_;
  RobotTime instant_asked_;
  double identified_at_ = 0, learnt_at_ = 0;
  struct Surprise {
    double from, last;  // s: the gate did something else than was expected
  };
  std::optional<Surprise> surprise_;  // the last one
  LastOf<Shown> shown_ones_;          // that are not learnt of yet
  std::size_t compared_ = 0;          // so many of these
  LastOf<ScoredRobot> scored_;
};

}  // namespace foresight
