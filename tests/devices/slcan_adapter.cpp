// A serial CAN adapter without the hardware: the kernel's slcan driver on one end of a pseudo terminal, this program on
// the other. Bytes on stdin go to the driver ('\n' as the '\r' that ends a message), so a script can let frames arrive
// ("t12321122") and the controller change its state ("sb128000": bus-off; LAWICEL protocol as slcan reads it). What the
// driver sends is printed, one message a line.
//
// Usage: slcan_adapter   (first line on stdout: the interface's name)
#include <fcntl.h>
#include <linux/tty.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

int fail(const char* operation) {
  std::fprintf(stderr, "slcan_adapter: %s: %s\n", operation, std::strerror(errno));
  return 1;
}

void make_raw(int terminal) {
  termios settings{};
  tcgetattr(terminal, &settings);
  cfmakeraw(&settings);
  tcsetattr(terminal, TCSANOW, &settings);
}

bool copy(int from, int to, char old_end, char new_end) {
  std::array<char, 256> bytes;
  const ssize_t got = read(from, bytes.data(), bytes.size());
  if (got <= 0) return false;
  std::replace(bytes.begin(), bytes.begin() + got, old_end, new_end);
  return write(to, bytes.data(), static_cast<std::size_t>(got)) == got;
}

}  // namespace

int main() {
  const int adapter = posix_openpt(O_RDWR | O_NOCTTY);
  if (adapter < 0 || grantpt(adapter) != 0 || unlockpt(adapter) != 0) return fail("open a pseudo terminal");
  const int line = open(ptsname(adapter), O_RDWR | O_NOCTTY);
  if (line < 0) return fail("open its other end");
  make_raw(line);
  make_raw(adapter);
  const int discipline = N_SLCAN;
  if (ioctl(line, TIOCSETD, &discipline) != 0) return fail("set the line discipline N_SLCAN (modprobe slcan)");
  char interface[32] = {};
  constexpr unsigned long kGetName = 0x8910;  // SIOCGIFNAME, which line disciplines of networks answer
  if (ioctl(line, kGetName, interface) != 0) return fail("ask for the interface's name");
  std::printf("%s\n", interface);
  std::fflush(stdout);
  while (true) {
    pollfd ends[] = {{adapter, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    if (poll(ends, 2, -1) < 0 && errno != EINTR) return fail("wait");
    if (ends[0].revents != 0 && !copy(adapter, STDOUT_FILENO, '\r', '\n')) return 0;
    if (ends[1].revents != 0 && !copy(STDIN_FILENO, adapter, '\n', '\r')) return 0;
  }
}
