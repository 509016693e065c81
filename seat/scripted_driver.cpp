#include "seat/scripted_driver.hpp"

#include <utility>

namespace foresight {
namespace {

using namespace std::chrono_literals;
using Phase = ControlSeatStatus::Phase;

constexpr Duration kAskAgain = 3s;
constexpr double kLongestStep = 0.05;  // s: after a pause the motion goes on where it was
constexpr Duration kAstray = 1s;       // that the robot is shown elsewhere than it is commanded to be

}  // namespace

ScriptedDriver::ScriptedDriver(ScriptedMotion& motion, const ScriptedDriverOptions& options)
    : motion_(motion), options_(options) {}

// What a person would ask for by what the robot says of itself; each again after a while.
LineRequest ScriptedDriver::request(const SeatView& view) {
  const auto robot = says_ ? says_() : std::nullopt;
  if (!robot || view.robot.ready) return LineRequest::none;
  LineRequest wanted = LineRequest::none;
  if (robot->phase.label == "disabled") wanted = LineRequest::enable;
  if (robot->phase.label == "stopped") wanted = LineRequest::reset;
  if (robot->phase.label == "ready" && !robot->all_homed && options_.may_home) wanted = LineRequest::home;
  if (wanted == request_ && asked_ && view.now - *asked_ < kAskAgain) return LineRequest::none;
  request_ = wanted;
  asked_ = view.now;
  return wanted;
}

void ScriptedDriver::press(const SeatView& view) {
  const bool may = view.control.phase == Phase::holding && view.robot.ready && !view.control.must_let_go;
  if (!may) {
    opened_.reset();
    return;
  }
  if (!opened_) opened_ = view.now;
  if (view.now - *opened_ < options_.open_before) return;
  driving_ = true;
  last_ = followed_ = view.now;
  target_ = view.robot.begin;
  motion_.begin_at(view.robot.begin);
}

/// Lets go.
void ScriptedDriver::lose(const std::string& why) {
  driving_ = false;
  opened_.reset();
  if (++losses_ > options_.most_losses) failure_ = "the robot was lost too often: " + why;
}

void ScriptedDriver::drive(const SeatView& view, SeatWish& wish) {
  // Pressed in the tick before, or lost since.
  if (!view.engaged && view.now - *last_ > 100ms) return lose(view.control.words);
  if (view.shown.reason != FutureReason::astray) followed_ = view.now;
  if (view.now - followed_ > kAstray) return lose("it does not follow");
  wish.deadman = true;
  wish.position = target_;
  if (!view.engaged) return;
  const double dt = std::min(to_seconds(view.now - *last_), kLongestStep);
  last_ = view.now;
  driven_s_ += dt;
  if (const auto next = motion_.step(dt, view.shown)) {
    wish.position = target_ = *next;
  } else {
    driving_ = false;
    done_ = true;
    wish.deadman = false;
  }
}

SeatWish ScriptedDriver::tick(const SeatView& view) {
  SeatWish wish;
  if (!first_) first_ = view.now;
  if (done()) return wish;
  if (driving_) {
    drive(view, wish);
    return wish;
  }
  wish.request = request(view);
  press(view);
  if (driving_) {
    wish.deadman = true;
    wish.position = target_;
  } else if (driven_s_ == 0 && view.now - *first_ > options_.gives_up_after) {
    failure_ = "the robot did not get ready: " + view.control.words;
  }
  return wish;
}

}  // namespace foresight
