#include "drivers/powercube/motion_protocol.hpp"

#include <fmt/core.h>

#include <bit>

namespace foresight::powercube {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// What follows the command.
enum class Shape : std::uint8_t { none, number, ok, byte_code, word_code, period_mask, state, two_bytes, number_bytes };

struct Row {
  MotionCommand command;
  bool from_module;
  Shape shape;
  const char* words;
};

constexpr Row kRows[] = {
    {MotionCommand::error, true, Shape::byte_code, "error"},
    {MotionCommand::warning, true, Shape::byte_code, "warning"},
    {MotionCommand::info, true, Shape::word_code, "info"},
    {MotionCommand::acknowledge, false, Shape::none, "acknowledge"},
    {MotionCommand::acknowledge, true, Shape::ok, "acknowledge"},
    {MotionCommand::reference, false, Shape::none, "reference"},
    {MotionCommand::reference, true, Shape::ok, "reference"},
    {MotionCommand::move_blocked, true, Shape::number, "stands at"},
    {MotionCommand::position_reached, true, Shape::number, "in position"},
    {MotionCommand::get_state, false, Shape::period_mask, "tell the state every s"},
    {MotionCommand::get_state, true, Shape::state, "position"},
    {MotionCommand::move_position, false, Shape::number, "move to position"},
    {MotionCommand::move_position, true, Shape::number, "will be there in s"},
    {MotionCommand::move_current, false, Shape::number, "move with A"},
    {MotionCommand::move_current, true, Shape::ok, "move with current"},
    {MotionCommand::move_velocity, false, Shape::number, "move with velocity"},
    {MotionCommand::move_velocity, true, Shape::ok, "move with velocity"},
    {MotionCommand::check, false, Shape::two_bytes, "check communication"},
    {MotionCommand::check, true, Shape::number_bytes, "check communication"},
};

constexpr struct {
  std::uint16_t code;
  const char* words;
} kCodes[] = {
    {0x00, "no error"},
    {0x08, "no error"},
    {0x74, "ERROR MOTOR VOLTAGE LOW"},
    {0xD6, "ERROR SOFT HIGH (upper software limit)"},
    {0xDA, "ERROR TOW (following error)"},
};

constexpr std::uint8_t kOk[] = {0x4F, 0x4B};

const Row* find_row(std::uint8_t command, bool from_module) {
  for (const Row& row : kRows)
    if (static_cast<std::uint8_t>(row.command) == command && row.from_module == from_module) return &row;
  return nullptr;
}

std::size_t size_of(Shape shape) {
  switch (shape) {
    case Shape::none: return 0;
    case Shape::byte_code: return 1;
    case Shape::ok:
    case Shape::word_code:
    case Shape::two_bytes: return 2;
    case Shape::number: return 4;
    case Shape::period_mask: return 5;
    case Shape::state:
    case Shape::number_bytes: return 6;
  }
  return 0;
}

float number(Bytes b) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= std::uint32_t{b[i]} << (8 * i);
  return std::bit_cast<float>(bits);
}

bool read(Shape shape, Bytes b, MotionMessage& out) {
  if (b.size() != size_of(shape)) return false;
  switch (shape) {
    case Shape::none: break;
    case Shape::number: out.value = number(b); break;
    case Shape::ok: out.ok = b[0] == kOk[0] && b[1] == kOk[1]; return out.ok;
    case Shape::byte_code: out.code = b[0]; break;
    case Shape::word_code: out.code = static_cast<std::uint16_t>(b[0] | b[1] << 8); break;
    case Shape::period_mask:
      out.value = number(b);
      out.mask = b[4];
      break;
    case Shape::state:
      out.value = number(b);
      out.state = b[4];
      out.code = b[5];
      break;
    case Shape::two_bytes:
      out.mask = b[0];
      out.state = b[1];
      break;
    case Shape::number_bytes:
      out.value = number(b);
      out.mask = b[4];
      out.state = b[5];
      break;
  }
  return true;
}

// Index: MotionSender.
constexpr std::uint8_t kGroups[] = {0x05, 0x07, 0x03};

std::optional<MotionSender> sender_of_group(unsigned group) {
  for (std::size_t i = 0; i < std::size(kGroups); ++i)
    if (kGroups[i] == group) return static_cast<MotionSender>(i);
  return std::nullopt;
}

}  // namespace

std::optional<MotionMessage> decode_motion(MotionSender sender, int module, Bytes bytes) {
  if (bytes.size() < 2) return std::nullopt;
  const Row* row = find_row(bytes[1], sender != MotionSender::master);
  if (row == nullptr) return std::nullopt;
  const bool is_error = row->command == MotionCommand::error;
  if (sender == MotionSender::module_error && !is_error) return std::nullopt;
  MotionMessage out{.sender = sender, .module = module, .command = row->command};
  if (!read(row->shape, bytes.subspan(2), out)) return std::nullopt;
  out.wrong_length = bytes[0] != bytes.size() - 1;
  return out;
}

std::optional<MotionMessage> decode_motion(const CanFrame& frame) {
  if (frame.error || frame.remote || frame.extended || frame.fd || frame.size > 8) return std::nullopt;
  const auto sender = sender_of_group((frame.id & 0x780) >> 8);
  if (!sender || (frame.id & 0x80) != 0) return std::nullopt;
  return decode_motion(*sender, static_cast<int>(frame.id & 0x7f), frame.payload());
}

const char* motion_code(std::uint16_t code) noexcept {
  for (const auto& row : kCodes)
    if (row.code == code) return row.words;
  return "unknown code";
}

std::string describe(const MotionMessage& m) {
  const Row* row = find_row(static_cast<std::uint8_t>(m.command), m.sender != MotionSender::master);
  if (row == nullptr) return "unknown";
  std::string out = (m.sender == MotionSender::master ? "to module " : "module ") + std::to_string(m.module) + ": ";
  out += row->words;
  if (m.value) out += fmt::format(" {:.7g}", *m.value);
  if (m.command == MotionCommand::get_state && m.state) out += (*m.state & 0x02) != 0 ? ", moving" : ", not moving";
  if (m.code) out += fmt::format("{} 0x{:02X} {}", m.value ? "," : "", *m.code, motion_code(*m.code));
  if (m.ok) out += ": ok";
  if (m.wrong_length) out += " (wrong length byte)";
  return out;
}

}  // namespace foresight::powercube
