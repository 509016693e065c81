// The control pipe of the emulated camera: USB 2.0, 9.4, and UVC 1.1, 4.2 and 4.3.
#pragma once

#include <optional>

#include "usbip_port.hpp"
#include "uvc_descriptors.hpp"

namespace foresight::usb {

struct StreamSettings {
  int format = kYuyvFormat;
  std::uint32_t interval = kIntervals[0];  ///< of frames, 100 ns
};

/// Answers requests of endpoint 0. Pure.
class UvcControl {
 public:
  explicit UvcControl(CameraModel model) : model_(std::move(model)) {}

  /// What the host reads (empty where it writes). Nothing: there is no such request (stall).
  std::optional<Bytes> serve(const Request& request);
  /// Once after each start of a stream by the host, and after each stop (`stopped`).
  std::optional<StreamSettings> started();
  bool stopped();

 private:
  std::optional<Bytes> standard(const Request& request);
  std::optional<Bytes> streaming(const Request& request);
  std::optional<Bytes> camera_control(const Request& request);
  Bytes negotiated(const StreamSettings& settings) const;

  struct Control {
    int entity, selector;
    std::size_t size;
    std::uint32_t minimum, maximum, step, initial, value;
  };
  CameraModel model_;
  Control controls_[4] = {{kCameraTerminal, 2, 1, 1, 8, 9, 1, 1},  // manual (1) or by aperture (8), a set of bits
                          {kCameraTerminal, 4, 4, 1, 2000, 1, 156, 156},  // exposure, 0.1 ms
                          {kProcessingUnit, 2, 2, 0, 255, 1, 128, 128},   // brightness
                          {kProcessingUnit, 4, 2, 0, 100, 1, 0, 0}};      // gain
  StreamSettings probed_, committed_;
  bool started_ = false, stopped_ = false;
};

}  // namespace foresight::usb
