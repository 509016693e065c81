// What the OpenXR runtime of this machine can do, asked before a window is opened.
#pragma once

#include <string>

namespace foresight::head {

struct RuntimeOffer {
  bool there = false;   ///< a runtime is installed, and answers
  bool opengl = false;  ///< takes OpenGL
  bool egl = false;     ///< takes contexts made by EGL; else GLX only
};

/// Loads the active runtime's library, which stays until an instance of it goes. Does not throw.
RuntimeOffer ask_runtime();

}  // namespace foresight::head
