#include "link/control/control_seat.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "link/control/control_words.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kGreetEvery = 500ms;
constexpr Duration kAskEvery = 500ms;
constexpr Duration kSeenWithin = 500ms;  // a state, or we are blind
constexpr Duration kPause = 250ms;
constexpr Duration kRepeatEvery = 200ms;  // a request
constexpr Duration kRequestLife = 1s;
constexpr Duration kStopRepeated = 30s;  // an emergency stop
constexpr std::size_t kMostWaiting = 256;
constexpr std::size_t kMostOpen = 16;

}  // namespace

ControlSeat::ControlSeat(ControlSeatOptions options)
    : options_(std::move(options)), session_(options_.draw()), clock_(options_.draw()) {}

template <typename Body>
void ControlSeat::send(Body body) {
  if (out_.size() < kMostWaiting) out_.push_back({session_, desk_, std::move(body)});
}

std::vector<FromOperator> ControlSeat::take_outgoing() {
  return std::exchange(out_, {});
}

bool ControlSeat::sees_robot(OperatorTime now) const {
  return desk_ != 0 && state_.sequence > 0 && state_timely_ && now - state_came_ <= kSeenWithin;
}

void ControlSeat::receive(const FromRobot& message, OperatorTime now) {
  if (const auto* welcome = std::get_if<Welcome>(&message.body)) return take(message, *welcome, now);
  if (desk_ == 0) return;
  if (const auto* state = std::get_if<ControlState>(&message.body)) {
    if (message.from == robot_) take_state(*state, now);
    return;
  }
  if (message.to != session_ || message.from != desk_) return;
  if (const auto* ping = std::get_if<ClockPing>(&message.body)) take(*ping, now);
  if (const auto* pong = std::get_if<ClockPong>(&message.body)) take(*pong, now);
  if (const auto* verdict = std::get_if<LeaseVerdict>(&message.body)) take(*verdict, now);
  if (const auto* answer = std::get_if<Answer>(&message.body)) take(*answer);
}

void ControlSeat::take(const FromRobot& message, const Welcome& welcome, OperatorTime now) {
  // An answer to a Hello of ours, while one is open: a late one would call back a robot that has gone.
  if (message.to != session_ || message.from == 0 || desk_ != 0) return;
  if (welcome.identity.protocol != options_.identity.protocol) {  // all else that it says means something else here
    differences_ = differences(welcome.identity, options_.identity);
    not_understood_ = now;
    return;
  }
  not_understood_ = {};
  if (robot_ != welcome.robot) {
    clock_ = RobotClockTracker(options_.draw());
    state_ = {};
  }
  robot_ = welcome.robot;
  desk_ = message.from;
  differences_ = welcome.differences;
  answered_ = state_came_ = now;
  lease_ = 0;
  verdict_came_ = false;
  ++ask_number_;
  asked_ = {};
  withdraw();
  drop_requests();
  send_requests(now);
}

void ControlSeat::give_up(const Open& open) {
  fates_.push_back({open.request.id, open.request.what, std::nullopt});
}

/// Whatever was asked of the desk before, the next one knows nothing of. An emergency stop it is told as well: the
/// robot knows one that it has executed, by whichever connection it comes.
void ControlSeat::drop_requests() {
  for (Open& open : open_) {
    if (!open.stops()) give_up(open);
    open.sent = {};
  }
  std::erase_if(open_, [](const Open& open) { return !open.stops(); });
}

bool ControlSeat::stops() const {
  return std::any_of(open_.begin(), open_.end(), [](const Open& open) { return open.stops(); });
}

void ControlSeat::take(const ClockPing& ping, OperatorTime now) {
  send(RobotClockTracker::answer(ping, now));
}

void ControlSeat::take(const ClockPong& pong, OperatorTime now) {
  const ClockNews news = clock_.pong(pong, now);
  if (news == ClockNews::jumped) withdraw();
  if (news != ClockNews::nonsense && news != ClockNews::stale) answered_ = now;
}

void ControlSeat::take(const LeaseVerdict& verdict, OperatorTime now) {
  if (verdict.number != ask_number_ || !wanted_) return;
  verdict_came_ = true;
  asked_ = now;
  refused_ = verdict.words;
  if (verdict.lease == lease_) return;
  lease_ = verdict.lease;
  withdraw();
}

void ControlSeat::take_state(const ControlState& state, OperatorTime now) {
  if (state.sequence <= state_.sequence || state.joints > kMostLineJoints) return;
  if (!sees_robot(now)) withdraw();
  state_ = state;
  state_came_ = now;
  const auto delay = clock_.delay(state.time, now);
  state_timely_ = delay && delay->delay - delay->uncertainty <= options_.oldest_state;
  // What we gave back, and did not arrive.
  const bool known = state.holder == session_ || state.asking == session_;
  if (!wanted_ && known && now - asked_ >= kAskEvery) {
    asked_ = now;
    send(GiveBack{ask_number_});
  }
  // The lease has come to somebody else, or to nobody: what was asked before is answered, and is asked anew.
  if (lease_ == 0 || state.holder == session_) return;
  lease_ = 0;
  verdict_came_ = false;
  ++ask_number_;
  withdraw();
}

void ControlSeat::connect(OperatorTime now) {
  const bool mute = now - state_came_ > options_.answered_within;
  if (desk_ != 0 && (mute || now - answered_ > options_.answered_within)) {
    desk_ = lease_ = 0;
    // Whatever number it had: what the robot tells after this is the newest.
    state_ = {};
    withdraw();
  }
  const Duration every = stops() ? kRepeatEvery : kGreetEvery;  // a stop is in haste
  if (desk_ != 0 || (greeted_.ns != 0 && now - greeted_ < every)) return;
  greeted_ = now;
  send(Hello{options_.identity});
}

void ControlSeat::want_control(bool wanted) {
  if (wanted_ && !wanted) {
    if (desk_ != 0) send(GiveBack{ask_number_});  // take_state() repeats one that is lost
    asked_ = advanced_;
    lease_ = 0;
    refused_.clear();
    withdraw();
  }
  if (wanted && !wanted_) {
    ++ask_number_;
    verdict_came_ = false;
    asked_ = {};
  }
  wanted_ = wanted;
}

void ControlSeat::ask(OperatorTime now) {
  if (desk_ == 0 || !wanted_ || lease_ != 0) return;
  if (asked_.ns != 0 && now - asked_ < kAskEvery) return;
  asked_ = now;
  // Refused, and still wanted: asked anew, so that others know that we are still there.
  if (std::exchange(verdict_came_, false)) ++ask_number_;
  send(Ask{ask_number_});
}

bool ControlSeat::hand_over() {
  if (lease_ == 0 || state_.asking == 0) return false;
  send(HandOver{lease_, state_.asking});
  // What was handed over is not asked for again.
  wanted_ = false;
  withdraw();
  return true;
}

/// For one more: the oldest goes, but for emergency stops. Where there is nothing else, the later ones stop as well.
void ControlSeat::make_room() {
  if (open_.size() < kMostOpen) return;
  auto oldest = std::find_if(open_.begin(), open_.end(), [](const Open& open) { return !open.stops(); });
  if (oldest == open_.end()) oldest = open_.begin();
  give_up(*oldest);
  open_.erase(oldest);
}

std::uint64_t ControlSeat::request(LineRequest what, OperatorTime now) {
  make_room();
  open_.push_back({{++request_id_, what, lease_, state_.consent, now, kRequestLife + state_.life}, now, {}});
  send_requests(now);
  return request_id_;
}

void ControlSeat::take(const Answer& answer) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const Open& o) { return o.request.id == answer.id; });
  if (found == open_.end()) return;
  fates_.push_back({answer.id, found->request.what, answer.outcome});
  open_.erase(found);
}

std::vector<RequestFate> ControlSeat::take_fates() {
  return std::exchange(fates_, {});
}

/// For the first time, and again. What was asked for after a stop must not come before it: a reset would be undone by
/// the stop that it was to end.
void ControlSeat::send_requests(OperatorTime now) {
  if (desk_ == 0) return;
  const bool stops = this->stops();
  for (Open& open : open_) {
    const bool waits = open.sent.ns != 0 && now - open.sent < kRepeatEvery;
    if (waits || (stops && !open.stops())) continue;
    open.sent = now;
    send(open.request);
  }
}

void ControlSeat::give_up_requests(OperatorTime now) {
  const auto is_over = [now](const Open& open) {
    return now - open.since > (open.stops() ? kStopRepeated : open.request.lasts + 1s);
  };
  for (const Open& open : open_)
    if (is_over(open)) give_up(open);
  std::erase_if(open_, is_over);
}

void ControlSeat::begin_anew() {
  if (desk_ != 0) send(GiveBack{ask_number_});
  drop_requests();
  session_ = options_.draw();
  clock_ = RobotClockTracker(options_.draw());
  robot_ = desk_ = lease_ = 0;
  state_ = {};
  greeted_ = {};
  withdraw();
}

void ControlSeat::stood_still(Duration asleep) {
  for (Open& open : open_) open.since = open.since - asleep;
  begin_anew();
}

void ControlSeat::advance(OperatorTime now) {
  if (advanced_.ns != 0 && now - advanced_ > kPause) begin_anew();
  advanced_ = now;
  if (!sees_robot(now)) withdraw();
  give_up_requests(now);
  connect(now);
  if (desk_ == 0) return;
  if (const auto ping = clock_.ping(now)) send(*ping);
  ask(now);
  send_requests(now);
}

std::optional<SetPoint> ControlSeat::command(OperatorTime now, const LinePositions& position, bool deadman) {
  const bool pressed = deadman && !std::exchange(held_, deadman);
  held_ = deadman;
  // Who has asked for a stop does not drive before he knows of it: one that came late would stop what he began since.
  const bool drives = deadman && !stops();
  if (!drives) withdraw();
  if (pressed && drives && sees_robot(now)) agreed_ = state_.consent;
  if (lease_ == 0 || desk_ == 0) return std::nullopt;
  SetPoint out{lease_, agreed_, ++sequence_, now, state_.life, drives, state_.joints, position};
  send(out);
  return out;
}

ControlSeatStatus ControlSeat::status(OperatorTime now) const {
  ControlSeatStatus out;
  out.differences = differences_;
  if (state_.sequence > 0) out.state_age = now - state_came_;
  using Phase = ControlSeatStatus::Phase;
  out.wanted = wanted_;
  out.phase = desk_ == 0 ? Phase::connecting : lease_ == 0 ? Phase::connected : Phase::holding;
  const bool sees = sees_robot(now);
  const bool agrees = agreed_ != 0 && agreed_ == state_.consent;
  out.follows = sees && lease_ != 0 && agrees && state_.cause == RestCause::none;
  out.must_let_go = held_ && lease_ != 0 && (!agrees || state_.fault == SetPointFault::not_let_go);
  const auto say = [&out](std::string_view name, std::string_view cure) {
    out.words = name;
    out.cure = cure;
  };
  if (not_understood_.ns != 0 && now - not_understood_ <= options_.answered_within) {
    say(refusal_text(differences_), "");  // it says what to do
  } else if (desk_ == 0) {
    const std::string where = options_.place.empty() ? "" : " on " + options_.place;
    say("looking for the robot", "see that its program runs with --serve" + where + ", and that the line is up");
  } else if (!sees) {
    say("nothing is heard of the robot", "wait for the line");
  } else if (lease_ == 0) {
    say(wanted_ ? "control was asked for" : "connected", wanted_ ? "wait for the answer" : "ask for control");
    // Who is told to ask would be refused: he hears it at once.
    const std::string refused = wanted_ ? refused_ : refusal_text(differences_);
    if (!refused.empty()) say(refused, "");  // it says what to do
  } else if (!out.follows) {
    const ControlWords fault = words_for(state_.fault), cause = words_for(state_.cause);
    const bool presses = held_ && state_.fault != SetPointFault::none;
    say(presses ? fault.name : cause.name, presses ? fault.cure : cause.cure);
  }
  if (stops()) out.words += std::string(out.words.empty() ? "" : "; ") + "the emergency stop is not answered yet";
  return out;
}

}  // namespace foresight
