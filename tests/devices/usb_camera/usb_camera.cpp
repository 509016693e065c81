// A USB camera without the hardware: the kernel's usbcore and uvcvideo on one end of vhci-hcd, this program on the
// other. It shows the images of a folder, as YUYV and as MJPEG. Lines on stdin are faults (uvc_stream.hpp); "unplug",
// or the end of stdin, unplugs it.
//
// Usage: usb_camera PORT SERIAL FOLDER   (a port of vhci_hcd.0, 0 .. 7; "attached" on stdout when it is plugged in)
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "common/clock.hpp"
#include "uvc_stream.hpp"

namespace {

using namespace foresight;
using namespace foresight::usb;

/// False: the controller has dropped the camera.
bool serve(UsbIpPort& port, UvcControl& control, UvcStream& stream) {
  auto request = port.receive();
  if (!request) return false;
  if (request->takes_back) {
    stream.take_back(*request);
  } else if (request->endpoint != 0) {
    stream.queue(std::move(*request));
  } else if (const auto answer = control.serve(*request)) {
    port.answer(*request, *answer);
  } else {
    port.stall(*request);
  }
  if (control.stopped()) stream.stop();
  if (const auto settings = control.started()) stream.start(*settings);
  return true;
}

/// What comes on stdin, as lines.
class Orders {
 public:
  /// False: the camera shall be unplugged.
  bool obey(UvcStream& stream) {
    char bytes[256];
    const ssize_t got = read(STDIN_FILENO, bytes, sizeof bytes);
    if (got <= 0) return got < 0 && errno == EINTR;
    line_.append(bytes, static_cast<std::size_t>(got));
    for (std::size_t end = line_.find('\n'); end != std::string::npos; end = line_.find('\n')) {
      const std::string order = line_.substr(0, end);
      line_.erase(0, end + 1);
      if (order == "unplug") return false;
      if (!stream.disturb(order)) std::fprintf(stderr, "usb_camera: there is no fault '%s'\n", order.c_str());
    }
    return true;
  }

 private:
  std::string line_;
};

int wait_ms(std::optional<RobotTime> due, RobotTime now) {
  if (!due) return -1;
  return static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(std::max(*due - now, Duration{0})).count());
}

int run(int port_number, const char* serial, const char* folder) {
  const Pictures pictures = read_pictures(folder);
  UvcControl control({serial, pictures.width, pictures.height});
  const MonotonicClock clock;
  UsbIpPort port(port_number);
  UvcStream stream(port, pictures);
  Orders orders;
  std::puts("attached");
  std::fflush(stdout);
  while (true) {
    const auto due = stream.serve(clock.now());
    pollfd ends[] = {{port.fd(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    if (poll(ends, 2, wait_ms(due, clock.now())) < 0 && errno != EINTR) return 1;
    if (ends[0].revents != 0 && !serve(port, control, stream)) return 0;
    if (ends[1].revents != 0 && !orders.obey(stream)) return 0;
  }
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fputs("usage: usb_camera PORT SERIAL FOLDER\n", stderr);
    return 2;
  }
  try {
    return run(std::atoi(words[1]), words[2], words[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "usb_camera: %s\n", error.what());
    return 1;
  }
}
