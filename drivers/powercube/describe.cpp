#include <fmt/core.h>

#include "drivers/powercube/protocol.hpp"
#include "drivers/powercube/tables.hpp"

namespace foresight::powercube {
namespace {

std::string number(double value) {
  return fmt::format("{:.9g}", value);
}

std::string motion_text(const Message& m) {
  const MotionInfo& info = *find_motion(m.code);
  return std::string(info.name) + " " + number(m.value) +
         (info.timed ? " in " + std::to_string(m.milliseconds) + " ms" : "");
}

std::string value_text(const Message& m) {
  const bool state = m.is(m.kind, Param::cube_state);
  return std::string(find_param(m.code)->name) + " = " +
         (state ? words(static_cast<std::uint32_t>(m.value), state_bits()) : number(m.value));
}

std::string answer_text(const char* what, bool accepted) {
  return std::string(what) + (accepted ? " accepted" : " refused");
}

std::string text_of(const Message& m) {
  using Kind = Message::Kind;
  switch (m.kind) {
    case Kind::unknown: break;
    case Kind::get: return std::string("Get ") + find_param(m.code)->name;
    case Kind::set: return "Set " + value_text(m);
    case Kind::order: return find_name(kCommandNames, m.code);
    case Kind::motion: return motion_text(m);
    case Kind::istep: return "SetIStep " + number(m.value) + " in " + std::to_string(m.milliseconds) + " ms";
    case Kind::broadcast: return find_name(kBroadcastNames, m.code);
    case Kind::value: return value_text(m);
    case Kind::set_answer: return answer_text(find_param(m.code)->name, m.accepted);
    case Kind::order_answer: return answer_text(find_name(kCommandNames, m.code), m.accepted);
    case Kind::motion_answer: return answer_text(find_motion(m.code)->name, m.accepted);
    case Kind::position:
      return std::string(find_motion(m.code)->name) + ": position " + number(m.value) + ", " +
             words(m.short_state, short_state_bits()) + ", io " + words(m.digital_io, digital_io_bits());
  }
  return "unknown";
}

}  // namespace

std::string describe(const CanFrame& frame) {
  const Message m = decode(frame);
  if (m.kind == Message::Kind::unknown) return "unknown";
  if (m.kind == Message::Kind::broadcast) return "to all: " + text_of(m);
  return (m.from_host() ? "to module " : "module ") + std::to_string(m.module) + ": " + text_of(m);
}

}  // namespace foresight::powercube
