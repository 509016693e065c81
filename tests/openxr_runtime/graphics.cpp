#include "tests/openxr_runtime/graphics.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <epoxy/glx.h>
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

namespace foresight::openxr_runtime {

void* current_context(bool egl) {
  if (egl) return eglGetCurrentContext();
  return glXGetCurrentContext();
}

GivenGraphics given_graphics(const void* chain) {
  for (auto* next = static_cast<const XrBaseInStructure*>(chain); next; next = next->next) {
    if (next->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX) {
      const auto& egl = *reinterpret_cast<const XrGraphicsBindingEGLMNDX*>(next);
      const bool whole = egl.getProcAddress && egl.display && egl.config && egl.context;
      return {egl.context, true, whole ? "" : "an EGL binding without display, config, context or functions"};
    }
    if (next->type == XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR) {
      const auto& glx = *reinterpret_cast<const XrGraphicsBindingOpenGLXlibKHR*>(next);
      const bool whole = glx.xDisplay && glx.visualid && glx.glxFBConfig && glx.glxDrawable && glx.glxContext;
      return {glx.glxContext, false, whole ? "" : "a GLX binding without display, visual, config, drawable or context"};
    }
  }
  return {nullptr, false, "no graphics binding"};
}

std::shared_ptr<const void> glx_in_name(const GivenGraphics& graphics) {
  auto out = std::make_shared<XrGraphicsBindingOpenGLXlibKHR>();
  *out = {XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR,   nullptr, static_cast<Display*>(graphics.context),  1,
          static_cast<GLXFBConfig>(graphics.context), 1,       static_cast<GLXContext>(graphics.context)};
  return out;
}

}  // namespace foresight::openxr_runtime
