#include "gl/x_connection.hpp"

#include <X11/Xlib.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace foresight::gl {
namespace {

[[noreturn]] void end(std::string_view text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
  std::_Exit(1);
}

}  // namespace

void end_with_x_server() {
  XSetIOErrorHandler([](Display*) -> int {
    end("foresight: the X server is gone, and the window with it; what was saved is kept, start again on a desktop "
        "that stays\n");
  });
  XSetErrorHandler([](Display*, XErrorEvent*) -> int {
    end("foresight: another program has destroyed the window, or the X server refuses to show it; what was saved is "
        "kept, start again\n");
  });
}

}  // namespace foresight::gl
