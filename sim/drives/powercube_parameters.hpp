// The parameters of a PowerCube module (M5) and how their values are coded.
#pragma once

#include <cstdint>

namespace foresight::sim::powercube {

/// By the names that drivers/powercube/tables.cpp has them by, too; those that begin with Def are the maker's.
inline constexpr std::uint8_t kDefHomeOffset = 0x00, kDefGearRatio = 0x01, kDefLinRatio = 0x02, kDefMinPos = 0x03,
                              kDefMaxPos = 0x04, kDefMaxDeltaPos = 0x05, kDefTorqueRatio = 0x07, kDefCurRatio = 0x08,
                              kDefMaxVel = 0x0A, kDefMaxAcc = 0x0C, kDefMaxCur = 0x0E, kDefHomeVel = 0x0F,
                              kDefHomeAcc = 0x10, kDefCubeSerial = 0x1A, kDefConfig = 0x1B, kDefPulsesPerTurn = 0x1C,
                              kDefCubeVersion = 0x1D, kDefServiceInterval = 0x1E, kDefBrakeTimeOut = 0x1F,
                              kDefAddress = 0x20, kDefPrimBaud = 0x22, kDefScndBaud = 0x23, kPosCount = 0x24,
                              kRefPosCount = 0x25, kDioSetup = 0x26, kCubeState = 0x27, kTargetPosInc = 0x28,
                              kTargetVelInc = 0x29, kTargetAccInc = 0x2A, kStepInc = 0x2B, kHomeOffsetInc = 0x2C,
                              kRawCur = 0x35, kHomeToZeroInc = 0x36, kConfigWord = 0x39, kMoveMode = 0x3A,
                              kIncRatio = 0x3B, kActPos = 0x3C, kActPosPrev = 0x3D, kIPolPos = 0x3E, kDeltaPos = 0x3F,
                              kMaxDelta = 0x40, kActVel = 0x41, kIPolVel = 0x42, kMinPos = 0x45, kMaxPos = 0x46,
                              kMaxVel = 0x48, kMaxAcc = 0x4A, kMaxCur = 0x4C, kCur = 0x4D, kTargetPos = 0x4E,
                              kTargetVel = 0x4F, kTargetAcc = 0x50, kDefC0 = 0x51, kDefDamp = 0x52, kDefA0 = 0x53,
                              kActC0 = 0x54, kActDamp = 0x55, kActA0 = 0x56, kDefBurnCount = 0x57, kHomeOffset = 0x59;
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
    case kDefCubeSerial:
    case kDefConfig:
    case kDefPulsesPerTurn:
    case kDioSetup:
    case kCubeState:
    case kTargetPosInc:
    case kTargetVelInc:
    case kTargetAccInc:
    case kStepInc:
    case kConfigWord:
    case 0x58: return Coding::uint32;
    case kDefCubeVersion:
    case kDefServiceInterval:
    case kDefBrakeTimeOut: return Coding::uint16;
    case kDefAddress:
    case kDefPrimBaud:
    case kDefScndBaud:
    case kMoveMode:
    case kDefBurnCount: return Coding::uint8;
    case kPosCount:
    case kRefPosCount:
    case kHomeOffsetInc:
    case kHomeToZeroInc: return Coding::int32;
    case kRawCur:
    case kDefC0:
    case kDefDamp:
    case kDefA0:
    case kActC0:
    case kActDamp:
    case kActA0: return Coding::int16;
    case kIncRatio:
    case kActPos:
    case kActPosPrev:
    case kIPolPos:
    case kDeltaPos:
    case kMaxDelta:
    case kActVel:
    case kIPolVel:
    case kMinPos:
    case kMaxPos:
    case kMaxVel:
    case kMaxAcc:
    case kMaxCur:
    case kCur:
    case kTargetPos:
    case kTargetVel:
    case kTargetAcc:
    case kHomeOffset: return Coding::real;
    default: return parameter <= kDefHomeAcc ? Coding::real : Coding::none;
  }
}

/// May be written by SetExtended. The defaults (Def...) belong to the maker, but for homing: its velocity and
/// acceleration have no other parameter.
constexpr bool settable(std::uint8_t parameter) {
  switch (parameter) {
    case kDefHomeVel:
    case kDefHomeAcc:
    case kConfigWord:
    case kMaxDelta:
    case kMinPos:
    case kMaxPos:
    case kMaxVel:
    case kMaxAcc:
    case kMaxCur:
    case kTargetVel:
    case kTargetAcc:
    case kActC0:
    case kActDamp:
    case kActA0:
    case kHomeOffset: return true;
    default: return false;
  }
}

/// Speeds, accelerations and the like, which must be positive.
constexpr bool positive(std::uint8_t parameter) {
  return parameter == kDefHomeVel || parameter == kDefHomeAcc || parameter == kMaxDelta || parameter == kMaxVel ||
         parameter == kMaxAcc || parameter == kMaxCur || parameter == kTargetVel || parameter == kTargetAcc;
}

constexpr std::uint32_t kError = 1, kHomeOk = 2, kHalted = 4, kPowerFault = 8, kTowError = 0x10, kCommError = 0x20,
                        kHomeSwitch = 0x40, kSwitch1 = 0x80, kSwitch2 = 0x100, kBrakeActive = 0x200,
                        kCurrentLimit = 0x400, kMotion = 0x800, kRampAcc = 0x1000, kRampSteady = 0x2000,
                        kRampDec = 0x4000, kRampEnd = 0x8000, kInProgress = 0x10000, kShortCircuit = 0x200000,
                        kBeyondHard = 0x2000000, kBeyondSoft = 0x4000000;
constexpr std::uint32_t kWatchdogEnable = 0x01000000, kDisableAck = 0x04000000, kSyncMotion = 0x08000000;

}  // namespace foresight::sim::powercube
