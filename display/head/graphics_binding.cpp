#include "display/head/graphics_binding.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <epoxy/glx.h>
// X11's macros stay in this file.
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include "common/error.hpp"

namespace foresight::head {
namespace {

__eglMustCastToProperFunctionPointerType egl_function(const char* name) {
  return eglGetProcAddress(name);
}

GraphicsBinding egl_binding(EGLContext context) {
  const EGLDisplay display = eglGetCurrentDisplay();
  EGLint id = 0, count = 0;
  EGLConfig config = nullptr;
  // A context without a config has the id 0; some runtimes want one all the same: the first that can do OpenGL.
  eglQueryContext(display, context, EGL_CONFIG_ID, &id);
  const EGLint by_id[] = {EGL_CONFIG_ID, id, EGL_NONE};
  const EGLint any[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_NONE};
  if (!eglChooseConfig(display, id != 0 ? by_id : any, &config, 1, &count) || count == 0) config = nullptr;
  auto binding = std::make_shared<XrGraphicsBindingEGLMNDX>();
  *binding = {XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, nullptr, egl_function, display, config, context};
  return {ContextKind::egl, binding};
}

GraphicsBinding glx_binding(GLXContext context) {
  Display* const display = glXGetCurrentDisplay();
  int id = 0, screen = 0, count = 0;
  glXQueryContext(display, context, GLX_FBCONFIG_ID, &id);
  glXQueryContext(display, context, GLX_SCREEN, &screen);
  const int wanted[] = {GLX_FBCONFIG_ID, id, None};
  GLXFBConfig* const configs = glXChooseFBConfig(display, screen, wanted, &count);
  auto binding = std::make_shared<XrGraphicsBindingOpenGLXlibKHR>();
  *binding = {XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR, nullptr, display, 0, nullptr, glXGetCurrentDrawable(), context};
  if (configs && count > 0) {
    int visual = 0;
    glXGetFBConfigAttrib(display, configs[0], GLX_VISUAL_ID, &visual);
    binding->visualid = static_cast<std::uint32_t>(visual);
    binding->glxFBConfig = configs[0];
  }
  if (configs) XFree(configs);
  return {ContextKind::glx, binding};
}

}  // namespace

GraphicsBinding current_graphics_binding() {
  if (const EGLContext context = eglGetCurrentContext(); context != EGL_NO_CONTEXT) return egl_binding(context);
  // Asked only where EGL has none: without an X server, GLX is not asked at all.
  if (const GLXContext context = glXGetCurrentContext()) return glx_binding(context);
  throw RuntimeFailure("a head display needs an OpenGL context", "please report this as a bug");
}

}  // namespace foresight::head
