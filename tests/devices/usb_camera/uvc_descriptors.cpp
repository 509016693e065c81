#include "uvc_descriptors.hpp"

#include <initializer_list>
#include <iterator>

namespace foresight::usb {
namespace {

constexpr std::uint8_t kInterface = 4, kEndpoint = 5, kAssociation = 11;
constexpr std::uint8_t kClassInterface = 0x24;  // CS_INTERFACE
constexpr std::uint8_t kVideoClass = 14, kControlSubclass = 1, kStreamingSubclass = 2, kCollection = 3;

/// The first byte of a descriptor is its length.
void add(Bytes& to, std::initializer_list<std::uint8_t> rest) {
  to.push_back(static_cast<std::uint8_t>(rest.size() + 1));
  to.insert(to.end(), rest);
}

void add_control_interface(Bytes& out) {
  add(out, {kInterface, kVideoControl, 0, 0, kVideoClass, kControlSubclass, 0, 2});
  const std::size_t begin = out.size();
  // VC_HEADER: UVC 1.1, total length and clock below, one streaming interface.
  add(out, {kClassInterface, 1, 0x10, 1, 0, 0, 0, 0, 0, 0, 1, kVideoStreaming});
  put(out, begin + 7, kClockHz, 4);
  // VC_INPUT_TERMINAL: a camera (0201h), no zoom lens; its controls: mode and time of exposure.
  add(out, {kClassInterface, 2, kCameraTerminal, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0x0a, 0, 0});
  // VC_PROCESSING_UNIT: brightness and gain.
  add(out, {kClassInterface, 5, kProcessingUnit, kCameraTerminal, 0, 0, 2, 0x01, 0x02, 0, 0});
  // VC_OUTPUT_TERMINAL: the USB stream (0101h).
  add(out, {kClassInterface, 3, 3, 1, 1, 0, kProcessingUnit, 0});
  put(out, begin + 5, static_cast<std::uint32_t>(out.size() - begin), 2);
}

/// VS_FRAME_UNCOMPRESSED or VS_FRAME_MJPEG, and the colours: BT.709 primaries, its transfer curve, BT.601 matrix.
void add_frame(Bytes& out, const CameraModel& model, std::uint8_t subtype) {
  const std::size_t begin = out.size();
  const auto pixels = static_cast<std::uint32_t>(model.width) * static_cast<std::uint32_t>(model.height);
  add(out, {kClassInterface, subtype, 1, 0});
  append(out, static_cast<std::uint32_t>(model.width), 2);
  append(out, static_cast<std::uint32_t>(model.height), 2);
  append(out, pixels * 16 * 5, 4);   // bits per second, at least
  append(out, pixels * 16 * 30, 4);  // and at most
  append(out, frame_bytes(model), 4);
  append(out, kIntervals[0], 4);
  append(out, std::size(kIntervals), 1);
  for (const std::uint32_t interval : kIntervals) append(out, interval, 4);
  out[begin] = static_cast<std::uint8_t>(out.size() - begin);
  add(out, {kClassInterface, 13, 1, 1, 4});
}

void add_streaming_interface(Bytes& out, const CameraModel& model) {
  add(out, {kInterface, kVideoStreaming, 0, 1, kVideoClass, kStreamingSubclass, 0, 0});
  const std::size_t begin = out.size();
  // VS_INPUT_HEADER: two formats, of this endpoint, which leads to terminal 3.
  add(out, {kClassInterface, 1, 2, 0, 0, 0x80 | kStreamEndpoint, 0, 3, 0, 0, 0, 1, 0, 0});
  // VS_FORMAT_UNCOMPRESSED: YUY2 as a GUID, 16 bits a pixel.
  add(out, {kClassInterface,
            4,
            kYuyvFormat,
            1,
            'Y',
            'U',
            'Y',
            '2',
            0,
            0,
            0x10,
            0,
            0x80,
            0,
            0,
            0xaa,
            0,
            0x38,
            0x9b,
            0x71,
            16,
            1,
            0,
            0,
            0,
            0});
  add_frame(out, model, 5);
  // VS_FORMAT_MJPEG.
  add(out, {kClassInterface, 6, kMjpegFormat, 1, 0, 1, 0, 0, 0, 0});
  add_frame(out, model, 7);
  put(out, begin + 4, static_cast<std::uint32_t>(out.size() - begin), 2);
  add(out, {kEndpoint, 0x80 | kStreamEndpoint, 2, 0, 2, 0});  // bulk, packets of 512 bytes
}

}  // namespace

std::uint32_t frame_bytes(const CameraModel& model) {
  return static_cast<std::uint32_t>(model.width) * static_cast<std::uint32_t>(model.height) * 2;
}

Bytes device_descriptor() {
  // USB 2.0; a device of several functions (EFh 2 1); 1D6Bh is what Linux' own gadgets use.
  return {18, 1, 0, 2, 0xef, 2, 1, 64, 0x6b, 0x1d, 2, 1, 0, 1, 1, 2, 3, 1};
}

Bytes configuration_descriptor(const CameraModel& model) {
  Bytes out;
  add(out, {2, 0, 0, 2, 1, 0, 0x80, 50});
  add(out, {kAssociation, kVideoControl, 2, kVideoClass, kCollection, 0, 2});
  add_control_interface(out);
  add_streaming_interface(out, model);
  put(out, 2, static_cast<std::uint32_t>(out.size()), 2);
  return out;
}

Bytes string_descriptor(const CameraModel& model, int number) {
  if (number == 0) return {4, 3, 0x09, 0x04};  // English
  const std::string texts[] = {"Foresight", "Emulated camera", model.serial};
  if (number < 1 || number > 3) return {};
  Bytes out{0, 3};
  for (const char c : texts[number - 1]) append(out, static_cast<std::uint8_t>(c), 2);
  out[0] = static_cast<std::uint8_t>(out.size());
  return out;
}

}  // namespace foresight::usb
