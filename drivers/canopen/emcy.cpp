#include "drivers/canopen/emcy.hpp"

#include <algorithm>

#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

struct Name {
  std::uint16_t code;
  const char* text;
};

constexpr Name kCodes[] = {
    {0x0000, "no error"},
    {0x2310, "continuous over-current"},
    {0x2320, "short circuit or earth leakage"},
    {0x2330, "earth leakage"},
    {0x2340, "short circuit"},
    {0x3110, "mains over-voltage"},
    {0x3120, "mains under-voltage"},
    {0x3210, "DC link over-voltage"},
    {0x3220, "DC link under-voltage"},
    {0x3230, "load error"},
    {0x4110, "excess ambient temperature"},
    {0x4210, "excess temperature of the device"},
    {0x4310, "excess temperature of the drive"},
    {0x5112, "low voltage of the 24 V supply"},
    {0x5113, "low voltage of the 5 V supply"},
    {0x5530, "EEPROM fault"},
    {0x6010, "software reset (watchdog)"},
    {0x6320, "parameter error"},
    {0x7121, "motor blocked"},
    {0x7122, "motor error or wrong commutation"},
    {0x7305, "incremental encoder 1 fault"},
    {0x7306, "incremental encoder 2 fault"},
    {0x7310, "speed sensor fault"},
    {0x7320, "position sensor fault"},
    {0x8110, "CAN overrun (objects lost)"},
    {0x8120, "CAN in error-passive mode"},
    {0x8130, "life guarding or heartbeat lost"},
    {0x8140, "recovered from bus-off"},
    {0x8150, "CAN identifier collision"},
    {0x8210, "PDO not processed, too short"},
    {0x8220, "PDO too long"},
    {0x8230, "multiplexed PDO without destination"},
    {0x8240, "unexpected SYNC length"},
    {0x8250, "RPDO timeout"},
    {0x8311, "excess torque"},
    {0x8400, "velocity controller"},
    {0x8500, "position controller"},
    {0x8600, "positioning controller"},
    {0x8611, "following error"},
    {0x8612, "reference limit"},
    {0x8A00, "synchronisation controller"},
};

constexpr Name kSubClasses[] = {
    {0x2100, "current, device input side"},
    {0x2200, "current inside the device"},
    {0x2300, "current, device output side"},
    {0x3100, "mains voltage"},
    {0x3200, "voltage inside the device"},
    {0x3300, "output voltage"},
    {0x4100, "ambient temperature"},
    {0x4200, "device temperature"},
    {0x4300, "drive temperature"},
    {0x6100, "internal software"},
    {0x6200, "user software"},
    {0x6300, "data set"},
    {0x8100, "communication"},
    {0x8200, "protocol error"},
};

constexpr const char* kClasses[16] = {"error reset",
                                      "generic error",
                                      "current",
                                      "voltage",
                                      "temperature",
                                      "device hardware",
                                      "device software",
                                      "additional modules",
                                      "monitoring",
                                      "external error",
                                      "unknown error class",
                                      "unknown error class",
                                      "unknown error class",
                                      "unknown error class",
                                      "unknown error class",
                                      "additional functions or device specific"};

const char* find(std::span<const Name> names, std::uint16_t code) {
  const auto found = std::find_if(names.begin(), names.end(), [code](const Name& n) { return n.code == code; });
  return found == names.end() ? nullptr : found->text;
}

}  // namespace

std::optional<Emergency> parse_emergency(const CanFrame& frame) noexcept {
  if (!is_canopen(frame) || frame.size != 8 || frame.id <= kEmcyId || frame.id > kEmcyId + kLargestNode)
    return std::nullopt;
  Emergency out;
  out.node = static_cast<int>(frame.id - kEmcyId);
  out.code = static_cast<std::uint16_t>(load(frame.payload(), 2));
  out.error_register = frame.data[2];
  std::copy_n(frame.data.begin() + 3, 5, out.manufacturer.begin());
  return out;
}

const char* emergency_name(std::uint16_t code) noexcept {
  if (const char* name = find(kCodes, code)) return name;
  if (const char* name = find(kSubClasses, code & 0xff00)) return name;
  if ((code & 0xff00) == 0xff00) return "device specific";
  if ((code & 0xff00) == 0xf000) return "additional functions";
  return kClasses[code >> 12];
}

std::string error_register_text(std::uint8_t value) {
  constexpr const char* kBits[8] = {"generic",       "current",        "voltage",  "temperature",
                                    "communication", "device profile", "reserved", "manufacturer"};
  std::string out;
  for (unsigned bit = 0; bit < 8; ++bit)
    if (value >> bit & 1u) out += (out.empty() ? "" : ", ") + std::string(kBits[bit]);
  return out.empty() ? "none" : out;
}

}  // namespace foresight::canopen
