// The part of Cia402Drive that waits: who it is, and what it has to know before it may move.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/error.hpp"
#include "drivers/canopen/cia402_drive.hpp"
#include "drivers/canopen/object_dictionary.hpp"

namespace foresight::canopen {
namespace {

using namespace std::chrono_literals;

constexpr ObjectRef kDeviceType{0x1000, 0, 4}, kConsumerCount{0x1016, 0, 1}, kProducer{0x1017, 0, 2};
constexpr ObjectRef kErrorBehaviour{0x1029, 1, 1};
constexpr ObjectRef kVendor{0x1018, 1, 4}, kProduct{0x1018, 2, 4}, kSerial{0x1018, 4, 4};
constexpr ObjectRef kAbortOption{0x6007, 0, 2, true}, kControlWord{0x6040, 0, 2}, kStatusWord{0x6041, 0, 2};
constexpr ObjectRef kQuickStopOption{0x605A, 0, 2, true}, kMode{0x6060, 0, 1, true}, kModeDisplay{0x6061, 0, 1, true};
constexpr ObjectRef kActual{0x6064, 0, 4, true}, kErrorCode{0x603F, 0, 2}, kSupportedModes{0x6502, 0, 4};
constexpr Duration kStateTime = 1s;

std::int64_t whole_ms(Duration d) {
  return std::max<std::int64_t>(1, (d.count() + 500'000) / 1'000'000);
}

std::string hex(std::int64_t value) {
  return fmt::format("0x{:X}", static_cast<std::uint64_t>(value));
}

}  // namespace

/// What the node says at `object`, which must be `wanted` where the rig says so.
std::optional<std::uint32_t> Cia402Drive::told(ObjectRef object, const char* what,
                                               std::optional<std::uint32_t> wanted) {
  const std::optional<std::int64_t> is = wanted ? access_.read(object) : access_.read_if_there(object);
  if (wanted && is != *wanted)
    throw InputError(access_.device(), std::string(what) + " is " + hex(*is) + " but the rig expects " + hex(*wanted),
                     "connect that device, or correct the rig");
  return is ? std::optional(static_cast<std::uint32_t>(*is)) : std::nullopt;
}

void Cia402Drive::identify() {
  const std::int64_t type = access_.read(kDeviceType);
  if ((type & 0xffff) != 402)
    throw InputError(access_.device(),
                     "device type (1000h) is " + hex(type) + ", profile " + std::to_string(type & 0xffff),
                     "connect a drive of profile 402");
  identity_.vendor = told(kVendor, "vendor (1018:01)", config_.drive.vendor);
  identity_.product = told(kProduct, "product (1018:02)", config_.drive.product);
  identity_.serial = told(kSerial, "serial number (1018:04)", config_.drive.serial);
}

void Cia402Drive::configure() {
  lose("configure() has not succeeded");
  lost_ = "";
  notes_.clear();
  speed_seen_ = switching_ = mode_failed_ = false;
  identify();
  // With its answers, all that had waited on the bus was read: a boot-up message that comes now is one of this set-up.
  restarted_ = false;
  bus_.send(nmt_frame(NmtCommand::enter_pre_operational, config_.drive.node));
  switch_off();
  const char* const pending = refusal_;
  refusal_ = "";
  try {
    prove_heartbeats();
    write_error_behaviour();
    prove_abort_option();
    write_limits();
    write_homing();
    write_mode();
    write_interpolation();
    write_pdos();
    start();
  } catch (...) {
    configured_ = false;
    refusal_ = pending;
    require_no_restart();  // else a restart would be told as a value that the device does not take
    throw;
  }
  if (!homed() && *zero_lost_ != 0) notes_.emplace_back(zero_lost_);
}

// What was written and proven before a restart is gone: limits, and the watchdog that stops the drive when we fall
// silent.
void Cia402Drive::require_no_restart() const {
  if (restarted_)
    throw RuntimeFailure(access_.device() + " restarted during its set-up (boot-up message)",
                         "check its supply, then set it up again");
}

void Cia402Drive::refuse(const char* why) {
  if (*refusal_ == 0) refusal_ = why;
  notes_.emplace_back(why);
}

// A drive that an earlier master left enabled is brought to rest first, then loses its torque.
void Cia402Drive::switch_off() {
  const auto moving = [&] {
    return state_of(static_cast<std::uint16_t>(access_.read(kStatusWord))) == Cia402State::operation_enabled;
  };
  if (moving()) {
    access_.write(kControlWord, control_word(Cia402Command::quick_stop));
    access_.wait(kStateTime, [&] { return !moving(); });
  }
  access_.write(kControlWord, control_word(Cia402Command::disable_voltage));
  if (!access_.wait(kStateTime, [&] { return !moving(); }))
    throw RuntimeFailure(access_.device() + " stays enabled after 'disable voltage'", "switch it off and on again");
}

void Cia402Drive::prove_heartbeats() {
  has_heartbeat_ = access_.try_write(kProducer, whole_ms(network_.drive_heartbeat)) == Written::proven;
  if (!has_heartbeat_) refuse("the drive sends no heartbeat (1017h), its loss would not be seen");
  const auto count = access_.read_if_there(kConsumerCount);
  if (!count || *count == 0)
    return refuse("the drive has no consumer heartbeat (1016h), it would not notice that we fell silent");
  // Two entries for one node are an error (CiA 301, 7.5.2.19): ours is used again, else a free one, else the first.
  std::uint8_t sub = 1, free = 0;
  bool ours = false;
  for (std::uint8_t i = 1; i <= std::min<std::int64_t>(*count, 127) && !ours; ++i) {
    const std::int64_t entry = access_.read({0x1016, i, 4});
    ours = (entry >> 16 & 0xff) == network_.master_node;
    if (ours) sub = i;
    if (free == 0 && ((entry >> 16 & 0xff) == 0 || (entry & 0xffff) == 0)) free = i;
  }
  if (!ours && free != 0) sub = free;
  const std::int64_t entry = std::int64_t{network_.master_node} << 16 | whole_ms(network_.watchdog);
  if (access_.try_write({0x1016, sub, 4}, entry) != Written::proven)
    refuse("the drive did not keep the consumer heartbeat (1016h), it would not notice that we fell silent");
}

// CiA 301, 1029h: 0 pre-operational, 1 no change, 2 stopped. When a cable is back, what waited on it for somebody to
// acknowledge comes first: set-points of before, which a drive that is still operational would follow.
void Cia402Drive::write_error_behaviour() {
  const Written written = access_.try_write(kErrorBehaviour, 0);
  if (written == Written::proven || written == Written::absent) return;  // 0 is what devices without it do
  constexpr std::int64_t kNoChange = 1;
  if (access_.read_if_there(kErrorBehaviour).value_or(kNoChange) != kNoChange) return;
  notes_.push_back("1029h:01: it does not leave the operational state when we fall silent");
}

void Cia402Drive::prove_abort_option() {
  // CiA 402-2, 6007h: 0 no action, 1 malfunction, 2 disable voltage, 3 quick stop. Best is what holds the joint.
  if (access_.try_write(kAbortOption, 3) == Written::proven) return;
  if (access_.try_write(kAbortOption, 2) != Written::proven)
    return refuse("the drive did not keep the abort connection option (6007h), it would go on when we fall silent");
  notes_.push_back("6007h: no quick stop when we fall silent, the voltage is switched off");
}

std::int64_t Cia402Drive::counts_rate(double joint_rate) const {
  return std::max<std::int64_t>(1, std::llround(joint_rate * config_.drive.counts_per_unit));
}

void Cia402Drive::write_limit(ObjectRef object, std::int64_t value, const char* what) {
  const Written written = access_.try_write(object, value);
  const std::string name = object_name(object.index, object.sub);
  if (written == Written::absent) notes_.push_back(name + ": no " + what);
  if (written == Written::refused || written == Written::differs)
    throw InputError(access_.device(),
                     std::string("it does not take ") + std::to_string(value) + " as " + what + " (" + name + ")",
                     "give a value that the device accepts");
}

void Cia402Drive::write_limits() {
  const DriveConfig& d = config_.drive;
  if (d.min_position < d.max_position) {
    const auto [low, high] = std::minmax({to_counts(d.min_position), to_counts(d.max_position)});
    write_limit({0x607D, 1, 4, true}, low, "lower position limit");
    write_limit({0x607D, 2, 4, true}, high, "upper position limit");
  }
  const std::int64_t velocity = counts_rate(d.max_velocity * config_.velocity_factor);
  const std::int64_t acceleration = counts_rate(d.max_acceleration);
  const double stop = config_.quick_stop_deceleration;
  write_limit({0x607F, 0, 4}, velocity, "largest profile velocity");
  if (config_.max_motor_speed_rpm) write_limit({0x6080, 0, 4}, *config_.max_motor_speed_rpm, "largest motor speed");
  if (is(OperationMode::profile_position)) write_limit({0x6081, 0, 4}, velocity, "profile velocity");
  write_limit({0x6083, 0, 4}, acceleration, "profile acceleration");
  write_limit({0x6084, 0, 4}, acceleration, "profile deceleration");
  write_limit({0x6085, 0, 4}, stop > 0 ? counts_rate(stop) : acceleration, "quick stop deceleration");
  write_limit(kQuickStopOption, config_.quick_stop_option, "quick stop option");
}

// A drive that lacks the method would refuse to home only when somebody waits for it, or never say so.
void Cia402Drive::require_homing_method() {
  const std::int64_t wanted = config_.homing_method;
  const std::int64_t count = access_.read_if_there({0x60E3, 0, 1}).value_or(0);
  std::string listed;
  for (std::int64_t sub = 1; sub <= count; ++sub) {
    // INTEGER8 in some devices, INTEGER16 in others: the low byte tells all methods.
    const std::int64_t method = access_.read({0x60E3, static_cast<std::uint8_t>(sub), 1, true});
    if (method == wanted) return;
    listed += (sub > 1 ? ", " : "") + std::to_string(method);
  }
  if (count > 0)
    throw InputError(access_.device(),
                     "it does not have homing method " + std::to_string(wanted) + "; it has " + listed + " (60E3h)",
                     "set homing_method to one of these");
}

void Cia402Drive::write_homing() {
  if (config_.homing_method == 0) return;
  require_homing_method();
  const std::int64_t velocity = counts_rate(config_.drive.homing_velocity * config_.velocity_factor);
  const double acceleration = config_.homing_acceleration;
  if (access_.try_write({0x6098, 0, 1, true}, config_.homing_method) != Written::proven)
    throw InputError(access_.device(),
                     "it does not take homing method " + std::to_string(config_.homing_method) + " (6098h)",
                     "set homing_method to one that its manual lists");
  access_.write_proven({0x6099, 1, 4}, velocity);
  access_.write_proven({0x6099, 2, 4}, velocity);
  write_limit({0x609A, 0, 4}, counts_rate(acceleration > 0 ? acceleration : config_.drive.max_acceleration),
              "homing acceleration");
}

void Cia402Drive::write_mode() {
  const auto supported = access_.read_if_there(kSupportedModes);
  const auto need = [&](OperationMode mode) {
    if (supported && !(*supported & mode_bit(mode)))
      throw InputError(access_.device(),
                       std::string("it does not support the mode ") + to_string(mode) + ", 6502h is " + hex(*supported),
                       "choose another mode or another drive");
  };
  need(config_.mode);
  if (config_.homing_method != 0) need(OperationMode::homing);
  access_.write(kMode, static_cast<int>(config_.mode));
  const auto shown = [&] { return access_.read(kModeDisplay) == static_cast<int>(config_.mode); };
  if (!access_.wait(kStateTime, shown))
    throw RuntimeFailure(access_.device() + " does not show the mode " + to_string(config_.mode) + " (6061h)",
                         "check that the drive supports it");
  mode_written_ = config_.mode;
  mode_shown_ = static_cast<int>(config_.mode);
}

// 60C2h: a value of 1 .. 255 times ten to an exponent, in seconds.
void Cia402Drive::write_interpolation() {
  std::int64_t units = network_.cycle.count() / 1000, exponent = -6;  // us
  for (; units % 10 == 0; units /= 10) ++exponent;
  if (units > 255 || network_.cycle.count() % 1000 != 0)
    throw InputError("CANopen network",
                     "a cycle of " + std::to_string(network_.cycle.count()) + " ns is no interpolation period (60C2h)",
                     "give 1 to 255 times a power of ten in seconds");
  if (exponent > -3 && units * 10 <= 255) {
    units *= 10;  // whole milliseconds are what drives know best
    --exponent;
  }
  if (exponent > -3 && units * 10 <= 255) {
    units *= 10;
    --exponent;
  }
  write_limit({0x60C2, 1, 1}, units, "interpolation period");
  write_limit({0x60C2, 2, 1, true}, exponent, "interpolation period's exponent");
}

void Cia402Drive::write_pdos() {
  for (int number = 2; number <= 4; ++number) {
    disable_pdo(access_, PdoDirection::to_node, number);
    if (number > 2) disable_pdo(access_, PdoDirection::from_node, number);
  }
  for (const Pdo& pdo : pdos_) configure_pdo(access_, pdo);
}

void Cia402Drive::start() {
  require_no_restart();
  heartbeat_.forget_state();
  bus_.send(nmt_frame(NmtCommand::start, config_.drive.node));
  const auto operational = [&] { return heartbeat_.state(clock_.now()) == NmtState::operational; };
  if (has_heartbeat_ && !access_.wait(kStateTime, operational))
    throw RuntimeFailure(access_.device() + " did not become operational",
                         "check its NMT start-up (1F80h) and that no other master commands it");
  status_ = static_cast<std::uint16_t>(access_.read(kStatusWord));
  actual_ = access_.read(kActual);
  process_time_ = clock_.now();
  hold();
  error_told_ = process_seen_ = false;
  unanswered_ = 0;
  fault_code_ = 0;
  if (state_of(status_) == Cia402State::fault)
    fault_code_ = static_cast<std::uint16_t>(access_.read_if_there(kErrorCode).value_or(0));
  require_no_restart();
  configured_ = true;
  check(clock_.now());
}

}  // namespace foresight::canopen
