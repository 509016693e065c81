#include "seat/seat.hpp"

#include <algorithm>
#include <future>
#include <limits>
#include <mutex>
#include <span>
#include <utility>

#include "common/real_time.hpp"
#include "input/hand_on_line.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kEvery = 5ms;
constexpr std::size_t kFatesKept = 8;
// After the switch was let go of: the robot comes to rest as set-points end, too; these only say it sooner.
constexpr Duration kLastSetPoints = 3 * Seat::kSetPointEvery;
using Phase = ControlSeatStatus::Phase;

/// The robot's instants are not known any more: where it was shown stands in for where it is.
void lose_clock(PredictedRobot& shown) {
  if (shown.status == StateStatus::invalid) return;
  shown.status = StateStatus::invalid;
  shown.reason = FutureReason::stale;
  shown.joint = -1;
  std::ranges::fill(std::span(shown.sigma).first(shown.joints), std::numeric_limits<double>::infinity());
}

}  // namespace

Seat::Seat(const Rig& rig, link::OperatorEnd& end, SeatDriver& driver, Clock& clock)
    : rig_(rig), end_(end), driver_(driver), clock_(clock), outlook_(rig) {}

std::string Seat::start() {
  std::promise<std::string> refused;
  std::future<std::string> answer = refused.get_future();
  thread_ = std::jthread([this, refused = std::move(refused)](const std::stop_token& stop) mutable {
    refused.set_value(make_real_time(priority::kSeat));
    while (!stop.stop_requested()) {
      step();
      clock_.sleep_until(clock_.now() + kEvery);
    }
  });
  return answer.get();
}

void Seat::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void Seat::let_go() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
}

SeatEnd::~SeatEnd() {
  seat_.let_go();
  clock_.sleep_until(clock_.now() + kLastSetPoints);
  seat_.stop();
}

std::optional<RobotTime> Seat::robot_now() const {
  const auto now = end_.robot_clock().to_there({clock_.now().ns});
  return now ? std::optional(now->time) : std::nullopt;
}

SeatView Seat::look(std::optional<RobotTime> now) {
  SeatView view;
  end_.seat([&](ControlSeat& seat, OperatorTime here) {
    view.now = here;
    view.control = seat.status(here);
    view.robot = hand_robot(seat, here);
  });
  if (now) view.shown = outlook_.at(outlook_.instant_to_show(*now));
  view.engaged = engaged_;
  return view;
}

void Seat::step() {
  const std::lock_guard lock(mutex_);
  const auto motions = end_.take_motions();
  const auto now = robot_now();
  if (now) {
    const Nonce session = end_.seat([this](ControlSeat& seat, OperatorTime) {
      outlook_.hear(seat.state(), seat.session());
      return seat.session();
    });
    for (const auto& heard : motions) outlook_.hear(heard.motion, session, *now);
    outlook_.advance(*now);
  }
  const SeatView view = look(now);
  SeatWish wish = driver_.tick(view);
  wish.deadman = wish.deadman && !ended_;
  heed_switch(wish, view);
  command(wish, view.now);
}

void Seat::heed_switch(const SeatWish& wish, const SeatView& view) {
  const bool held_before = std::exchange(held_, wish.deadman), pressed = wish.deadman && !held_before;
  refused_ = wish.refused && !ended_;
  if (!wish.deadman) {
    engaged_ = followed_ = false;
    return;
  }
  if (pressed) engaged_ = view.control.phase == Phase::holding && !view.control.must_let_go;
  if (view.control.follows) followed_ = true;
  const bool lost = followed_ && !view.control.follows;
  if (view.control.phase != Phase::holding || view.control.must_let_go || lost) engaged_ = false;
}

void Seat::command(const SeatWish& wish, OperatorTime now) {
  const auto robot_time = robot_now();
  end_.seat([&](ControlSeat& seat, OperatorTime here) {
    seat.want_control(wish.control);
    if (wish.hand_over) seat.hand_over();
    if (wish.request != LineRequest::none && wish.request != asked_) seat.request(wish.request, here);
    asked_ = wish.request;
    for (RequestFate& fate : seat.take_fates()) {
      if (fates_.size() == kFatesKept) fates_.erase(fates_.begin());
      fates_.push_back(std::move(fate));
    }
    if (commanded_.ns != 0 && now - commanded_ < kSetPointEvery) return;
    commanded_ = now;
    const auto sent = seat.command(here, engaged_ ? wish.position : seat.begin(), engaged_);
    if (sent && robot_time) outlook_.sent(*sent, *robot_time);
  });
}

std::optional<RobotTime> Seat::instant_to_show() {
  const std::lock_guard lock(mutex_);
  const auto now = robot_now();
  return now ? std::optional(outlook_.instant_to_show(*now)) : std::nullopt;
}

PredictedRobot Seat::show(std::optional<RobotTime> at) {
  const std::lock_guard lock(mutex_);
  const auto now = robot_now();
  if (now)
    shown_ = outlook_.show(at ? *at : outlook_.instant_to_show(*now));
  else
    lose_clock(shown_);
  return shown_;
}

bool Seat::was_surprised(RobotTime time) const {
  const std::lock_guard lock(mutex_);
  return outlook_.was_surprised(time);
}

PredictedRobot Seat::look_ahead() {
  const std::lock_guard lock(mutex_);
  const auto now = robot_now();
  return now ? outlook_.at(outlook_.instant_to_show(*now)) : PredictedRobot{};
}

std::vector<PredictedRobot> Seat::under_way(std::size_t count) const {
  const std::lock_guard lock(mutex_);
  std::vector<PredictedRobot> out;
  const auto& known = outlook_.newest();
  if (!known || shown_.status == StateStatus::invalid || shown_.time <= known->time || count < 2) return out;
  const Duration step = (shown_.time - known->time) / static_cast<std::int64_t>(count - 1);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    PredictedRobot then = outlook_.at(known->time + step * static_cast<std::int64_t>(i));
    if (then.status != StateStatus::invalid) out.push_back(then);
  }
  out.push_back(shown_);
  return out;
}

SeatStatus Seat::status() const {
  SeatStatus out;
  end_.seat([&](ControlSeat& seat, OperatorTime here) {
    out.control = seat.status(here);
    out.robot_control = seat.state();
  });
  if (auto heard = end_.robot_state()) {
    out.robot_age = OperatorTime{clock_.now().ns} - heard->came;
    out.robot = std::move(heard->state);
  }
  out.line = end_.figures();
  const std::lock_guard lock(mutex_);
  out.delay = outlook_.delay();
  out.outlook = outlook_.figures();
  out.shown = shown_;
  out.held = held_;
  out.refused = refused_;
  out.engaged = engaged_;
  out.fates = fates_;
  return out;
}

std::vector<std::string> Seat::learnt_responses() const {
  const std::lock_guard lock(mutex_);
  return outlook_.learnt_responses();
}

}  // namespace foresight
