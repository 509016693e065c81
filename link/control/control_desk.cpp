#include "link/control/control_desk.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostOutgoing = 256;  // that nobody takes
constexpr std::size_t kMostRequests = 16;

}  // namespace

ControlDesk::ControlDesk(ControlDeskOptions options)
    : options_(std::move(options)),
      session_(options_.draw()),
      peers_(options_.draw),
      permit_(options_.life, options_.draw) {}

template <typename Body>
void ControlDesk::send(const DeskPeer& to, Body body) {
  if (out_.size() < kMostOutgoing) out_.push_back({to.ours, to.theirs, std::move(body)});
}

std::vector<FromRobot> ControlDesk::take_outgoing() {
  return std::exchange(out_, {});
}

void ControlDesk::receive(const FromOperator& message, RobotTime now) {
  if (const auto* hello = std::get_if<Hello>(&message.body)) return greet(message.from, *hello, now);
  DeskPeer* from = peers_.find(message.from, message.to);
  if (from == nullptr) {
    ++counts_.strangers;
    return;
  }
  from->heard = now;
  from->answered = true;
  std::visit(
      [&](const auto& body) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(body)>, Hello>) take(*from, body, now);
      },
      message.body);
}

void ControlDesk::greet(Nonce theirs, const Hello& hello, RobotTime now) {
  // A Hello is no proof that somebody is there: it may be a recording's.
  if (DeskPeer* peer = peers_.greet(theirs, hello.identity, options_.identity, now, holder_))
    send(*peer, Welcome{session_, options_.identity, peer->differences});
}

void ControlDesk::take(DeskPeer& from, const ClockPing& ping, RobotTime now) {
  send(from, OperatorClockTracker::answer(ping, now));
}

void ControlDesk::take(DeskPeer& from, const ClockPong& pong, RobotTime now) {
  from.clock.pong(pong, now);
  const std::uint64_t jumps = from.clock.bound().jumps();
  if (jumps != std::exchange(from.jumps_seen, jumps) && from.theirs == holder_)
    permit_.withdraw(RestCause::clock_jumped);
}

void ControlDesk::answer(const DeskPeer& to, LeaseVerdict verdict) {
  verdict.number = to.asked;
  send(to, std::move(verdict));
}

std::string ControlDesk::refusal(const DeskPeer& to) const {
  if (const std::string text = refusal_text(to.differences); !text.empty()) return text;
  if (holder_ == 0 || holder_ == to.theirs) return "";
  return fmt::format("{} commands; wait until control is handed over, or is given by somebody beside the robot",
                     in_quotes(holder_name_));
}

void ControlDesk::take(DeskPeer& from, const Ask& ask, RobotTime now) {
  if (ask.number < from.asked || ask.number <= from.settled) return;
  from.asked = ask.number;
  const std::string refused = refusal(from);
  if (refused.empty()) return grant(from, now);
  from.asked_at = now;
  answer(from, {0, 0, refused});
}

void ControlDesk::grant(DeskPeer& to, RobotTime now) {
  to.asked_at = {};
  if (holder_ != to.theirs) {
    end_lease(now);
    holder_ = to.theirs;
    holder_name_ = to.identity.name;
    permit_.begin(options_.draw(), now);
    fault_ = SetPointFault::none;
  }
  answer(to, {0, permit_.lease(), ""});
}

void ControlDesk::end_lease(RobotTime now) {
  if (holder_ == 0) return;
  if (DeskPeer* holder = peers_.find(holder_)) holder->settled = holder->asked;
  holder_ = 0;
  holder_name_.clear();
  permit_.begin(0, now);
}

void ControlDesk::take(DeskPeer& from, const GiveBack& back, RobotTime now) {
  if (back.number < from.asked) return;
  from.asked_at = {};
  from.settled = from.asked = back.number;
  if (from.theirs == holder_) end_lease(now);
}

DeskPeer* ControlDesk::asking(RobotTime now) {
  DeskPeer* out = nullptr;
  for (DeskPeer& peer : peers_.all()) {
    const bool asks = peer.asks(now) && peer.theirs != holder_;
    if (asks && refusal_text(peer.differences).empty() && (out == nullptr || peer.asked_at > out->asked_at))
      out = &peer;
  }
  return out;
}

std::string ControlDesk::asking_name(RobotTime now) {
  const DeskPeer* peer = asking(now);
  return peer == nullptr ? "" : peer->identity.name;
}

bool ControlDesk::consent_to_asking(RobotTime now) {
  DeskPeer* to = asking(now);
  if (to == nullptr) return false;
  grant(*to, now);
  return true;
}

void ControlDesk::take(DeskPeer& from, const HandOver& over, RobotTime now) {
  if (from.theirs != holder_ || over.lease != permit_.lease()) return;
  DeskPeer* to = peers_.find(over.to);
  // Both must want it, now.
  if (to == nullptr || !to->asks(now)) return;
  if (refusal_text(to->differences).empty()) grant(*to, now);
}

void ControlDesk::take(DeskPeer& from, const SetPoint& set_point, RobotTime now) {
  SetPointFault fault = SetPointFault::no_lease;
  if (from.theirs == holder_) {
    fault = permit_.take(set_point, from.clock, now, robot_);
    if (fault != SetPointFault::out_of_order) fault_ = fault;
  }
  ++counts_.faults[static_cast<std::size_t>(fault)];
  if (fault == SetPointFault::none) taken_ = {from.theirs, set_point.sequence, now};
  if (fault == SetPointFault::none && set_point.deadman) ++counts_.followed;
}

RequestOutcome ControlDesk::judge(const DeskPeer& from, const Request& request, RobotTime now) const {
  if (request.what == LineRequest::emergency_stop) return RequestOutcome::taken;
  if (from.theirs != holder_ || request.lease != permit_.lease()) return RequestOutcome::not_holder;
  const auto given = from.clock.to_here(request.given);
  const bool timely =
      given && given->earliest() <= now &&
      now <= given->earliest() + std::clamp(request.lasts, Duration{0}, kRequestLife + options_.life.allowed_delay);
  if (!timely || requests_.size() >= kMostRequests) return RequestOutcome::expired;
  return request.consent == permit_.consent() ? RequestOutcome::taken : RequestOutcome::before_stop;
}

void ControlDesk::take(DeskPeer& from, const Request& request, RobotTime now) {
  if (request.what == LineRequest::none || request.what > LineRequest::emergency_stop) return;
  auto outcome = from.requests.answered(request);
  if (!outcome) {
    outcome = judge(from, request, now);
    from.requests.note(request.id, *outcome);
    if (*outcome == RequestOutcome::taken) queue(from, request);
  }
  send(from, Answer{request.id, *outcome});
}

void ControlDesk::queue(const DeskPeer& from, const Request& request) {
  if (request.what == LineRequest::emergency_stop) {
    if (!stops_.note_new(request)) return;
    stopper_ = from.identity.name;
    requests_.clear();
  }
  requests_.push_back({request.what, permit_.consent()});
}

LineRequest ControlDesk::take_request() {
  while (!requests_.empty()) {
    const Queued next = requests_.front();
    requests_.erase(requests_.begin());
    // A loss came between the request and its turn.
    if (next.what == LineRequest::emergency_stop || next.consent == permit_.consent()) return next.what;
  }
  return LineRequest::none;
}

void ControlDesk::tell_state(RobotTime now) {
  const Told present{permit_.consent(), holder_, permit_.cause(), fault_, robot_.ready};
  const bool lost = present.consent != told_state_.consent, news = present != told_state_;
  if (!lost && now - told_ < (news ? options_.state_every : std::max(repeat_every_, options_.state_every))) return;
  told_ = now;
  told_state_ = present;
  ControlState state;
  state.sequence = ++states_;
  state.time = now;
  state.holder = holder_;
  state.holder_name = holder_name_;
  if (const DeskPeer* peer = asking(now)) {
    state.asking = peer->theirs;
    state.asking_name = peer->identity.name;
  }
  state.consent = permit_.consent();
  state.cause = permit_.cause();
  state.fault = fault_;
  state.life = permit_.life();
  state.delay = permit_.delay().delay;
  state.delay_doubt = permit_.delay().uncertainty;
  state.ready = robot_.ready;
  state.joints = robot_.joints;
  state.measured = robot_.measured;
  state.set_point = robot_.set_point;
  state.begin = robot_.begin;
  if (out_.size() < kMostOutgoing) out_.push_back({session_, 0, std::move(state)});
}

void ControlDesk::forget_clocks() {
  for (DeskPeer& peer : peers_.all()) peer.clock = OperatorClockTracker(options_.draw());
}

void ControlDesk::stood_still() {
  forget_clocks();
  if (permit_.lease() != 0) permit_.withdraw(RestCause::paused);
}

void ControlDesk::advance(RobotTime now, const RobotView& robot) {
  robot_ = robot;
  // A pause may have been a leap of our clock: what was known of the others' is void.
  if (advanced_.ns != 0 && now - advanced_ > MotionPermit::kPause) forget_clocks();
  advanced_ = now;
  permit_.advance(now, robot);
  for (DeskPeer& peer : peers_.all())
    if (const auto ping = peer.clock.ping(now)) send(peer, *ping);
  const DeskPeer* holder = holder_ == 0 ? nullptr : peers_.find(holder_);
  if (holder != nullptr && now - holder->heard > kLease) end_lease(now);
  peers_.forget(now, holder_);
  tell_state(now);
}

}  // namespace foresight
