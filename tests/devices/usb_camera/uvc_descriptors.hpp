// What the emulated camera says about itself: USB 2.0, chapter 9, and USB Video Class 1.1 (UVC), chapter 3.
#pragma once

#include <string>

#include "little_endian.hpp"

namespace foresight::usb {

struct CameraModel {
  std::string serial = "0001";  ///< ASCII
  int width = 640, height = 480;
};

inline constexpr std::uint32_t kClockHz = 48'000'000;    ///< of time stamps in payloads
inline constexpr std::size_t kPayloadHeader = 12;        ///< bytes
inline constexpr int kYuyvFormat = 1, kMjpegFormat = 2;  ///< bFormatIndex; each has one frame size, of index 1
/// Frame intervals in 100 ns, ascending: 30, 15, 10 and 5 per second.
inline constexpr std::uint32_t kIntervals[] = {333'333, 666'666, 1'000'000, 2'000'000};

inline constexpr int kVideoControl = 0, kVideoStreaming = 1;  ///< interfaces
inline constexpr int kCameraTerminal = 1, kProcessingUnit = 2;
inline constexpr int kStreamEndpoint = 1;  ///< bulk, to the host

std::uint32_t frame_bytes(const CameraModel& model);  ///< of the largest format

Bytes device_descriptor();
Bytes configuration_descriptor(const CameraModel& model);  ///< with everything behind it
/// Empty: there is none of that number.
Bytes string_descriptor(const CameraModel& model, int number);

}  // namespace foresight::usb
