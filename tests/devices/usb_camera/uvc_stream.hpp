// The picture stream of the emulated camera: UVC 1.1, 2.4.3, bulk, one payload a frame.
#pragma once

#include <deque>
#include <optional>
#include <string_view>

#include "common/time.hpp"
#include "pictures.hpp"
#include "usbip_port.hpp"
#include "uvc_control.hpp"

namespace foresight::usb {

/// A frame is due at every whole multiple of its interval on the monotonic clock, and shows the picture of that
/// multiple: cameras of one rate see the same instant at the same time, as cameras with a common trigger do.
/// One thread.
class UvcStream {
 public:
  /// Both outlive this.
  UvcStream(UsbIpPort& port, const Pictures& pictures) : port_(port), pictures_(pictures) {}

  void start(const StreamSettings& settings);
  void stop();
  void queue(Request transfer);  ///< the host waits for data
  void take_back(const Request& request);
  /// Sends what is due; when to call again, where only time makes a frame due.
  std::optional<RobotTime> serve(RobotTime now);

  /// What goes wrong, by name. False: there is no such thing.
  ///   "error"    the next frame says that it is damaged
  ///   "short"    half of the next frame
  ///   "hang"     nothing comes until the host starts the stream again
  ///   "freeze"   nothing comes until "resume"
  bool disturb(std::string_view what);

 private:
  void begin_frame(RobotTime now);
  void send();

  UsbIpPort& port_;
  const Pictures& pictures_;
  StreamSettings settings_;
  std::deque<Request> waiting_;
  Bytes payload_;  // empty: none is under way
  std::size_t sent_ = 0;
  RobotTime due_;
  bool streams_ = false, frame_id_ = false;
  bool error_ = false, short_ = false, hangs_ = false, frozen_ = false;
};

}  // namespace foresight::usb
