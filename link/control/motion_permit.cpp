#include "link/control/motion_permit.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kFollowsWithin = 150ms;  // some ticks of the program and cycles of the robot

bool finite(const SetPoint& what) {
  return std::all_of(what.position.begin(), what.position.begin() + static_cast<std::ptrdiff_t>(what.joints),
                     [](double p) { return std::isfinite(p); });
}

}  // namespace

DrawNonce machine_nonces() {
  return [source = std::make_shared<std::random_device>()] {
    std::uniform_int_distribution<Nonce> any(1);
    return any(*source);
  };
}

MotionPermit::MotionPermit(SetPointLifeOptions life, DrawNonce draw) : life_(life), draw_(std::move(draw)) {
  consent_ = draw_();
}

void MotionPermit::withdraw(RestCause why) {
  following_ = live_ = seen_open_ = false;
  refused_ = SetPointFault::none;
  cause_ = why;
  consent_ = draw_();
  ++round_;
}

void MotionPermit::begin(Nonce lease, RobotTime now) {
  withdraw(lease == 0 ? RestCause::nobody : RestCause::granted);
  lease_ = lease;
  sequence_ = 0;
  life_.forget();
  delay_ = {};
  advanced_ = now;
}

/// In order, understood, and in time; notes when it expires.
SetPointFault MotionPermit::judge(const SetPoint& what, const OperatorClockTracker& clock, RobotTime now) {
  const auto given = clock.to_here(what.given);
  if (!given) return SetPointFault::clock_unknown;
  if (given->earliest() > now) return SetPointFault::from_the_future;
  delay_ = {now - given->time, given->uncertainty};
  life_.came(now - given->earliest(), now);
  // Whatever cannot be known of the clocks is taken to have passed already.
  expires_ = given->earliest() + std::clamp(what.lasts, Duration{0}, life_.life());
  return expires_ < now ? SetPointFault::expired : SetPointFault::none;
}

SetPointFault MotionPermit::may_follow(const SetPoint& what, const RobotView& robot) const {
  if (what.consent != consent_) return SetPointFault::no_consent;
  if (following_) return SetPointFault::none;
  if (!seen_open_) return refused_ != SetPointFault::none ? refused_ : SetPointFault::not_let_go;
  if (!robot.ready) return SetPointFault::robot_is_busy;
  for (std::size_t i = 0; i < what.joints; ++i)
    if (!(std::abs(what.position[i] - robot.begin[i]) <= robot.reach[i])) return SetPointFault::elsewhere;
  return SetPointFault::none;
}

/// A press that may not move the robot now does not move it later either: the switch has to be opened first.
SetPointFault MotionPermit::press(const SetPoint& what, RobotTime now, const RobotView& robot) {
  const SetPointFault fault = may_follow(what, robot);
  if (fault != SetPointFault::none) {
    if (following_) withdraw(RestCause::blind);
    seen_open_ = false;
    refused_ = fault;
    return fault;
  }
  if (!following_) followed_ = now;
  following_ = true;
  cause_ = RestCause::none;
  position_ = what.position;
  return SetPointFault::none;
}

void MotionPermit::see_open() {
  seen_open_ = true;
  following_ = false;
  refused_ = SetPointFault::none;
  cause_ = RestCause::let_go;
}

SetPointFault MotionPermit::take(const SetPoint& what, const OperatorClockTracker& clock, RobotTime now,
                                 const RobotView& robot) {
  if (lease_ == 0 || what.lease != lease_) return SetPointFault::no_lease;
  if (what.sequence <= sequence_) return SetPointFault::out_of_order;
  if (what.joints != robot.joints || what.joints > kMostLineJoints || !finite(what)) return SetPointFault::malformed;
  sequence_ = what.sequence;
  // Time that nobody has looked at has passed too.
  advance(now, robot);
  if (const SetPointFault fault = judge(what, clock, now); fault != SetPointFault::none) {
    if (fault == SetPointFault::from_the_future) withdraw(RestCause::clock_jumped);
    // An open switch stops, however late that is known; only one that is known in time counts as let go.
    if (!what.deadman && following_) withdraw(RestCause::let_go);
    return fault;
  }
  live_ = true;
  pressed_ = what.deadman;
  if (pressed_) return press(what, now, robot);
  see_open();
  return SetPointFault::none;
}

void MotionPermit::watch(RobotTime now, const RobotView& robot) {
  if (!following_) return;
  if (robot.follows) followed_ = now;
  if (now - followed_ > kFollowsWithin) withdraw(RestCause::robot_stopped);
}

void MotionPermit::advance(RobotTime now, const RobotView& robot) {
  const Duration passed = now - std::exchange(advanced_, now);
  if (lease_ == 0) return;
  if (passed > kPause) return withdraw(RestCause::paused);
  if (live_ && now > expires_) return withdraw(RestCause::expired);
  watch(now, robot);
}

LineMotion MotionPermit::motion(RobotTime now) const {
  LineMotion out;
  out.round = round_;
  if (lease_ == 0 || !live_ || now > expires_) return out;
  out.what = following_ ? LineMotion::What::follow : pressed_ ? LineMotion::What::nothing : LineMotion::What::open;
  out.until = expires_;
  out.position = position_;
  return out;
}

}  // namespace foresight
