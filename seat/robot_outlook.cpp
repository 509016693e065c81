#include "seat/robot_outlook.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kOthers = ~std::uint64_t{0};
constexpr std::size_t kErrorsKept = 300;

RobotFutureOptions future_options(const Rig& rig) {
  RobotFutureOptions out;
  out.gate = rig.gate_options();
  for (const RigJoint& joint : rig.joints) {
    auto& known = out.responses.emplace_back();
    if (joint.response) known = {joint.response->dead_time_s, joint.response->lag_s, joint.response->sigma_s};
  }
  return out;
}

/// As MotionPermit does it: a press that may not move the robot takes back that the switch was seen open. One that may
/// is no rest any more, and the gate follows a cycle later at the earliest.
bool is_let_go(const ControlState& state) {
  switch (state.fault) {
    case SetPointFault::no_consent:
    case SetPointFault::not_let_go:
    case SetPointFault::elsewhere:
    case SetPointFault::robot_is_busy: return false;
    default: return state.cause == RestCause::let_go || state.cause == RestCause::none;
  }
}

}  // namespace

RobotReport robot_report(const link::GateMotion& motion, Nonce commander) {
  RobotReport out;
  out.time = {motion.time_ns};
  out.doing = static_cast<GateDoing>(motion.doing);
  out.speed = motion.speed;
  if (motion.set_point != 0) out.newest_set_point = motion.commander == commander ? motion.set_point : kOthers;
  out.newest_came = {motion.set_point_came_ns};
  out.joints = std::min(motion.joints.size(), kMostJoints);
  for (std::size_t i = 0; i < out.joints; ++i) {
    const link::GateMotionJoint& from = motion.joints[i];
    ReportedJoint& to = out.joint[i];
    to.time = out.time - std::chrono::microseconds(from.told_us);
    if (from.known) to.position = from.position;
    to.set_point = {from.set_point, from.velocity, from.acceleration};
  }
  return out;
}

RobotOutlook::RobotOutlook(const Rig& rig) : rig_(rig), shape_(rig.shape()) {
  begin_anew();
}

void RobotOutlook::begin_anew() {
  future_ = std::make_unique<RobotFuture>(future_options(rig_), shape_.get());
  newest_.reset();
  permit_.reset();
  now_ = {};
  errors_.clear();
  figures_.error.reset();
}

void RobotOutlook::count(HistoryFault fault, const char* what) {
  if (fault == HistoryFault::none || fault == HistoryFault::out_of_order) return;
  ++figures_.refused;
  figures_.refusal = std::string(what) + ": " + to_string(fault);
}

void RobotOutlook::hear(const link::GateMotion& motion, Nonce commander, RobotTime now) {
  if (motion.session != session_) {
    if (session_ != 0) begin_anew();
    session_ = motion.session;
    ++figures_.robots;
  }
  RobotReport report = robot_report(motion, commander);
  report.permit = permit_;
  const HistoryFault fault = future_->reported(report, std::max(now, now_));
  count(fault, "a report of the robot");
  if (fault == HistoryFault::none) newest_ = report;
}

void RobotOutlook::hear(const ControlState& state, Nonce commander) {
  if (state.sequence == 0) return;
  const bool ours = state.holder == commander;
  permit_ = {state.time, ours ? state.consent : 0, ours && is_let_go(state)};
}

void RobotOutlook::sent(const SetPoint& set_point, RobotTime now) {
  SentSetPoint sent;
  sent.number = set_point.sequence;
  sent.sent = std::max(now, now_);
  sent.lasts = set_point.lasts;
  sent.deadman = set_point.deadman;
  sent.joints = set_point.joints;
  sent.position = set_point.position;
  sent.consent = set_point.consent;
  count(future_->sent(sent, sent.sent), "a set-point");
}

void RobotOutlook::advance(RobotTime now) {
  if (now_.ns != 0 && now < now_ - kClockJump) begin_anew();
  now_ = std::max(now_, now);
  future_->advance(now_);
  score();
}

std::vector<std::string> RobotOutlook::learnt_responses() const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < rig_.joints.size(); ++i)
    if (const ResponseFigures& figures = future_->figures(i); figures.samples > 0)
      out.push_back(rig_.joints[i].drive.name + ": " + to_rig_key(figures));
  return out;
}

void RobotOutlook::score() {
  bool any = false;
  while (const auto scored = future_->take_scored()) {
    any = true;
    ++figures_.scored;
    double worst = 0;
    for (std::size_t i = 0; i < scored->shown.joints; ++i)
      if (std::isfinite(scored->shown.sigma[i]))
        worst = std::max(worst, std::abs(scored->shown.position[i] - scored->truth[i]));
    if (errors_.size() < kErrorsKept)
      errors_.push_back(worst);
    else
      errors_[next_error_++ % kErrorsKept] = worst;
  }
  if (any) figures_.error = quantile(errors_, 0.95);
}

}  // namespace foresight
