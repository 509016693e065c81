#include "gl/x_connection.hpp"

#include <X11/Xlib.h>
#include <unistd.h>

#include <cstdio>
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
  XSetErrorHandler([](Display*, XErrorEvent* error) -> int {
    const bool is_gone = error->error_code == BadWindow || error->error_code == BadDrawable;
    char text[300];
    std::snprintf(text, sizeof text,
                  "foresight: %s (X error %d of request %d.%d); what was saved is kept, start again\n",
                  is_gone ? "another program has destroyed the window" : "the X server refuses what the window needs",
                  error->error_code, error->request_code, error->minor_code);
    end(text);
  });
}

}  // namespace foresight::gl
