// What happens when the X server goes away under a window.
#pragma once

namespace foresight::gl {

/// From now on a lost X server, and one that refuses what the window needs, as when another client has destroyed it,
/// ends the process at once with a message and exit code 1, from whichever thread notices.
/// Xlib's own way, exit(), destroys globals under the threads that still run, which may crash. Files that are written
/// atomically stay whole. Does nothing on Wayland.
void end_with_x_server();

}  // namespace foresight::gl
