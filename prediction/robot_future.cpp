#include "prediction/robot_future.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kOtherClock = 60;         // s from now: no line is that slow
constexpr double kClockError = 0.1;        // s that an instant may seem to lie ahead
constexpr double kExact = 0.001;           // s (docs/conventions.md, time)
constexpr double kLongestLineGap = 0.2;    // s, likewise
constexpr double kBeyond = 0.05;           // s later than what is known for certain, while a line becomes faster
constexpr double kOften = 9, kSeldom = 5;  // s since a drive was identified first: often for so long, then as seldom
constexpr double kOutlasts = 0.9;          // of how long a set-point lasts once it came: a gap after which it may not
constexpr double kUnknownDelay = 0.02;     // s that a drive's response may be off before it was identified
constexpr double kAtEase = 0.1;            // of what is no more a matter of precision: surely nothing holds the joint
constexpr double kOtherDelay = 0.1;        // s: a line that became so much faster or slower is another one
constexpr double kLearntAfter = 0.35;      // s: until then reports have told how long what was on its way took
constexpr double kSettling = 5;            // s until the sigma of a drive just learnt is that of what was seen since
constexpr double kGoesOn = 0.5;            // s in which a robot that stopped is where it is expected again
constexpr double kHeldUnseen = 2;          // s that something may hold a joint before that is noticed, at most
constexpr double kAssumedPast = 0.4, kAssumedEvery = 0.02;  // s before the first set-point that is known
constexpr std::size_t kShown = 1024;

bool is_finite(const ReportedJoint& joint) {
  return std::isfinite(joint.position) && std::isfinite(joint.set_point.position) &&
         std::isfinite(joint.set_point.velocity);
}

bool near_now(RobotTime time, RobotTime now, double ahead) {
  const double age = to_seconds(now - time);
  return age >= -ahead && age <= kOtherClock;
}

// By how much a straight line between positions that are `gap` apart may be off, as twice a sigma.
double interpolation_sigma(double acceleration, double gap) {
  return acceleration * gap * gap / 16;
}

}  // namespace

void RobotFuture::Doubt::see(double time, bool doubtful, double after) noexcept {
  if (doubtful == doubted) agreed = time;
  if (time - agreed < after) return;
  doubted = doubtful;
  agreed = time;
}

RobotFuture::RobotFuture(RobotFutureOptions options, RobotShape* shape)
    : options_(std::move(options)),
      motion_(options_.gate, shape, options_.motion),
      gaps_(options_.stale),
      shown_ones_(kShown),
      scored_(kShown) {
  options_.responses.resize(options_.gate.joints.size());
  for (std::size_t i = 0; i < options_.gate.joints.size(); ++i) {
    const GateJoint& joint = options_.gate.joints[i];
    JointResponseOptions response;
    response.known = options_.responses[i];
    response.farthest = options_.motion.farthest + options_.stale + kBeyond;  // obstacle() tells what is too far
    response.first_sigma = (response.known ? response.known->sigma : kUnknownDelay) * joint.limits.velocity;
    Joint& added = joints_.emplace_back();
    added.response = JointResponse(response);
    added.precise = options_.astray_share * joint.following_error;
    added.least_sure = options_.unsure_share * joint.following_error;
    added.fastest = joint.limits.velocity;
  }
}

HistoryFault RobotFuture::sent(const SentSetPoint& set_point, RobotTime now) noexcept {
  if (set_point.joints != joints_.size()) return HistoryFault::wrong_joint_count;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (!std::isfinite(set_point.position[i])) return HistoryFault::not_finite;
  if (!near_now(set_point.sent, now, kClockError) || set_point.lasts > seconds(kOtherClock))
    return HistoryFault::other_clock;
  if (set_point.number <= sent_number_ || set_point.sent < sent_at_) return HistoryFault::out_of_order;
  sent_number_ = set_point.number;
  sent_at_ = set_point.sent;
  lasts_ = set_point.lasts;
  motion_.sent(set_point);
  return HistoryFault::none;
}

HistoryFault RobotFuture::check(const RobotReport& report, RobotTime now) const noexcept {
  if (report.joints != joints_.size()) return HistoryFault::wrong_joint_count;
  if (!std::isfinite(report.speed)) return HistoryFault::not_finite;
  for (std::size_t i = 0; i < joints_.size() && report.doing != GateDoing::away; ++i)
    if (!is_finite(report.joint[i])) return HistoryFault::not_finite;
  if (!near_now(report.time, now, kClockError)) return HistoryFault::other_clock;
  if (report.newest_set_point != 0 && !near_now(report.newest_came, now, kClockError)) return HistoryFault::other_clock;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (is_finite(report.joint[i]) && !near_now(report.joint[i].time, now, kClockError))
      return HistoryFault::other_clock;
  return report.time <= reported_ ? HistoryFault::out_of_order : HistoryFault::none;
}

HistoryFault RobotFuture::reported(const RobotReport& report, RobotTime now) noexcept {
  if (const HistoryFault fault = check(report, now); fault != HistoryFault::none) return fault;
  if (epoch_.ns == 0) {
    epoch_ = report.time;
    identified_at_ = 0;
  }
  const Shown before = any_shown_ ? predict(shown_) : Shown{};
  reported_ = report.time;
  now_ = std::max(now, now_);
  if (came_.ns != 0) gaps_.add(to_seconds(now_ - came_), since_epoch(now_));
  came_ = now_;
  doing_ = report.doing;
  if (doing_ != GateDoing::away) {
    const std::optional<ExpectedMotion::Change> change = motion_.reported(report, now);
    motion_.advance(now);
    if (change && change->restarted) begin_anew(change->after);
    feed(change ? change->after : fed_);
  }
  observe(report);
  identify();
  const Shown after = any_shown_ ? predict(shown_) : Shown{};
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (before.judged && after.judged) joints_[i].correction.jumped(after.predicted[i] - before.predicted[i]);
  score();
  return HistoryFault::none;
}

bool RobotFuture::overdue() const noexcept {
  const double waited = to_seconds(now_ - came_);
  if (waited <= std::max(options_.overdue, options_.overdue_gaps * gaps_.usual())) return false;
  const double outlasts = kOutlasts * (to_seconds(lasts_) - delay().seconds);
  return gaps_.chance_to_reach(outlasts, waited) > options_.overdue_chance;
}

void RobotFuture::advance(RobotTime now) noexcept {
  now_ = std::max(now, now_);
  if (reported_.ns == 0 || doing_ == GateDoing::away) return;
  motion_.advance(now);
  feed(fed_);
}

// The set-points until then are not known: as if each had come at the speed of the first that is.
void RobotFuture::begin_anew(RobotTime after) noexcept {
  const GateModel::State& first = motion_.cycles()[0];
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    joints_[i].response.begin_anew();
    for (double before = kAssumedPast; before > 0.5 * kAssumedEvery; before -= kAssumedEvery)
      joints_[i].response.command(since_epoch(after) - before,
                                  first.motion[i].position - before * first.motion[i].velocity);
  }
  fed_ = after;
}

// The responses get the set-points that are later than `after`.
void RobotFuture::feed(RobotTime after) noexcept {
  const ExpectedMotion::Cycles& cycles = motion_.cycles();
  if (after < fed_)
    for (Joint& joint : joints_) joint.response.forget_commands_after(since_epoch(after));
  std::size_t first = cycles.size();
  while (first > 0 && cycles[first - 1].time > after) --first;
  for (std::size_t k = first; k < cycles.size(); ++k)
    for (std::size_t i = 0; i < joints_.size(); ++i)
      joints_[i].response.command(since_epoch(cycles[k].time), cycles[k].motion[i].position);
  if (!cycles.empty()) fed_ = cycles.newest().time;
}

void RobotFuture::observe(const RobotReport& report) noexcept {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const ReportedJoint& told = report.joint[i];
    const double time = since_epoch(told.time);
    if (!std::isfinite(told.position) || !joint.measured.add(time, told.position)) continue;
    if (doing_ == GateDoing::away) continue;
    const bool typical = !joint.held.doubted && std::abs(joint.response.astray()) <= joint.precise;
    joint.response.observe(time, told.position, typical || !joint.response.learnt());
    const double off = std::abs(joint.response.astray());
    if (off <= kAtEase * joint.precise) joint.at_ease = time;
    const bool was_doubted = joint.held.doubted;
    joint.held.see(time, joint.response.learnt() && off > (joint.held.doubted ? 0.5 : 1) * joint.precise,
                   options_.astray_after);
    if (joint.held.doubted && !was_doubted) forget_hold(joint, time);
  }
}

// What began to hold the joint was not noticed at once.
void RobotFuture::forget_hold(Joint& joint, double noticed) noexcept {
  joint.response.forget_states_after(std::max(joint.at_ease, noticed - kHeldUnseen));
  joint.identified_first.reset();
  joint.identify_at = 0;
}

// One drive after the other, as each takes some milliseconds: the one that has waited longest. Nothing can be learnt of
// a drive before it has followed commands, however long it has been there.
void RobotFuture::identify() noexcept {
  const double now = since_epoch(came_), pause = options_.identify_every / static_cast<double>(joints_.size());
  if (doing_ == GateDoing::away || now - identified_at_ < pause) return;
  Joint& joint = *std::ranges::min_element(joints_, {}, &Joint::identify_at);
  if (now < joint.identify_at) return;
  identified_at_ = now;
  const bool was_identified = joint.response.identified();
  if (!joint.held.doubted && joint.response.identify() && !joint.identified_first) joint.identified_first = now;
  if (!was_identified && joint.response.identified()) joint.judged_from = shown_ + seconds(kSettling);
  const bool is_new = !joint.identified_first || now - *joint.identified_first < kOften;
  const double wait = is_new ? options_.identify_every : std::max(kSeldom, options_.identify_every);
  joint.identify_at = joint.response.identified() ? now + wait : now;
}

std::optional<double> RobotFuture::measured_until() const noexcept {
  std::optional<double> until;
  for (const Joint& joint : joints_) {
    if (joint.measured.empty()) return {};
    const double newest = joint.measured.values().newest().time;
    until = std::min(newest, until.value_or(newest));
  }
  return until;
}

bool RobotFuture::measured(double time, PredictedRobot& out) const noexcept {
  const std::optional<double> until = measured_until();
  if (!until || time > *until) return false;
  out.status = StateStatus::exact;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const PositionHistory& measured = joints_[i].measured;
    const double nearest = measured.nearest(time);
    if (!measured.covers(time, kLongestLineGap) && nearest > kExact) return false;
    out.position[i] = measured.at(time, std::numeric_limits<double>::infinity(), kLongestLineGap);
    if (nearest > kExact) out.status = StateStatus::interpolated;
    out.sigma[i] = nearest > kExact ? interpolation_sigma(options_.gate.joints[i].limits.acceleration, 2 * nearest) : 0;
  }
  return true;
}

void RobotFuture::fall_back(PredictedRobot& out, FutureReason reason, int joint) const noexcept {
  out.status = StateStatus::invalid;
  out.reason = reason;
  out.joint = joint;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    out.position[i] = joints_[i].measured.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                  : joints_[i].measured.values().newest().position;
    out.sigma[i] = std::numeric_limits<double>::infinity();
  }
}

// What there is no prediction for.
FutureReason RobotFuture::obstacle(RobotTime time, int& joint) const noexcept {
  if (now_ - came_ > seconds(options_.stale)) return FutureReason::stale;
  if (doing_ == GateDoing::away) return FutureReason::not_ready;
  if (motion_.follows_others()) return FutureReason::strangers;
  const double oldest = since_epoch(reported_) - options_.stale;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (joints_[i].measured.values().newest().time < oldest) {
      joint = static_cast<int>(i);
      return FutureReason::stale;
    }
  if (time <= motion_.known_until() + seconds(kBeyond)) return FutureReason::none;
  // After a gap reports come in a row, old ones first.
  const bool are_old = now_ + seconds(delay().seconds) > reported_ + seconds(options_.motion.farthest);
  return are_old ? FutureReason::stale : FutureReason::too_far;
}

// Why there is a prediction, but no trust in it.
FutureReason RobotFuture::doubt(const Shown& shown, int& joint) const noexcept {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (options_.gate.joints[i].keeps_grip) continue;
    joint = static_cast<int>(i);
    if (const FutureReason reason = doubt(shown, i); reason != FutureReason::none) return reason;
  }
  joint = -1;
  return FutureReason::none;
}

FutureReason RobotFuture::doubt(const Shown& shown, std::size_t joint) const noexcept {
  if (joints_[joint].held.doubted || joints_[joint].missed.doubted) return FutureReason::astray;
  // Most times that reports are overdue the robot goes on: pixels are in doubt, the view as a whole is not yet. Nor is
  // it where set-points are held up: what is shown is the likelier of two.
  if (shown.scale[joint] * std::hypot(shown.prior[joint], shown.stopped[joint]) <= joints_[joint].least_sure)
    return FutureReason::none;
  return shown.overdue ? FutureReason::stale : FutureReason::unsure;
}

// Jaws that hold something stand elsewhere than they are asked to for as long as they do, and carry neither tool nor
// camera: they alone are shown as they were measured.
void RobotFuture::fall_back_jaws(Shown& shown) const noexcept {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (!options_.gate.joints[i].keeps_grip || doubt(shown, i) == FutureReason::none) continue;
    shown.robot.position[i] = joints_[i].measured.values().newest().position;
    shown.robot.sigma[i] = std::numeric_limits<double>::infinity();
  }
}

bool RobotFuture::predict(std::size_t joint, Shown& out) const noexcept {
  const RobotTime time = out.robot.time;
  const Joint& of = joints_[joint];
  const PredictedPosition there = of.response.at(since_epoch(time));
  if (!there.valid) return false;
  const double beyond = std::max(0.0, to_seconds(time - motion_.known_until()));
  // Whether it has is not told by any scale that was learnt while reports came.
  if (out.overdue) out.stopped[joint] = there.position - of.response.at(since_epoch(reported_)).position;
  const double stops = motion_.stop_chance();
  if (const SentSetPoint* asked = motion_.newest_at(time); stops > 0 && asked != nullptr)
    out.held_up[joint] = std::sqrt(stops * (1 - stops)) * (asked->position[joint] - there.position);
  out.predicted[joint] = out.robot.position[joint] = there.position;
  out.prior[joint] = std::hypot(there.sigma, beyond * motion_.cycles().newest().motion[joint].velocity);
  out.scale[joint] = of.scale.sigma();
  out.robot.sigma[joint] = out.sigma(joint);
  const bool is_new = of.response.identified() && time <= of.judged_from;
  out.settling[joint] = !of.response.identified() || is_new;
  out.robot.settling = out.robot.settling || there.assumed || is_new;
  return true;
}

RobotFuture::Shown RobotFuture::predict(RobotTime time) const noexcept {
  Shown out;
  PredictedRobot& robot = out.robot;
  robot.time = time;
  robot.joints = joints_.size();
  const std::optional<double> until = measured_until();
  int joint = -1;
  FutureReason reason = FutureReason::none;
  if (!until)
    reason = FutureReason::no_state;
  else if (since_epoch(time) <= *until)
    reason = measured(since_epoch(time), robot) ? FutureReason::none : FutureReason::hole;
  else
    reason = obstacle(time, joint);
  if (reason != FutureReason::none) fall_back(robot, reason, joint);
  if (reason != FutureReason::none || since_epoch(time) <= *until) return out;
  robot.status = StateStatus::predicted;
  out.overdue = overdue();
  // While all rests, all is right.
  robot.settling = std::ranges::none_of(joints_, [](const Joint& one) { return one.response.identified(); });
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (predict(i, out)) continue;
    fall_back(robot, FutureReason::too_far, static_cast<int>(i));
    return out;
  }
  out.judged = true;
  out.delay = motion_.delay().seconds;
  const GateModel::State* cycle = motion_.cycle_at(time);
  if (cycle == nullptr) cycle = &motion_.cycles().newest();
  robot.blocked = cycle->blocked;
  out.doing = cycle->doing;
  if (const FutureReason doubtful = doubt(out, joint); doubtful != FutureReason::none)
    fall_back(robot, doubtful, joint);
  else
    fall_back_jaws(out);
  return out;
}

PredictedRobot RobotFuture::at(RobotTime time) const noexcept {
  return predict(time).robot;
}

PredictedRobot RobotFuture::show(RobotTime time) noexcept {
  Shown shown = predict(time);
  const bool goes_on = any_shown_ && shown.judged;
  const double passed = goes_on ? std::max(0.0, to_seconds(time - shown_)) : 0;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    if (!goes_on || shown.robot.status != StateStatus::predicted || std::isinf(shown.robot.sigma[i])) {
      joint.correction.forget();
      continue;
    }
    joint.correction.pass(passed, joint.fastest);
    shown.robot.position[i] += joint.correction.offset();
    shown.prior[i] = std::hypot(shown.prior[i], joint.correction.offset());
    shown.robot.sigma[i] = shown.sigma(i);
  }
  shown_ = time;
  any_shown_ = shown.judged;
  if (!shown.judged) return shown.robot;
  const std::size_t before = shown_ones_.size();
  shown_ones_.next() = shown;
  if (shown_ones_.size() == before && compared_ > 0) --compared_;  // the oldest is gone
  return shown.robot;
}

RobotTime RobotFuture::instant_to_show(RobotTime now) noexcept {
  constexpr double kSlowest = 0.9, kFastest = 1.1, kTooFar = 1;  // of real time; s
  const RobotTime wanted = now + seconds(delay().seconds);
  const double passed = instant_ ? to_seconds(now - instant_asked_) : 0;
  const bool clock_goes_on = passed >= 0 && passed < kTooFar;
  instant_asked_ = now;
  if (!instant_ || !clock_goes_on || std::abs(to_seconds(wanted - *instant_)) > kTooFar) {
    instant_ = std::max(wanted, instant_.value_or(wanted));
  } else {
    const double step = std::clamp(to_seconds(wanted - *instant_), kSlowest * passed, kFastest * passed);
    const RobotTime farthest = std::max(*instant_, wanted + seconds(kBeyond));
    instant_ = std::min(*instant_ + seconds(step), farthest);
  }
  return *instant_;
}

void RobotFuture::score() noexcept {
  const std::optional<double> until = measured_until();
  if (!until) return;
  for (; compared_ < shown_ones_.size() && since_epoch(shown_ones_[compared_].robot.time) <= *until; ++compared_)
    compare(shown_ones_[compared_]);
  for (; compared_ > 0 && since_epoch(shown_ones_[0].robot.time) <= *until - kLearntAfter; --compared_) {
    learn(shown_ones_[0]);
    shown_ones_.drop_oldest();
  }
}

// The gate did something else than was expected, as a stop where set-points stay away, or did it sooner or later, as
// the line became another; or a report of that cannot have come yet. That tells nothing of how well drives are known.
void RobotFuture::look_for_surprise(const Shown& shown) noexcept {
  const GateModel::State* was = motion_.cycle_at(shown.robot.time);
  const bool in_time = std::abs(motion_.delay().seconds - shown.delay) < kOtherDelay;
  if (in_time && (was == nullptr || was->doing == shown.doing)) return;
  const double time = since_epoch(shown.robot.time);
  const bool goes_on = surprise_ && time < surprise_over();
  surprise_ =
      goes_on ? Surprise{std::min(surprise_->from, time), std::max(surprise_->last, time)} : Surprise{time, time};
}

bool RobotFuture::was_surprised(RobotTime time) const noexcept {
  const double at = since_epoch(time);
  return surprise_ && at >= surprise_->from && at < surprise_over();
}

/// Of the one that there is.
double RobotFuture::surprise_over() const noexcept {
  return surprise_->last + kGoesOn + 2 * motion_.delay().seconds;
}

double RobotFuture::Shown::error(std::size_t joint, const JointValues& truth) const noexcept {
  const bool as_shown = trusted() && std::isfinite(robot.sigma[joint]);
  return std::abs((as_shown ? robot.position[joint] : predicted[joint]) - truth[joint]);
}

void RobotFuture::compare(const Shown& shown) noexcept {
  PredictedRobot truth;
  const double time = since_epoch(shown.robot.time);
  if (!measured(time, truth)) return;
  look_for_surprise(shown);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const double usual = std::max(joint.precise, 3 * shown.sigma(i));
    // What a line loses is shown wrongly until the report of it has come: a way there and back.
    const double blind = joint.missed.doubted ? 0 : 2 * motion_.delay().seconds;
    joint.missed.see(time, shown.error(i, truth.position) > usual, options_.missed_after + blind);
  }
  if (shown.trusted()) scored_.next() = {shown.robot, truth.position};
}

/// How well drives are known, once it has shown whether the line was as it had been thought to be.
void RobotFuture::learn(const Shown& shown) noexcept {
  PredictedRobot truth;
  const double time = since_epoch(shown.robot.time);
  if (!measured(time, truth)) return;
  const double passed = std::clamp(time - learnt_at_, 0.0, 1.0);
  learnt_at_ = time;
  look_for_surprise(shown);
  if (was_surprised(shown.robot.time)) return;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (shown.settling[i]) continue;
    const double part = shown.error(i, truth.position) / shown.any_prior(i);
    joints_[i].scale.score(CalibratedSigma::usual_part(part, shown.scale[i]), shown.scale[i], passed);
  }
}

std::optional<ScoredRobot> RobotFuture::take_scored() noexcept {
  if (scored_.empty()) return {};
  const ScoredRobot oldest = scored_[0];
  scored_.drop_oldest();
  return oldest;
}

}  // namespace foresight
