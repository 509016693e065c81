// The parameters of a PowerCube module (M5) and how their values are coded.
#pragma once

#include <cstdint>

namespace foresight::sim::powercube {

inline constexpr std::uint8_t kConfigWord = 0x39, kMaxDelta = 0x40, kMinPos = 0x45, kMaxPos = 0x46, kMaxVel = 0x48,
                              kMaxAcc = 0x4A, kMaxCur = 0x4C, kTargetVel = 0x4F, kTargetAcc = 0x50, kHomeOffset = 0x59;
inline constexpr double kTorquePerAmpere = 5;  ///< Nm

enum class Coding : std::uint8_t { none, real, int32, uint32, int16, uint16, uint8 };

constexpr std::size_t size_of(Coding coding) {
  switch (coding) {
    case Coding::none: return 0;
    case Coding::uint8: return 1;
    case Coding::int16:
    case Coding::uint16: return 2;
    default: return 4;
  }
}

/// `none`: there is no such parameter.
constexpr Coding coding(std::uint8_t parameter) {
  switch (parameter) {
    case 0x1A:
    case 0x1B:
    case 0x1C:
    case 0x26:
    case 0x27:
    case 0x28:
    case 0x29:
    case 0x2A:
    case 0x2B:
    case 0x39:
    case 0x58: return Coding::uint32;
    case 0x1D:
    case 0x1E:
    case 0x1F: return Coding::uint16;
    case 0x20:
    case 0x22:
    case 0x23:
    case 0x3A:
    case 0x57: return Coding::uint8;
    case 0x24:
    case 0x25:
    case 0x2C:
    case 0x36: return Coding::int32;
    case 0x35:
    case 0x51:
    case 0x52:
    case 0x53:
    case 0x54:
    case 0x55:
    case 0x56: return Coding::int16;
    case 0x3B:
    case 0x3C:
    case 0x3D:
    case 0x3E:
    case 0x3F:
    case 0x40:
    case 0x41:
    case 0x42:
    case 0x45:
    case 0x46:
    case 0x48:
    case 0x4A:
    case 0x4C:
    case 0x4D:
    case 0x4E:
    case 0x4F:
    case 0x50:
    case 0x59: return Coding::real;
    default: return parameter <= 0x10 ? Coding::real : Coding::none;
  }
}

/// May be written by SetExtended. The defaults (Def...) belong to the maker, but for homing: its velocity and
/// acceleration have no other parameter.
constexpr bool settable(std::uint8_t parameter) {
  switch (parameter) {
    case 0x0F:
    case 0x10:
    case 0x39:
    case 0x40:
    case 0x45:
    case 0x46:
    case 0x48:
    case 0x4A:
    case 0x4C:
    case 0x4F:
    case 0x50:
    case 0x54:
    case 0x55:
    case 0x56:
    case 0x59: return true;
    default: return false;
  }
}

/// Speeds, accelerations and the like, which must be positive.
constexpr bool positive(std::uint8_t parameter) {
  return parameter == 0x0F || parameter == 0x10 || parameter == 0x40 || parameter == 0x48 || parameter == 0x4A ||
         parameter == 0x4C || parameter == 0x4F || parameter == 0x50;
}

constexpr std::uint32_t kError = 1, kHomeOk = 2, kHalted = 4, kPowerFault = 8, kTowError = 0x10, kCommError = 0x20,
                        kHomeSwitch = 0x40, kSwitch1 = 0x80, kSwitch2 = 0x100, kBrakeActive = 0x200,
                        kCurrentLimit = 0x400, kMotion = 0x800, kRampAcc = 0x1000, kRampSteady = 0x2000,
                        kRampDec = 0x4000, kRampEnd = 0x8000, kInProgress = 0x10000, kShortCircuit = 0x200000,
                        kBeyondHard = 0x2000000, kBeyondSoft = 0x4000000;
constexpr std::uint32_t kWatchdogEnable = 0x01000000, kDisableAck = 0x04000000, kSyncMotion = 0x08000000;

}  // namespace foresight::sim::powercube
