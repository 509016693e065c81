#include "sim/drives/powercube_node.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sim/drives/object_dictionary.hpp"
#include "sim/drives/powercube_parameters.hpp"

namespace foresight::sim {

using namespace powercube;

namespace {

constexpr std::uint8_t kAck = 0x64, kSetExtended = 0x08, kGetExtended = 0x0A, kSetMotion = 0x0B;
constexpr double kBootTime_s = 0.3, kLongestCyclicStep_s = 0.1, kAmperePerDigit = 0.01;

double decode(std::span<const std::uint8_t> bytes, Coding coding) {
  if (coding != Coding::real)
    return static_cast<double>(decode_integer(bytes, coding == Coding::int32 || coding == Coding::int16));
  return std::bit_cast<float>(static_cast<std::uint32_t>(decode_integer(bytes, false)));
}

void encode(double value, Coding coding, std::span<std::uint8_t> bytes) {
  if (coding == Coding::real)
    encode_integer(std::bit_cast<std::uint32_t>(static_cast<float>(value)), bytes);
  else
    encode_integer(std::isfinite(value) ? std::llround(std::clamp(value, -2147483648.0, 4294967295.0)) : 0, bytes);
}

}  // namespace

PowerCubeNode::PowerCubeNode(const NodeConfig& config, Send send) : DriveNode(config), send_(std::move(send)) {
  power_up();
  deaf_s_ = 0;
}

void PowerCubeNode::power_up() {
  motor_.power(false);
  const MotorConfig& motor = config_.motor;
  const bool limited = config_.min_position < config_.max_position;
  values_ = {};
  const double low = limited ? config_.min_position : -1e6, high = limited ? config_.max_position : 1e6;
  values_[kDefGearRatio] = values_[kDefLinRatio] = values_[kDefTorqueRatio] = values_[kDefCurRatio] = 1;
  values_[kDefMinPos] = values_[kMinPos] = low;
  values_[kDefMaxPos] = values_[kMaxPos] = high;
  values_[kDefMaxDeltaPos] = values_[kMaxDelta] = motor.following_error_limit;
  values_[kDefMaxVel] = values_[kMaxVel] = motor.max_velocity;
  values_[kDefMaxAcc] = values_[kMaxAcc] = motor.max_acceleration;
  values_[kDefMaxCur] = values_[kMaxCur] = motor.torque_limit / kTorquePerAmpere;
  values_[kDefHomeVel] = motor.max_velocity / 20;
  values_[kDefHomeAcc] = values_[kTargetAcc] = motor.max_acceleration / 2;
  values_[kTargetVel] = motor.max_velocity / 2;
  values_[kDefHomeOffset] = values_[kHomeOffset] = config_.home_position;
  values_[kDefCubeSerial] = config_.serial;
  values_[kDefCubeVersion] = config_.revision;
  values_[kDefAddress] = config_.node;
  values_[kDefPrimBaud] = values_[kDefScndBaud] = 2;  // 500 kbit/s
  values_[kIncRatio] = config_.counts_per_unit;
  homed_ = config_.homed;
  zero_ = homed_ ? 0 : motor_.shaft().position;
  errors_ = 0;
  beyond_soft_ = ramp_ended_ = false;
  activity_ = Activity::idle;
  refreshed_.reset();
  waiting_.reset();
  deaf_s_ = kBootTime_s;
}

void PowerCubeNode::answer(Bytes bytes) {
  CanFrame frame;
  frame.id = 0x0A0 + static_cast<std::uint32_t>(config_.node);
  frame.size = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  send_(frame);
}

void PowerCubeNode::acknowledge(std::initializer_list<std::uint8_t> bytes) {
  if ((static_cast<std::uint32_t>(values_[kConfigWord]) & kDisableAck) == 0) answer({bytes.begin(), bytes.size()});
}

void PowerCubeNode::receive(const CanFrame& frame, RobotTime now) {
  if (deaf_s_ > 0 || frame.error || frame.extended || frame.fd || frame.remote || frame.size == 0) return;
  const std::uint32_t module = static_cast<std::uint32_t>(config_.node);
  const Bytes bytes = frame.payload();
  if (frame.id == 0x100 && frame.size == 1)
    broadcast(bytes[0], now);
  else if (frame.id == 0x0C0 + module && frame.size == 2 && bytes[0] == kGetExtended)
    get(bytes[1]);
  else if (frame.id == 0x0E0 + module)
    tell(bytes, now);
}

void PowerCubeNode::broadcast(std::uint8_t command, RobotTime now) {
  switch (command) {
    case 0x00: reset(); return;
    case 0x01: home(); return;
    case 0x02: halt(); return;
    case 0x07: refresh_watchdog(now); return;
    case 0x0F:
      if (waiting_) move((*waiting_)[1], Bytes(*waiting_).subspan(2, waiting_size_ - 2u));
      waiting_.reset();
      return;
    default: return;  // SetBaud and SavePos: it stores nothing
  }
}

void PowerCubeNode::tell(Bytes bytes, RobotTime now) {
  const std::uint8_t command = bytes[0];
  switch (command) {
    case 0x00:
      if (bytes.size() == 1 && reset()) acknowledge({command, kAck});
      return;
    case 0x01:
      if (bytes.size() == 1 && home()) acknowledge({command, kAck});
      return;
    case 0x02:
      if (bytes.size() == 1 && halt()) acknowledge({command, kAck});
      return;
    case 0x07:
      if (bytes.size() == 1) refresh_watchdog(now);
      return;
    case 0x09:
      if (bytes.size() == 1) acknowledge({command, kAck});
      return;
    case kSetExtended:
      if (bytes.size() >= 3 && set(bytes[1], bytes.subspan(2))) acknowledge({command, bytes[1], kAck});
      return;
    case kSetMotion:
      if (bytes.size() >= 4) accept_motion(bytes);
      return;
    case 0x0D:
      if (bytes.size() == 7 && move(0x0B, bytes.subspan(1))) acknowledge({command, kAck});
      return;
    default: return;
  }
}

void PowerCubeNode::refresh_watchdog(RobotTime now) {
  refreshed_ = now;
  values_[kConfigWord] = static_cast<std::uint32_t>(values_[kConfigWord]) | kWatchdogEnable;
}

bool PowerCubeNode::reset() {
  if (activity_ == Activity::halt) return false;  // first it stops
  errors_ = 0;
  beyond_soft_ = false;
  return true;
}

bool PowerCubeNode::halt() {
  errors_ |= kHalted;
  waiting_.reset();
  if (motor_.shaft().powered) begin(Activity::halt);
  return true;
}

bool PowerCubeNode::home() {
  if (errors_ != 0) return false;
  homed_ = false;
  begin(Activity::homing);
  return true;
}

void PowerCubeNode::accept_motion(Bytes bytes) {
  const std::uint8_t motion = bytes[1];
  bool good;
  if ((static_cast<std::uint32_t>(values_[kConfigWord]) & kSyncMotion) != 0) {
    waiting_.emplace();
    std::copy(bytes.begin(), bytes.end(), waiting_->begin());
    waiting_size_ = static_cast<std::uint8_t>(bytes.size());
    good = homed_ && errors_ == 0;
  } else {
    good = move(motion, bytes.subspan(2));
  }
  if (motion >= 0x0E && motion <= 0x17 && motion != 0x0F && motion != 0x14) {
    std::array<std::uint8_t, 8> out{kSetMotion, motion};
    const bool integer = motion >= 0x13;
    encode(shown_position() * (integer ? config_.counts_per_unit : 1), integer ? Coding::int32 : Coding::real,
           std::span(out).subspan(2, 4));
    out[6] = short_state();
    if ((static_cast<std::uint32_t>(values_[kConfigWord]) & kDisableAck) == 0) answer(out);
  } else if (good) {
    acknowledge({kSetMotion, motion, kAck});
  }
}

// Motions 0Eh .. 17h are 04h .. 0Dh with the extended acknowledge.
bool PowerCubeNode::move(std::uint8_t motion, Bytes value) {
  const std::uint8_t plain = motion >= 0x0E ? static_cast<std::uint8_t>(motion - 0x0A) : motion;
  const bool integer = plain >= 0x09, step = plain == 0x06 || plain == 0x0B;
  const Coding coding = plain == 0x0D ? Coding::int16 : integer ? Coding::int32 : Coding::real;
  if (plain < 0x04 || plain > 0x0D || plain == 0x05 || plain == 0x0A) return false;
  if (value.size() != powercube::size_of(coding) + (step ? 2u : 0u) || !homed_ || errors_ != 0) return false;
  const double raw = decode(value.first(powercube::size_of(coding)), coding);
  if (!std::isfinite(raw)) return false;
  const double amount = plain == 0x0D ? raw * kAmperePerDigit : integer ? raw / config_.counts_per_unit : raw;
  switch (plain) {
    case 0x04:
    case 0x09:
      target_ = cut(amount);
      begin(Activity::ramp);
      return true;
    case 0x06:
    case 0x0B: {
      const double interval_s = std::max(0.001, static_cast<double>(decode_integer(value.subspan(4, 2), false)) * 1e-3);
      begin(Activity::step);
      const bool alone = interval_s > kLongestCyclicStep_s && steps_.resting();
      steps_.queue(cut(amount), alone ? interval_s / 2 : interval_s);
      return true;
    }
    case 0x07:
    case 0x0C:
      begin(Activity::velocity);
      target_ = config_.motor.limits_off ? amount : std::clamp(amount, -values_[kMaxVel], values_[kMaxVel]);
      return true;
    default:
      begin(Activity::current);
      current_ = config_.motor.limits_off ? amount : std::clamp(amount, -values_[kMaxCur], values_[kMaxCur]);
      return true;
  }
}

bool PowerCubeNode::set(std::uint8_t parameter, Bytes value) {
  const Coding how = coding(parameter);
  if (!settable(parameter) || value.size() != powercube::size_of(how)) return false;
  const double number = decode(value, how);
  if (!std::isfinite(number) || (positive(parameter) && number <= 0)) return false;
  if (parameter == kMaxVel && number > values_[kDefMaxVel]) return false;
  if (parameter == kMaxAcc && number > values_[kDefMaxAcc]) return false;
  values_[parameter] = number;
  return true;
}

void PowerCubeNode::get(std::uint8_t parameter) {
  const Coding how = coding(parameter);
  if (how == Coding::none) return;
  std::array<std::uint8_t, 8> out{kGetExtended, parameter};
  encode(this->parameter(parameter), how, std::span(out).subspan(2, powercube::size_of(how)));
  answer(Bytes(out).first(2 + powercube::size_of(how)));
}

double PowerCubeNode::parameter(std::uint8_t parameter) {
  const ShaftState& shaft = motor_.shaft();
  switch (parameter) {
    case kPosCount: return shown_position() * config_.counts_per_unit;
    case kCubeState: return state_word();
    case kActPos:
    case kActPosPrev: return shown_position();
    case kIPolPos: return reference_.position - zero_;
    case kDeltaPos: return motor_.following_error();
    case kActVel: return garbage_ ? arbitrary() * 1e6 : frozen_ ? 0 : shaft.velocity;
    case kIPolVel: return reference_.velocity;
    case kCur: return shaft.torque / kTorquePerAmpere;
    case kTargetPos: return target_ - zero_;
    case kRawCur: return shaft.torque / kTorquePerAmpere / kAmperePerDigit;
    default: return values_[parameter];
  }
}

double PowerCubeNode::shown_position() {
  if (frozen_) return frozen_position_;
  if (!garbage_) return encoder() - zero_;
  const double die = arbitrary();
  if (die > 0.5) return std::numeric_limits<double>::quiet_NaN();
  return die > 0 ? std::numeric_limits<double>::infinity() : die * 1e30;
}

void PowerCubeNode::inject(DriveFault fault, double value) {
  switch (fault) {
    case DriveFault::recover:
      frozen_ = garbage_ = false;
      noise_ = 0;
      motor_.jam(false);
      values_[kDefCubeSerial] = config_.serial;
      values_[kDefCubeVersion] = config_.revision;
      return;
    case DriveFault::overcurrent:
      // A short circuit leaves no current to brake with.
      fail(kPowerFault | kShortCircuit);
      motor_.power(false);
      activity_ = Activity::idle;
      return;
    case DriveFault::tow_error: return fail(kTowError);
    case DriveFault::reset: return power_up();
    case DriveFault::frozen:
      frozen_position_ = shown_position();
      frozen_ = true;
      return;
    case DriveFault::garbage: garbage_ = true; return;
    case DriveFault::wrong_identity:
      values_[kDefCubeSerial] = config_.serial ^ 0x5555u;
      values_[kDefCubeVersion] = (config_.revision ^ 0x5555u) & 0xffff;
      return;
    case DriveFault::jam: motor_.jam(true); return;
    case DriveFault::noisy: noise_ = value; return;
    case DriveFault::emergency:
    case DriveFault::silent:
    case DriveFault::slow:
    case DriveFault::unplugged:
    case DriveFault::no_power: return;
  }
}

}  // namespace foresight::sim
