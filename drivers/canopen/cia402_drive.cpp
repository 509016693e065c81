#include "drivers/canopen/cia402_drive.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

constexpr std::size_t kControl = 0, kTarget = 1;      // in RPDO1
constexpr std::size_t kStatus = 0, kPosition = 1;     // in TPDO1
constexpr std::size_t kVelocity = 0, kModeShown = 1;  // in TPDO2
constexpr const char* kNotConfigured = "configure() has not succeeded";
constexpr const char* kZeroLost = "it restarted and has lost its zero: home it";
constexpr const char* kZeroDoubtful = "it was silent, its power and with it its zero may have been lost: home it";

std::vector<Pdo> make_pdos(int node, OperationMode mode) {
  const auto id = [node](std::uint32_t base) { return base + static_cast<std::uint32_t>(node); };
  const auto target = static_cast<std::uint16_t>(mode == OperationMode::cyclic_velocity ? 0x60FF : 0x607A);
  using D = PdoDirection;
  return {Pdo(D::to_node, 1, node, id(kRpdo1Id), 1, {{0x6040, 0, 16, false}, {target, 0, 32, true}}),
          Pdo(D::from_node, 1, node, id(kTpdo1Id), 1, {{0x6041, 0, 16, false}, {0x6064, 0, 32, true}}),
          Pdo(D::from_node, 2, node, id(kTpdo2Id), 1, {{0x606C, 0, 32, true}, {0x6061, 0, 8, true}})};
}

std::string device_name(const DriveConfig& drive, const CanBus& bus) {
  return drive.name + " (node " + std::to_string(drive.node) + " on " + bus.name() + ")";
}

const Cia402Config& checked(const Cia402Config& config) {
  validate(config);
  return config;
}

}  // namespace

Cia402Drive::Cia402Drive(Cia402Config config, const NetworkConfig& network, CanBus& bus, Clock& clock,
                         SdoAccess::Pump pump)
    : config_(checked(config)),
      network_(network),
      bus_(bus),
      clock_(clock),
      sdo_(config_.drive.node, network.sdo_timeout),
      access_(sdo_, bus, clock, std::move(pump), device_name(config_.drive, bus)),
      pdos_(make_pdos(config_.drive.node, config_.mode)),
      heartbeat_(network.drive_timeout),
      machine_(config_.mode, config_.homing_method != 0),
      refusal_(kNotConfigured) {}

std::int32_t Cia402Drive::to_counts(double position) const noexcept {
  const DriveConfig& d = config_.drive;
  const double counts = d.direction * (position - d.offset) * d.counts_per_unit;
  return static_cast<std::int32_t>(std::llround(std::clamp(counts, -2147483647.0, 2147483647.0)));
}

double Cia402Drive::to_joint(std::int64_t counts) const noexcept {
  const DriveConfig& d = config_.drive;
  return d.direction * static_cast<double>(counts) / d.counts_per_unit + d.offset;
}

void Cia402Drive::request(DriveRequest what) noexcept {
  if (configured_) machine_.request(what);
}

void Cia402Drive::set_point(double position, double velocity) noexcept {
  if (!configured_ || !machine_.follows()) return;
  const DriveConfig& d = config_.drive;
  if (is(OperationMode::cyclic_velocity)) {
    if (!std::isfinite(velocity)) return;
    const double rate = std::clamp(velocity, -d.max_velocity, d.max_velocity);
    target_ = static_cast<std::int64_t>(std::llround(d.direction * rate * d.counts_per_unit * config_.velocity_factor));
    return;
  }
  if (!std::isfinite(position)) return;
  // Never beyond the limits; but a joint that stands outside of them is not thrown back in one cycle.
  if (d.min_position < d.max_position) {
    const double held = to_joint(is(OperationMode::profile_position) ? wanted_ : target_);
    position = std::clamp(position, std::min(d.min_position, held), std::max(d.max_position, held));
  }
  const std::int32_t counts = to_counts(position);
  if (!is(OperationMode::profile_position)) {
    target_ = counts;
  } else if (counts != wanted_) {
    wanted_ = counts;
    wanted_new_ = true;
  }
}

DriveFeedback Cia402Drive::feedback() const noexcept {
  DriveFeedback out;
  const DriveConfig& d = config_.drive;
  if (process_time_.ns != 0) {
    out.time = process_time_;
    out.position = to_joint(actual_);
  }
  if (speed_seen_)
    out.velocity = d.direction * static_cast<double>(speed_) / (d.counts_per_unit * config_.velocity_factor);
  out.homed = homed();
  out.target_reached = (status_ & kStatusTargetReached) != 0;
  const bool following_error = machine_.follows() && (status_ & kStatusBit13) && !is(OperationMode::cyclic_velocity);
  out.limit = (status_ & kStatusLimit) != 0 || following_error;
  if (*lost_ != 0) {
    out.state = DriveState::fault;
    out.fault = lost_;
  } else if (configured_ && online_) {
    out.state = error_told_ ? DriveState::fault : machine_.state();
    out.fault = *machine_.trouble() != 0 ? machine_.trouble() : refusal_;
    if (mode_failed_) out.fault = "the drive refused its mode of operation";
    if (*out.fault == 0 && !out.homed && out.state != DriveState::homing) out.fault = zero_lost_;
  } else {
    out.fault = configured_ ? "the drive is silent" : refusal_;
  }
  if (*lost_ == 0 && out.state == DriveState::fault) {
    out.fault_code = fault_code_;
    out.fault = fault_code_ != 0 ? emergency_name(fault_code_) : "the drive does not say why";
  }
  return out;
}

void Cia402Drive::lose(const char* why) noexcept {
  configured_ = process_seen_ = error_told_ = false;
  lost_ = refusal_ = why;
  machine_.restart();
  hold();
}

bool Cia402Drive::homed() const noexcept {
  return machine_.homed() || (config_.absolute_encoder && process_time_.ns != 0);
}

// It may come at any time: also while the drive waits for set-up, or is in it.
void Cia402Drive::note_restart() noexcept {
  if (machine_.homed() || *zero_lost_ != 0) zero_lost_ = kZeroLost;
  machine_.set_homed(false);
  restarted_ = true;
  if (configured_ || *lost_ != 0) lose("the node restarted: configure it again");
}

// In a silence the supply may have gone and come back, and the boot-up message have been missed: the bus was off.
void Cia402Drive::note_silence(RobotTime now) noexcept {
  if (!heartbeat_.overdue(now)) return;
  if (machine_.homed()) zero_lost_ = kZeroDoubtful;
  machine_.set_homed(false);
}

void Cia402Drive::heard(const Heartbeat& heartbeat, RobotTime at) noexcept {
  note_silence(at);
  heartbeat_.heard(heartbeat.state, at);
  if (heartbeat.state == NmtState::boot_up)
    note_restart();
  else if (configured_ && heartbeat.state != NmtState::operational)
    lose("the node left the state 'operational': configure it again");
}

void Cia402Drive::take_emergency(const Emergency& emergency) noexcept {
  error_told_ = emergency.code >= 0x0100;  // class 00: errors are gone
  if (error_told_) fault_code_ = emergency.code;
}

void Cia402Drive::receive(NodeFrame what, const CanFrame& frame, RobotTime now) noexcept {
  // Frames that waited while the loop stood still count when they came.
  const RobotTime at = frame.time.ns != 0 ? frame.time : now;
  switch (what) {
    case NodeFrame::heartbeat:
      if (const auto heartbeat = parse_heartbeat(frame)) heard(*heartbeat, at);
      break;
    case NodeFrame::emergency:
      if (const auto emergency = parse_emergency(frame)) take_emergency(*emergency);
      break;
    case NodeFrame::sdo_answer: sdo_.receive(frame, bus_, now); break;
    case NodeFrame::tpdo1:
      if (!configured_ || !pdos_[1].carried_by(frame)) break;
      status_ = static_cast<std::uint16_t>(pdos_[1].get(frame, kStatus));
      actual_ = pdos_[1].get(frame, kPosition);
      process_time_ = at;
      process_seen_ = true;
      unanswered_ = 0;
      break;
    case NodeFrame::tpdo2:
      if (!configured_ || !pdos_[2].carried_by(frame)) break;
      speed_ = pdos_[2].get(frame, kVelocity);
      mode_shown_ = static_cast<int>(pdos_[2].get(frame, kModeShown));
      speed_seen_ = true;
      break;
  }
}

void Cia402Drive::check(RobotTime now) noexcept {
  sdo_.check(bus_, now);
  note_silence(now);
  // Process data is owed only where it was asked for: between set-up and the first SYNC there is but a heartbeat.
  const bool owed = unanswered_ * network_.cycle > network_.feedback_timeout;
  if (owed || now - process_time_ > network_.feedback_timeout) process_seen_ = false;
  const bool silent = !heartbeat_.state(now) || owed;
  online_ = !silent;
}

void Cia402Drive::hold() noexcept {
  target_ = is(OperationMode::cyclic_velocity) ? 0 : actual_;
  wanted_ = actual_;
  wanted_new_ = strobe_ = false;
}

// CiA 402-2, 10.3: a set-point counts at the rising edge of bit 4, and is acknowledged by status bit 12.
std::uint16_t Cia402Drive::strobe(std::uint16_t word) noexcept {
  const bool taken = status_ & kStatusBit12;
  if (strobe_ && taken) {
    strobe_ = false;
  } else if (!strobe_ && !taken && wanted_new_) {
    target_ = wanted_;
    wanted_new_ = false;
    strobe_ = true;
  }
  return strobe_ ? word | kControlBit4 | kControlAtOnce : word;
}

void Cia402Drive::switch_mode(RobotTime now) noexcept {
  if (sdo_.busy() || mode_failed_) return;
  if (switching_ && sdo_.status() != SdoStatus::done) {
    mode_failed_ = true;  // ends enabling; only configure() puts it right
    return;
  }
  switching_ = machine_.wanted_mode() != mode_written_;
  if (!switching_) return;
  mode_written_ = machine_.wanted_mode();
  const auto byte = static_cast<std::uint8_t>(mode_written_);
  sdo_.download(0x6060, 0, {&byte, 1}, bus_, now);
}

std::optional<CanFrame> Cia402Drive::command(bool permitted, RobotTime now) noexcept {
  if (!configured_) return std::nullopt;
  const bool followed = machine_.follows();
  const bool may_enable = permitted && online_ && process_seen_ && *refusal_ == 0 && !mode_failed_;
  // Just set up: a request waits for the first process data, at most until its absence counts as a loss.
  const bool waits = !process_seen_ && online_ && machine_.idle();
  std::uint16_t word = 0;
  if (!waits) word = machine_.step({status_, mode_shown_, may_enable, error_told_}, now);
  if (machine_.resetting()) error_told_ = false;
  if (machine_.homed()) zero_lost_ = "";
  // What was asked for before a stop, a fault or another mode is forgotten: it starts where the joint is.
  if (!followed || !machine_.follows()) hold();
  if (machine_.follows() && is(OperationMode::profile_position)) word = strobe(word);
  switch_mode(now);
  if (unanswered_ < 1'000'000) ++unanswered_;
  CanFrame frame = pdos_[0].empty_frame();
  pdos_[0].put(frame, kControl, word);
  pdos_[0].put(frame, kTarget, target_);
  return frame;
}

}  // namespace foresight::canopen
