// The OpenGL context of the calling thread, as an OpenXR runtime wants to be told of it.
#pragma once

#include <memory>

namespace foresight::head {

/// Where a context comes from: EGL (needs a runtime with XR_MNDX_egl_enable), or GLX.
enum class ContextKind { egl, glx };

struct GraphicsBinding {
  ContextKind kind = ContextKind::egl;
  std::shared_ptr<const void> chain;  ///< XrSessionCreateInfo::next
};

/// Of the context that is current. Throws RuntimeFailure where there is none.
GraphicsBinding current_graphics_binding();

}  // namespace foresight::head
