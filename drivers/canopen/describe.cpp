#include "drivers/canopen/describe.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "drivers/canopen/abort_code.hpp"
#include "drivers/canopen/cia402.hpp"
#include "drivers/canopen/emcy.hpp"
#include "drivers/canopen/nmt.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

struct ObjectName {
  std::uint16_t index;
  int sub;  // -1: any
  const char* name;
};
constexpr ObjectName kObjects[] = {
    {0x1000, 0, "device type"},
    {0x1001, 0, "error register"},
    {0x1005, 0, "COB-ID of SYNC"},
    {0x1016, -1, "consumer heartbeat time"},
    {0x1017, 0, "producer heartbeat time"},
    {0x1018, 1, "vendor id"},
    {0x1018, 2, "product code"},
    {0x1018, 3, "revision number"},
    {0x1018, 4, "serial number"},
    {0x1029, 1, "error behaviour, communication"},
    {0x6007, 0, "abort connection option"},
    {0x603F, 0, "error code"},
    {0x6040, 0, "controlword"},
    {0x6041, 0, "statusword"},
    {0x605A, 0, "quick stop option"},
    {0x6060, 0, "mode of operation"},
    {0x6061, 0, "mode of operation shown"},
    {0x6064, 0, "actual position"},
    {0x606C, 0, "actual velocity"},
    {0x607A, 0, "target position"},
    {0x607D, -1, "position limit"},
    {0x607F, 0, "largest profile velocity"},
    {0x6080, 0, "largest motor speed"},
    {0x6083, 0, "profile acceleration"},
    {0x6084, 0, "profile deceleration"},
    {0x6085, 0, "quick stop deceleration"},
    {0x6098, 0, "homing method"},
    {0x6099, -1, "homing velocity"},
    {0x609A, 0, "homing acceleration"},
    {0x60C2, -1, "interpolation period"},
    {0x60FF, 0, "target velocity"},
    {0x6502, 0, "supported modes"},
};

std::string bytes_text(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (std::uint8_t b : bytes) out += fmt::format("{}{:02X}", out.empty() ? "" : " ", b);
  return out.empty() ? "no data" : out;
}

std::string object_text(std::uint16_t index, std::uint8_t sub, const Vocabulary& words) {
  const std::string name = object_name(index, sub);
  if (words.objects)
    if (const ObjectEntry* entry = words.objects->find(index, sub)) return name + " " + entry->name;
  for (const ObjectName& known : kObjects)
    if (known.index == index && (known.sub < 0 || known.sub == sub)) return name + " " + known.name;
  return name;
}

std::string status_text(std::uint16_t status) {
  const auto state = state_of(status);
  std::string out = state ? to_string(*state) : "no state of CiA 402";
  if (status & kStatusTargetReached) out += ", target reached";
  if (status & kStatusLimit) out += ", limit";
  return out;
}

// A value of `bytes` valid bytes as the object means it.
std::string value_text(std::uint16_t index, std::uint64_t value, int bytes) {
  const std::string hex = fmt::format("0x{:0{}X}", value, 2 * bytes);
  const auto number = static_cast<long long>(sign_extended(value, 8 * bytes));
  switch (index) {
    case 0x6040: return hex + " (" + to_string(command_of(static_cast<std::uint16_t>(value))) + ")";
    case 0x6041: return hex + " (" + status_text(static_cast<std::uint16_t>(value)) + ")";
    case 0x6060:
    case 0x6061: return fmt::format("{} ({})", number, to_string(static_cast<OperationMode>(number)));
    case 0x6064:
    case 0x606C:
    case 0x607A:
    case 0x607D:
    case 0x60FF: return fmt::format("{} ({})", hex, number);
    case 0x1000: return fmt::format("{} (profile {})", hex, value & 0xffff);
    case 0x1017: return fmt::format("{} ({} ms)", hex, value);
    default: return hex;
  }
}

std::string expedited_text(const CanFrame& frame, std::uint16_t index) {
  const std::uint8_t command = frame.data[0];
  const int valid = command & 1 ? 4 - (command >> 2 & 3) : 4;
  return value_text(index, load(frame.payload().subspan(4), static_cast<std::size_t>(valid)), valid);
}

std::string sdo_text(const CanFrame& frame, bool answer, const Vocabulary& words) {
  if (frame.size != 8) return "malformed, " + std::to_string(frame.size) + " bytes";
  const std::uint8_t command = frame.data[0];
  const auto index = static_cast<std::uint16_t>(load(frame.payload().subspan(1), 2));
  const std::string object = object_text(index, frame.data[3], words);
  const int specifier = command >> 5;
  const int segment = 7 - (command >> 1 & 7);
  const std::string toggle = command & 0x10 ? ", toggle 1" : ", toggle 0";
  const std::string segment_text = bytes_text(frame.payload().subspan(1, static_cast<std::size_t>(segment))) + toggle +
                                   (command & 1 ? ", last" : "");
  const auto size = [&] {
    return command & 1 ? fmt::format(", {} bytes follow", load(frame.payload().subspan(4), 4))
                       : std::string(", segments follow");
  };
  if (specifier == 4) {
    const auto code = static_cast<std::uint32_t>(load(frame.payload().subspan(4), 4));
    return "abort " + object + fmt::format(", 0x{:08X} {}", code, abort_name(code));
  }
  if (specifier == 5 || specifier == 6) return "block transfer";
  if (answer) {
    if (specifier == 0) return "upload segment " + segment_text;
    if (specifier == 1) return "download segment taken" + toggle;
    if (specifier == 2) return "upload " + object + (command & 2 ? " = " + expedited_text(frame, index) : size());
    if (specifier == 3) return "download " + object + " done";
  } else {
    if (specifier == 0) return "download segment " + segment_text;
    if (specifier == 1) return "download " + object + (command & 2 ? " = " + expedited_text(frame, index) : size());
    if (specifier == 2) return "upload " + object;
    if (specifier == 3) return "upload next segment" + toggle;
  }
  return "unknown command";
}

std::string pdo_values(const Pdo& pdo, const CanFrame& frame, const Vocabulary& words) {
  std::string out;
  for (std::size_t i = 0; i < pdo.entries().size(); ++i) {
    const PdoEntry& e = pdo.entries()[i];
    const auto value = static_cast<std::uint64_t>(pdo.get(frame, i));
    const std::uint64_t cut = e.bits >= 64 ? value : value & ((std::uint64_t{1} << e.bits) - 1);
    out += (i ? "; " : "") + object_text(e.index, e.sub, words) + " = " + value_text(e.index, cut, (e.bits + 7) / 8);
  }
  return out;
}

std::string pdo_text(const CanFrame& frame, const Vocabulary& words) {
  const auto known =
      std::find_if(words.pdos.begin(), words.pdos.end(), [&](const Pdo& p) { return p.cob_id() == frame.id; });
  const bool from_node = frame.id & 0x80;
  const unsigned node = frame.id & 0x7f, number = frame.id / 0x100 - (from_node ? 0u : 1u);
  std::string head = fmt::format("{}PDO{} {} node {}: ", from_node ? "T" : "R", number, from_node ? "of" : "to", node);
  if (known != words.pdos.end()) {
    head = known->name() +
           fmt::format(" {} node {}: ", known->direction() == PdoDirection::from_node ? "of" : "to", known->node());
    if (!known->carried_by(frame)) return head + bytes_text(frame.payload()) + ", too short";
    return head + pdo_values(*known, frame, words);
  }
  if (from_node ? number > 4 : number < 1 || number > 4) return "unknown";
  head += bytes_text(frame.payload());
  const auto word = static_cast<std::uint16_t>(load(frame.payload(), 2));
  if (number != 1 || frame.size < 2) return head;
  if (!from_node) return head + ", as control word: " + to_string(command_of(word));
  return state_of(word) ? head + ", as status word: " + status_text(word) : head;
}

}  // namespace

std::string describe(const CanFrame& frame, const Vocabulary& words) {
  if (!is_canopen(frame)) return "unknown";
  const unsigned node = frame.id & 0x7f;
  if (frame.id == kNmtId) {
    const std::string command = frame.size == 2 ? to_string(static_cast<NmtCommand>(frame.data[0])) : "?";
    if (command == "?" || frame.data[1] > kLargestNode) return "unknown";
    return "NMT " + command + (frame.data[1] == 0 ? ", all nodes" : fmt::format(", node {}", frame.data[1]));
  }
  if (frame.id == kSyncId)
    return frame.size == 0 ? "SYNC" : frame.size == 1 ? fmt::format("SYNC, counter {}", frame.data[0]) : "unknown";
  if (frame.id == kTimeId) return frame.size == 6 ? "TIME " + bytes_text(frame.payload()) : "unknown";
  if (const auto emergency = parse_emergency(frame))
    return fmt::format("EMCY of node {}: 0x{:04X} {}, error register 0x{:02X}", node, emergency->code,
                       emergency_name(emergency->code), emergency->error_register) +
           (emergency->error_register ? " (" + error_register_text(emergency->error_register) + ")" : "");
  if (const auto heartbeat = parse_heartbeat(frame))
    return heartbeat->state == NmtState::boot_up
               ? fmt::format("boot-up of node {}", node)
               : fmt::format("heartbeat of node {}: {}", node, to_string(heartbeat->state));
  if (node == 0) return "unknown";
  if (frame.id > kSdoAnswerId && frame.id < kSdoRequestId)
    return fmt::format("SDO answer of node {}: ", node) + sdo_text(frame, true, words);
  if (frame.id > kSdoRequestId && frame.id <= kSdoRequestId + kLargestNode)
    return fmt::format("SDO request to node {}: ", node) + sdo_text(frame, false, words);
  return frame.id > kTpdo1Id && frame.id < kSdoAnswerId ? pdo_text(frame, words) : "unknown";
}

}  // namespace foresight::canopen
