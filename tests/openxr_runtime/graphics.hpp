// Contexts as the runtime is told of them; X11's macros stay behind it.
#pragma once

#include <memory>

namespace foresight::openxr_runtime {

/// The context that is current in this thread; null: none.
void* current_context(bool egl);

/// Of XrSessionCreateInfo::next: a binding by EGL or GLX with all that it needs.
struct GivenGraphics {
  void* context = nullptr;
  bool egl = false;
  const char* wrong = "";  ///< what is missing
};
GivenGraphics given_graphics(const void* chain);

/// A binding of GLX that is one by its type alone.
std::shared_ptr<const void> glx_in_name(const GivenGraphics& graphics);

}  // namespace foresight::openxr_runtime
