#include "uvc_control.hpp"

#include <algorithm>
#include <utility>

namespace foresight::usb {
namespace {

constexpr int kSetCurrent = 0x01, kGetCurrent = 0x81, kGetMinimum = 0x82, kGetMaximum = 0x83, kGetStep = 0x84,
              kGetLength = 0x85, kGetInfo = 0x86, kGetDefault = 0x87;
constexpr std::uint8_t kGetAndSet = 3;        // an answer to kGetInfo
constexpr int kProbe = 1, kCommit = 2;        // selectors of the streaming interface
constexpr std::size_t kNegotiationSize = 34;  // UVC 1.1, table 4-47
constexpr int kGetDescriptor = 6, kGetStatus = 0, kGetInterface = 10, kClearFeature = 1;

Bytes number(std::uint32_t value, std::size_t size) {
  Bytes out;
  append(out, value, size);
  return out;
}

int request_of(const Request& r) {
  return r.setup[1];
}
int selector_of(const Request& r) {
  return r.setup[3];
}

}  // namespace

std::optional<Bytes> UvcControl::serve(const Request& request) {
  const bool of_class = (request.setup[0] & 0x60) == 0x20;
  const int interface = request.setup[4], entity = request.setup[5];
  std::optional<Bytes> out;
  if (!of_class)
    out = standard(request);
  else if (interface == kVideoStreaming)
    out = streaming(request);
  else if (interface == kVideoControl && entity != 0)
    out = camera_control(request);
  if (out) out->resize(std::min<std::size_t>(out->size(), get(request.setup, 6, 2)));
  return out;
}

std::optional<Bytes> UvcControl::standard(const Request& request) {
  if (!request.in) {
    // Only of this kind: the host's driver stops a bulk stream by clearing the endpoint's halt.
    if (request_of(request) == kClearFeature && request.setup[4] == (0x80 | kStreamEndpoint)) stopped_ = true;
    return Bytes{};  // address, configuration, interface: as the host says
  }
  if (request_of(request) == kGetStatus) return Bytes{0, 0};
  if (request_of(request) == kGetInterface) return Bytes{0};
  if (request_of(request) != kGetDescriptor) return std::nullopt;
  switch (request.setup[3]) {
    case 1: return device_descriptor();
    case 2: return configuration_descriptor(model_);
    case 3: {
      Bytes text = string_descriptor(model_, request.setup[2]);
      if (text.empty()) return std::nullopt;
      return text;
    }
    default: return std::nullopt;
  }
}

Bytes UvcControl::negotiated(const StreamSettings& settings) const {
  Bytes out(kNegotiationSize);
  put(out, 0, 1, 2);  // the interval is kept
  put(out, 2, static_cast<std::uint32_t>(settings.format), 1);
  put(out, 3, 1, 1);  // the frame
  put(out, 4, settings.interval, 4);
  put(out, 18, frame_bytes(model_), 4);
  put(out, 22, frame_bytes(model_) + kPayloadHeader, 4);  // a frame is one payload
  put(out, 26, kClockHz, 4);
  out[30] = 3;  // payloads tell frames apart and mark their ends
  out[31] = out[32] = out[33] = 1;
  return out;
}

std::optional<Bytes> UvcControl::streaming(const Request& request) {
  const int selector = selector_of(request);
  if (selector != kProbe && selector != kCommit) return std::nullopt;
  StreamSettings& settings = selector == kProbe ? probed_ : committed_;
  switch (request_of(request)) {
    case kSetCurrent: {
      settings.format = get(request.data, 2, 1) == kMjpegFormat ? kMjpegFormat : kYuyvFormat;
      const std::uint32_t wanted = get(request.data, 4, 4);
      const auto* const found = std::find(std::begin(kIntervals), std::end(kIntervals), wanted);
      settings.interval = found == std::end(kIntervals) ? kIntervals[0] : wanted;
      if (selector == kCommit) started_ = true;
      return Bytes{};
    }
    case kGetCurrent: return negotiated(settings);
    case kGetMinimum: return negotiated({settings.format, *std::begin(kIntervals)});
    case kGetMaximum: return negotiated({settings.format, *std::prev(std::end(kIntervals))});
    case kGetDefault: return negotiated({});
    case kGetLength: return number(kNegotiationSize, 2);
    case kGetInfo: return Bytes{kGetAndSet};
    default: return std::nullopt;
  }
}

std::optional<Bytes> UvcControl::camera_control(const Request& request) {
  const auto found = std::find_if(std::begin(controls_), std::end(controls_), [&](const Control& c) {
    return c.entity == request.setup[5] && c.selector == selector_of(request);
  });
  if (found == std::end(controls_)) return std::nullopt;
  switch (request_of(request)) {
    case kSetCurrent: found->value = get(request.data, 0, found->size); return Bytes{};
    case kGetCurrent: return number(found->value, found->size);
    case kGetMinimum: return number(found->minimum, found->size);
    case kGetMaximum: return number(found->maximum, found->size);
    case kGetStep: return number(found->step, found->size);
    case kGetDefault: return number(found->initial, found->size);
    case kGetLength: return number(static_cast<std::uint32_t>(found->size), 2);
    case kGetInfo: return Bytes{kGetAndSet};
    default: return std::nullopt;
  }
}

std::optional<StreamSettings> UvcControl::started() {
  if (!std::exchange(started_, false)) return std::nullopt;
  return committed_;
}

bool UvcControl::stopped() {
  return std::exchange(stopped_, false);
}

}  // namespace foresight::usb
