#include "drivers/powercube/protocol.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "drivers/powercube/tables.hpp"

namespace foresight::powercube {
namespace {

std::size_t size_of(ValueType type) {
  switch (type) {
    case ValueType::float32:
    case ValueType::int32:
    case ValueType::uint32: return 4;
    case ValueType::int16:
    case ValueType::uint16: return 2;
    case ValueType::uint8: return 1;
  }
  return 0;
}

void append(CanFrame& frame, std::uint32_t bits, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) frame.data[frame.size++] = static_cast<std::uint8_t>(bits >> (8 * i));
}

template <typename Integer>
std::uint32_t rounded(double value) {
  if (std::isnan(value)) return 0;
  const double lowest = std::numeric_limits<Integer>::lowest(), highest = std::numeric_limits<Integer>::max();
  return static_cast<std::uint32_t>(static_cast<Integer>(std::clamp(std::round(value), lowest, highest)));
}

void append(CanFrame& frame, ValueType type, double value) {
  std::uint32_t bits = 0;
  switch (type) {
    case ValueType::float32: bits = std::bit_cast<std::uint32_t>(static_cast<float>(value)); break;
    case ValueType::int32: bits = rounded<std::int32_t>(value); break;
    case ValueType::uint32: bits = rounded<std::uint32_t>(value); break;
    case ValueType::int16: bits = rounded<std::int16_t>(value); break;
    case ValueType::uint16: bits = rounded<std::uint16_t>(value); break;
    case ValueType::uint8: bits = rounded<std::uint8_t>(value); break;
  }
  append(frame, bits, size_of(type));
}

double read(const CanFrame& frame, std::size_t at, ValueType type) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < size_of(type); ++i) bits |= std::uint32_t{frame.data[at + i]} << (8 * i);
  switch (type) {
    case ValueType::float32: return std::bit_cast<float>(bits);
    case ValueType::int32: return static_cast<std::int32_t>(bits);
    case ValueType::int16: return static_cast<std::int16_t>(bits);
    default: return bits;
  }
}

CanFrame starting_with(std::uint32_t id, Command what) {
  CanFrame frame;
  frame.id = id;
  frame.data[frame.size++] = static_cast<std::uint8_t>(what);
  return frame;
}

bool is_order(std::uint8_t code) {
  return code <= 0x02 || code == static_cast<std::uint8_t>(Command::recalc_pid_params);
}

bool is(std::uint8_t code, Command what) {
  return code == static_cast<std::uint8_t>(what);
}

Message read_broadcast(const CanFrame& f) {
  const bool known = find_name(kBroadcastNames, f.data[0]) != nullptr;
  const bool sized = f.size == 1 || (f.data[0] == kBroadcastSetBaud && f.size == 2);
  if (!known || !sized) return {};
  return {.kind = Message::Kind::broadcast, .code = f.data[0], .value = f.size == 2 ? double(f.data[1]) : 0};
}

Message read_get(const CanFrame& f) {
  if (f.size != 2 || !is(f.data[0], Command::get_extended) || find_param(f.data[1]) == nullptr) return {};
  return {.kind = Message::Kind::get, .code = f.data[1]};
}

Message read_put(const CanFrame& f) {
  const std::uint8_t code = f.data[0];
  if (f.size == 1 && is_order(code)) return {.kind = Message::Kind::order, .code = code};
  if (is(code, Command::set_istep) && f.size == 7) {
    return {.kind = Message::Kind::istep,
            .code = code,
            .value = read(f, 1, ValueType::int32),
            .milliseconds = static_cast<std::uint16_t>(read(f, 5, ValueType::uint16))};
  }
  if (f.size < 2) return {};
  if (is(code, Command::set_extended)) {
    const ParamInfo* param = find_param(f.data[1]);
    if (param == nullptr || f.size != 2 + size_of(param->type)) return {};
    return {.kind = Message::Kind::set, .code = f.data[1], .value = read(f, 2, param->type)};
  }
  if (is(code, Command::set_motion)) {
    const MotionInfo* motion = find_motion(f.data[1]);
    if (motion == nullptr || f.size != 2 + size_of(motion->type) + (motion->timed ? 2 : 0)) return {};
    Message out{.kind = Message::Kind::motion, .code = f.data[1], .value = read(f, 2, motion->type)};
    if (motion->timed) out.milliseconds = static_cast<std::uint16_t>(read(f, 6, ValueType::uint16));
    return out;
  }
  return {};
}

Message read_motion_answer(const CanFrame& f) {
  const MotionInfo* motion = find_motion(f.data[1]);
  if (motion == nullptr) return {};
  if (f.size == 3) {
    return {.kind = Message::Kind::motion_answer, .code = f.data[1], .accepted = f.data[2] == kAccepted};
  }
  if (f.size != 8 || !motion->extended) return {};
  return {.kind = Message::Kind::position,
          .code = f.data[1],
          .value = read(f, 2, motion->type == ValueType::float32 ? ValueType::float32 : ValueType::int32),
          .short_state = f.data[6],
          .digital_io = f.data[7],
          .accepted = true};
}

Message read_answer(const CanFrame& f) {
  const std::uint8_t code = f.data[0];
  if (is_order(code) && f.size <= 2) {
    return {.kind = Message::Kind::order_answer, .code = code, .accepted = f.size == 1 || f.data[1] == kAccepted};
  }
  if (f.size < 3) return {};
  if (is(code, Command::get_extended)) {
    const ParamInfo* param = find_param(f.data[1]);
    if (param == nullptr || f.size != 2 + size_of(param->type)) return {};
    return {.kind = Message::Kind::value, .code = f.data[1], .value = read(f, 2, param->type)};
  }
  if (is(code, Command::set_extended) && f.size == 3 && find_param(f.data[1]) != nullptr) {
    return {.kind = Message::Kind::set_answer, .code = f.data[1], .accepted = f.data[2] == kAccepted};
  }
  if (is(code, Command::set_motion)) return read_motion_answer(f);
  return {};
}

}  // namespace

CanFrame get_param(int module, Param param) noexcept {
  CanFrame frame = starting_with(kGetId + static_cast<std::uint32_t>(module), Command::get_extended);
  frame.data[frame.size++] = static_cast<std::uint8_t>(param);
  return frame;
}

CanFrame set_param(int module, Param param, double value) noexcept {
  CanFrame frame = starting_with(kPutId + static_cast<std::uint32_t>(module), Command::set_extended);
  frame.data[frame.size++] = static_cast<std::uint8_t>(param);
  if (const ParamInfo* info = find_param(static_cast<std::uint8_t>(param))) append(frame, info->type, value);
  return frame;
}

CanFrame command(int module, Command what) noexcept {
  return starting_with(kPutId + static_cast<std::uint32_t>(module), what);
}

CanFrame motion(int module, Motion what, double target, double milliseconds) noexcept {
  CanFrame frame = starting_with(kPutId + static_cast<std::uint32_t>(module), Command::set_motion);
  const MotionInfo& info = *find_motion(static_cast<std::uint8_t>(what));
  frame.data[frame.size++] = static_cast<std::uint8_t>(what);
  append(frame, info.type, target);
  if (info.timed) append(frame, ValueType::uint16, milliseconds);
  return frame;
}

CanFrame set_istep(int module, std::int32_t ticks, std::uint16_t milliseconds) noexcept {
  CanFrame frame = starting_with(kPutId + static_cast<std::uint32_t>(module), Command::set_istep);
  append(frame, ValueType::int32, ticks);
  append(frame, ValueType::uint16, milliseconds);
  return frame;
}

CanFrame broadcast(Command what) noexcept {
  return starting_with(kBroadcastId, what);
}

Message decode(const CanFrame& f) noexcept {
  if (f.error || f.remote || f.extended || f.fd || f.size < 1 || f.size > 8) return {};
  if (f.id == kBroadcastId) return read_broadcast(f);
  const int module = static_cast<int>(f.id & 0x1f);
  if (module == 0) return {};
  Message out;
  switch (f.id & ~std::uint32_t{0x1f}) {
    case kAnswerId: out = read_answer(f); break;
    case kGetId: out = read_get(f); break;
    case kPutId: out = read_put(f); break;
    default: return {};
  }
  out.module = out.kind == Message::Kind::unknown ? 0 : module;
  return out;
}

}  // namespace foresight::powercube
