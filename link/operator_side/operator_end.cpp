#include "link/operator_side/operator_end.hpp"

#include "common/real_time.hpp"
#include "link/dds/topics.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

constexpr Duration kControlEvery = 5ms;
constexpr Duration kLook = 5ms;  // for pieces: an acknowledgement may be due

std::uint64_t not_zero(std::uint64_t drawn) {
  return drawn == 0 ? 1 : drawn;
}

}  // namespace

OperatorEnd::Pictures::Pictures(Participant& participant, const OperatorEndOptions& options, const Clock& clock)
    : intake(not_zero(options.seat.draw()), options.expected, clock),
      pieces(participant, topics::pieces()),
      pairs(participant, topics::frames()),
      reports(participant, topics::reports()) {
  pieces.wait_also_for(pairs);
}

OperatorEnd::OperatorEnd(Participant& participant, const OperatorEndOptions& options, Clock& clock)
    : participant_(participant),
      clock_(clock),
      expected_(options.expected),
      line_(participant),
      states_(participant, topics::robot_state()),
      motions_(participant, topics::gate_motion()),
      seat_(options.seat),
      suspension_(options.asleep),
      queue_(options.room) {
  if (options.frames) pictures_.emplace(participant, options, clock);
}

void OperatorEnd::start() {
  control_thread_ = std::jthread([this](const std::stop_token& stop) {
    make_real_time(priority::kLine);  // where allowed: the robot stops without set-points
    run_control(stop);
  });
  if (pictures_) frames_thread_ = std::jthread([this](const std::stop_token& stop) { run_frames(stop); });
}

void OperatorEnd::stop() noexcept {
  for (std::jthread* thread : {&frames_thread_, &control_thread_}) {
    thread->request_stop();
    if (thread->joinable()) thread->join();
  }
  queue_.close();
}

void OperatorEnd::run_control(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    step_control();
    clock_.sleep_until(clock_.now() + kControlEvery);
  }
}

void OperatorEnd::run_frames(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    pictures_->pieces.wait(kLook);
    step_frames();
  }
}

void OperatorEnd::step() {
  step_control();
  if (pictures_) step_frames();
}

void OperatorEnd::step_control() {
  OperatorTime now;
  RobotClockTracker known;
  {
    const std::lock_guard lock(seat_mutex_);
    if (const auto asleep = suspension_.woke()) seat_.stood_still(*asleep);
    line_.receive(seat_, clock_);
    now = {clock_.now().ns};
    seat_.advance(now);
    line_.send(seat_);
    known = seat_.clock();
  }
  Expected expected{.joints = expected_.joints};
  if (const auto there = known.to_there(now)) expected.writer_now_ns = there->latest().ns;
  std::optional<RobotState> newest;
  states_.take<RobotState>(expected, [&](RobotState&& state, const Sample&) { newest = std::move(state); });
  const std::lock_guard lock(heard_mutex_);
  motions_.take<GateMotion>(expected, [&](GateMotion&& motion, const Sample&) {
    if (heard_motions_.size() == kMostMotions) heard_motions_.pop_front();
    heard_motions_.push_back({std::move(motion), now});
  });
  robot_clock_ = known;
  if (!newest) return;
  const RobotTime time{newest->time_ns};
  heard_ = HeardState{std::move(*newest), now, known.to_here(time)};
}

void OperatorEnd::hand_out(LineFramePtr frame, const char* coding) {
  if (!frame) return;
  {
    const std::lock_guard lock(figures_mutex_);
    if (!first_) first_ = frame->arrived;
    figures_.coding = coding;
    figures_.lasted = frame->arrived - *first_;
    arrivals_.push_back(frame->arrived);
    while (frame->arrived - arrivals_.front() > kRateOver) arrivals_.pop_front();
    if (std::exchange(session_, frame->session) != frame->session) figures_.ages.clear();
    if (frame->ages.arrived) {
      if (figures_.ages.size() == kMostAges) figures_.ages.pop_front();
      figures_.ages.push_back(*frame->ages.arrived);
    }
  }
  queue_.put(std::move(frame));
}

void OperatorEnd::step_frames() {
  const RobotClockTracker robot = robot_clock();
  Pictures& in = *pictures_;
  const auto tell = [&in] {
    if (const auto report = in.intake.report()) in.reports.write(*report);
  };
  in.pieces.take([&](const Sample& sample) {
    if (const auto piece = from_cdr<StereoPiece>(sample.cdr))
      hand_out(in.intake.take(*piece, robot, tell), kH264Coding);
    else
      in.pieces.refuse(kNoMessage);
  });
  in.pairs.take([&](const Sample& sample) {
    if (const auto pair = from_cdr<StereoFrame>(sample.cdr))
      hand_out(in.intake.take(*pair, sample.cdr.size(), robot), kJpegCoding);
    else
      in.pairs.refuse(kNoMessage);
  });
  tell();
  const std::lock_guard lock(figures_mutex_);
  figures_.pairs = in.intake.counts();
  figures_.samples_lost = in.pairs.lost();
}

RobotClockTracker OperatorEnd::robot_clock() const {
  const std::lock_guard lock(heard_mutex_);
  return robot_clock_;
}

std::optional<OperatorEnd::HeardState> OperatorEnd::robot_state() const {
  const std::lock_guard lock(heard_mutex_);
  return heard_;
}

std::vector<OperatorEnd::HeardMotion> OperatorEnd::take_motions() {
  const std::lock_guard lock(heard_mutex_);
  std::vector<HeardMotion> out(std::make_move_iterator(heard_motions_.begin()),
                               std::make_move_iterator(heard_motions_.end()));
  heard_motions_.clear();
  return out;
}

LineFigures OperatorEnd::figures() const {
  LineFigures out;
  {
    const std::lock_guard lock(figures_mutex_);
    out = figures_;
    const OperatorTime at = now();
    const auto lately = std::ranges::count_if(arrivals_, [at](OperatorTime came) { return at - came <= kRateOver; });
    const Duration over = first_ ? std::clamp<Duration>(at - *first_, std::chrono::seconds(1), kRateOver) : kRateOver;
    out.pairs_per_s = static_cast<double>(lately) / to_seconds(over);
  }
  const RobotClockTracker clock = robot_clock();
  out.round_trip = clock.round_trip();
  out.clock = clock.bound().at(clock_.now().ns);
  out.clock_jumps = clock.bound().jumps();
  out.refused = participant_.refused();
  out.refusal = participant_.refusal();
  return out;
}

}  // namespace foresight::link
