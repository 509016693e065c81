#include "drivers/powercube/tables.hpp"

#include <vector>

#include "common/text.hpp"

namespace foresight::powercube {
namespace {

constexpr Param param(int code) {
  return static_cast<Param>(code);
}

using enum ValueType;

constexpr ParamInfo kParams[] = {
    {param(0x00), "DefHomeOffset", float32},
    {param(0x01), "DefGearRatio", float32},
    {param(0x02), "DefLinRatio", float32},
    {param(0x03), "DefMinPos", float32},
    {param(0x04), "DefMaxPos", float32},
    {param(0x05), "DefMaxDeltaPos", float32},
    {param(0x06), "DefMaxDeltaVel", float32},
    {param(0x07), "DefTorqueRatio", float32},
    {param(0x08), "DefCurRatio", float32},
    {param(0x09), "DefMinVel", float32},
    {param(0x0A), "DefMaxVel", float32},
    {param(0x0B), "DefMinAcc", float32},
    {param(0x0C), "DefMaxAcc", float32},
    {param(0x0D), "DefMinCur", float32},
    {param(0x0E), "DefMaxCur", float32},
    {param(0x0F), "DefHomeVel", float32},
    {param(0x10), "DefHomeAcc", float32},
    {param(0x1A), "DefCubeSerial", uint32},
    {param(0x1B), "DefConfig", uint32},
    {param(0x1C), "DefPulsesPerTurn", uint32},
    {param(0x1D), "DefCubeVersion", uint16},
    {param(0x1E), "DefServiceInterval", uint16},
    {param(0x1F), "DefBrakeTimeOut", uint16},
    {param(0x20), "DefAddress", uint8},
    {param(0x22), "DefPrimBaud", uint8},
    {param(0x23), "DefScndBaud", uint8},
    {param(0x24), "PosCount", int32},
    {param(0x25), "RefPosCount", int32},
    {param(0x26), "DioSetup", uint32},
    {param(0x27), "CubeState", uint32},
    {param(0x28), "TargetPosInc", uint32},
    {param(0x29), "TargetVelInc", uint32},
    {param(0x2A), "TargetAccInc", uint32},
    {param(0x2B), "StepInc", uint32},
    {param(0x2C), "HomeOffsetInc", int32},
    {param(0x35), "RawCur", int16},
    {param(0x36), "HomeToZeroInc", int32},
    {param(0x39), "Config", uint32},
    {param(0x3A), "MoveMode", uint8},
    {param(0x3B), "IncRatio", float32},
    {param(0x3C), "ActPos", float32},
    {param(0x3D), "ActPosPrev", float32},
    {param(0x3E), "IPolPos", float32},
    {param(0x3F), "DeltaPos", float32},
    {param(0x40), "MaxDeltaPos", float32},
    {param(0x41), "ActVel", float32},
    {param(0x42), "IPolVel", float32},
    {param(0x45), "MinPos", float32},
    {param(0x46), "MaxPos", float32},
    {param(0x48), "MaxVel", float32},
    {param(0x4A), "MaxAcc", float32},
    {param(0x4C), "MaxCur", float32},
    {param(0x4D), "Cur", float32},
    {param(0x4E), "TargetPos", float32},
    {param(0x4F), "TargetVel", float32},
    {param(0x50), "TargetAcc", float32},
    {param(0x51), "DefC0", int16},
    {param(0x52), "DefDamp", int16},
    {param(0x53), "DefA0", int16},
    {param(0x54), "ActC0", int16},
    {param(0x55), "ActDamp", int16},
    {param(0x56), "ActA0", int16},
    {param(0x57), "DefBurnCount", uint8},
    {param(0x58), "Setup", uint32},
    {param(0x59), "HomeOffset", float32},
};

constexpr MotionInfo kMotions[] = {
    {Motion::framp, "FRAMP", float32, false, false},
    {Motion::fstep, "FSTEP", float32, true, false},
    {Motion::fvel, "FVEL", float32, false, false},
    {Motion::fcur, "FCUR", float32, false, false},
    {Motion::iramp, "IRAMP", int32, false, false},
    {Motion::istep, "ISTEP", int32, true, false},
    {Motion::ivel, "IVEL", int32, false, false},
    {Motion::icur, "ICUR", int16, false, false},
    {Motion::framp_ack, "FRAMP_ACK", float32, false, true},
    {Motion::fstep_ack, "FSTEP_ACK", float32, true, true},
    {Motion::fvel_ack, "FVEL_ACK", float32, false, true},
    {Motion::fcur_ack, "FCUR_ACK", float32, false, true},
    {Motion::iramp_ack, "IRAMP_ACK", int32, false, true},
    {Motion::istep_ack, "ISTEP_ACK", int32, true, true},
    {Motion::ivel_ack, "IVEL_ACK", int32, false, true},
    {Motion::icur_ack, "ICUR_ACK", int16, false, true},
};

constexpr BitName kStateBits[] = {
    {0x00000001, "ERROR", "error"},
    {0x00000002, "HOME_OK", ""},
    {0x00000004, "HALTED", ""},
    {0x00000008, "POWERFAULT", "power fault"},
    {0x00000010, "TOW_ERROR", "following error"},
    {0x00000020, "COMM_ERROR", "communication error"},
    {0x00000040, "SWR", ""},
    {0x00000080, "SW1", ""},
    {0x00000100, "SW2", ""},
    {0x00000200, "BRAKE_ACTIVE", ""},
    {0x00000400, "CUR_LIMIT", ""},
    {0x00000800, "MOTION", ""},
    {0x00001000, "RAMP_ACC", ""},
    {0x00002000, "RAMP_STEADY", ""},
    {0x00004000, "RAMP_DEC", ""},
    {0x00008000, "RAMP_END", ""},
    {0x00010000, "INPROGRESS", ""},
    {0x00020000, "FULLBUFFER", ""},
    {0x00040000, "POW_VOLT_ERR", "supply voltage of the power stage"},
    {0x00080000, "POW_FET_TEMP", "power transistors too hot"},
    {0x00100000, "POW_WDG_TEMP", "motor winding too hot"},
    {0x00200000, "POW_SHORT_CUR", "short circuit in the power stage"},
    {0x00400000, "POW_HALL_ERR", "Hall sensors"},
    {0x00800000, "POW_INTEGRAL_ERR", "current over time too high"},
    {0x01000000, "CPU_OVERLOAD", "processor of the module overloaded"},
    {0x02000000, "BEYOND_HARD", "beyond a hard limit"},
    {0x04000000, "BEYOND_SOFT", "beyond a soft limit"},
    {0x08000000, "POW_SETUP_ERR", "set-up of the power stage"},
};

constexpr BitName kShortStateBits[] = {
    {0x01, "NOT_OK", ""}, {0x02, "SWR", ""},      {0x04, "SW1", ""},        {0x08, "SW2", ""},
    {0x10, "MOTION", ""}, {0x20, "RAMP_END", ""}, {0x40, "INPROGRESS", ""}, {0x80, "FULLBUFFER", ""},
};

constexpr BitName kDigitalIoBits[] = {
    {0x01, "IN0", ""},  {0x02, "IN1", ""},  {0x04, "IN2", ""},  {0x08, "IN3", ""},
    {0x10, "OUT0", ""}, {0x20, "OUT1", ""}, {0x40, "OUT2", ""}, {0x80, "OUT3", ""},
};

constexpr CodeName kBroadcasts[] = {
    {0x00, "Reset"},   {0x01, "Home"},    {0x02, "Halt"},       {0x07, "WatchdogRefresh"},
    {0x09, "SetBaud"}, {0x0E, "SavePos"}, {0x0F, "SyncMotion"},
};

constexpr CodeName kCommands[] = {
    {0x00, "Reset"},           {0x01, "Home"},        {0x02, "Halt"},      {0x08, "SetExtended"},
    {0x09, "RecalcPIDParams"}, {0x0A, "GetExtended"}, {0x0B, "SetMotion"}, {0x0D, "SetIStep"},
};
constexpr struct {
  std::uint8_t code;
  int kbit_per_s;
} kBaudRates[] = {{1, 250}, {2, 500}, {3, 1000}};

template <typename Row, typename Match>
const Row* find(std::span<const Row> rows, Match matches) noexcept {
  for (const Row& row : rows)
    if (matches(row)) return &row;
  return nullptr;
}

}  // namespace

const std::span<const CodeName> kBroadcastNames = kBroadcasts;
const std::span<const CodeName> kCommandNames = kCommands;

const char* find_name(std::span<const CodeName> names, std::uint8_t code) noexcept {
  const CodeName* row = find<CodeName>(names, [&](const CodeName& r) { return r.code == code; });
  return row != nullptr ? row->name : nullptr;
}

const ParamInfo* find_param(std::uint8_t code) noexcept {
  return find<ParamInfo>(kParams, [&](const ParamInfo& row) { return row.code == param(code); });
}

const ParamInfo* find_param(std::string_view name) noexcept {
  return find<ParamInfo>(kParams, [&](const ParamInfo& row) { return row.name == name; });
}

std::string nearest_param(std::string_view name) {
  std::vector<std::string> names;
  for (const ParamInfo& row : kParams) names.emplace_back(row.name);
  return nearest_word(name, names);
}

const MotionInfo* find_motion(std::uint8_t code) noexcept {
  return find<MotionInfo>(kMotions, [&](const MotionInfo& row) { return row.code == static_cast<Motion>(code); });
}

std::span<const BitName> state_bits() noexcept {
  return kStateBits;
}
std::span<const BitName> short_state_bits() noexcept {
  return kShortStateBits;
}
std::span<const BitName> digital_io_bits() noexcept {
  return kDigitalIoBits;
}

std::string words(std::uint32_t bits, std::span<const BitName> names) {
  std::string out;
  for (const BitName& bit : names)
    if ((bits & bit.mask) != 0) out += (out.empty() ? "" : " ") + std::string(bit.name);
  return out.empty() ? "0" : out;
}

const char* fault_of(std::uint32_t state) noexcept {
  // ERROR is the lowest bit and only says that there is a reason above it.
  const char* out = "";
  for (const BitName& bit : kStateBits)
    if ((state & bit.mask) != 0 && *bit.meaning != '\0') out = bit.meaning;
  return out;
}

std::optional<std::uint8_t> baud_code(int kbit_per_s) noexcept {
  for (const auto& row : kBaudRates)
    if (row.kbit_per_s == kbit_per_s) return row.code;
  return std::nullopt;
}

std::optional<int> baud_rate(std::uint8_t code) noexcept {
  for (const auto& row : kBaudRates)
    if (row.code == code) return row.kbit_per_s;
  return std::nullopt;
}

}  // namespace foresight::powercube
