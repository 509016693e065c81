#include "gl/x_connection.hpp"

#include <X11/Xlib.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace foresight::gl {

void end_with_x_server() {
  XSetIOErrorHandler([](Display*) -> int {
    constexpr std::string_view kText =
        "foresight: the X server is gone, and the window with it; what was saved is kept, start again on a desktop "
        "that "
        "stays\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kText.data(), kText.size());
    std::_Exit(1);
  });
}

}  // namespace foresight::gl
