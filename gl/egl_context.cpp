#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/core.h>

#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "gl/context.hpp"

namespace foresight::gl {
namespace {

constexpr EGLint kContextAttributes[] = {
    EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};

std::string egl_error() {
  return fmt::format("EGL error 0x{:04x}", eglGetError());
}

/// A display connection shared by all contexts on it; terminated with the last. EGL knows one connection per device in
/// the whole process, and to terminate it ends the contexts of all who opened it: hence the count.
class SharedDisplay {
 public:
  /// Null where EGL refuses; eglGetError() says why.
  static std::shared_ptr<SharedDisplay> open(EGLDisplay display) {
    const std::scoped_lock lock(opened().mutex);
    if (!eglInitialize(display, nullptr, nullptr)) return nullptr;
    ++opened().times[display];
    return std::shared_ptr<SharedDisplay>(new SharedDisplay(display));
  }
  ~SharedDisplay() {
    const std::scoped_lock lock(opened().mutex);
    if (--opened().times[display_] == 0) eglTerminate(display_);
  }
  SharedDisplay(const SharedDisplay&) = delete;
  SharedDisplay& operator=(const SharedDisplay&) = delete;
  EGLDisplay get() const { return display_; }

 private:
  explicit SharedDisplay(EGLDisplay display) : display_(display) {}
  struct Opened {
    std::mutex mutex;
    std::map<EGLDisplay, int> times;
  };
  static Opened& opened() {
    static Opened& all = *new Opened;  // outlives every static context
    return all;
  }
  EGLDisplay display_;
};

EGLContext create_context(EGLDisplay display, EGLContext share, const EGLint* attributes = kContextAttributes) {
  eglBindAPI(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  // Surfaceless contexts need no config where EGL_KHR_no_config_context is there.
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0) config = nullptr;
  return eglCreateContext(display, config, share, attributes);
}

class EglContext final : public Context {
 public:
  EglContext(std::shared_ptr<SharedDisplay> display, EGLContext context)
      : display_(std::move(display)), context_(context) {}
  ~EglContext() override {
    if (eglGetCurrentContext() == context_) release();
    eglDestroyContext(display_->get(), context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() override {
    eglBindAPI(EGL_OPENGL_API);
    if (!eglMakeCurrent(display_->get(), EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw RuntimeFailure("the OpenGL context cannot be made current: " + egl_error(),
                           "check that no other thread uses it");
  }

  void release() override { eglMakeCurrent(display_->get(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

  std::unique_ptr<Context> create_shared() override {
    EGLContext shared = create_context(display_->get(), context_);
    if (shared == EGL_NO_CONTEXT)
      throw RuntimeFailure("no second OpenGL context: " + egl_error(), "update the graphics driver");
    return std::make_unique<EglContext>(display_, shared);
  }

 private:
  std::shared_ptr<SharedDisplay> display_;
  EGLContext context_;
};

/// What the display has instead of OpenGL 4.5, such as "llvmpipe, OpenGL 3.3 (Mesa 22.3.6)".
std::string found_instead(const std::shared_ptr<SharedDisplay>& display) {
  const std::string error = egl_error();
  const EGLint any_version[] = {EGL_NONE};
  const EGLContext context = create_context(display->get(), EGL_NO_CONTEXT, any_version);
  if (context == EGL_NO_CONTEXT) return "no OpenGL, " + error;
  EglContext older(display, context);
  older.make_current();
  const auto text = [](GLenum name) { return std::string(reinterpret_cast<const char*>(glGetString(name))); };
  return "only " + text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

/// Tries one platform; on failure appends the reason to `tried`.
std::unique_ptr<Context> try_display(EGLDisplay handle, const std::string& name, std::string& tried) {
  const auto fail = [&](const std::string& why) {
    tried += (tried.empty() ? "" : ", ") + name + " (" + why + ")";
    return nullptr;
  };
  if (handle == EGL_NO_DISPLAY) return fail("no display");
  const auto display = SharedDisplay::open(handle);
  if (!display) return fail(egl_error());
  const EGLContext context = create_context(handle, EGL_NO_CONTEXT);
  if (context == EGL_NO_CONTEXT) return fail(found_instead(display));
  auto result = std::make_unique<EglContext>(display, context);
  result->make_current();
  return result;
}

/// Hardware first: EGL lists the software device (no DRM node) among the others.
std::vector<EGLDeviceEXT> devices_hardware_first() {
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base") &&
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration"))
    return {};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> all(static_cast<std::size_t>(count)), ordered, software;
  eglQueryDevicesEXT(count, all.data(), &count);
  for (EGLDeviceEXT device : all) {
    const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    const bool is_software =
        extensions && std::string(extensions).find("EGL_MESA_device_software") != std::string::npos;
    (is_software ? software : ordered).push_back(device);
  }
  ordered.insert(ordered.end(), software.begin(), software.end());
  return ordered;
}

}  // namespace

std::unique_ptr<Context> create_headless_context() {
  require_address_space();
  std::string tried;
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
    for (EGLDeviceEXT device : devices_hardware_first()) {
      const auto display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
      if (auto context = try_display(display, "EGL device", tried)) return context;
    }
  }
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    const auto display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (auto context = try_display(display, "Mesa surfaceless", tried)) return context;
  }
  throw RuntimeFailure("no OpenGL 4.5 without a display; tried: " + (tried.empty() ? "no EGL platform found" : tried),
                       "install a graphics driver with EGL, or Mesa's software renderer "
                       "(apt-get install libegl-mesa0 libgl1-mesa-dri)");
}

}  // namespace foresight::gl
