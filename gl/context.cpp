#include "gl/context.hpp"

#include <epoxy/gl.h>
#include <sys/resource.h>

#include <cstdlib>

#include "common/error.hpp"

namespace foresight::gl {
namespace {

// Mesa's software renderer filters images of 8 bits in 8 bits unless this says otherwise, which is neither as exact as
// a GPU nor, with wide vectors, any faster (decision 43). Before main: nobody else reads the environment then.
[[maybe_unused]] const int kFilterInFloats = ::setenv("GALLIVM_PERF", "no_aos_sampling", 0);

std::string text(GLenum name) {
  const auto* value = reinterpret_cast<const char*>(glGetString(name));
  return value ? value : "unknown";
}

std::string error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM: return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE: return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION: return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION: return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY: return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST: return "GL_CONTEXT_LOST";
    default: return "error " + std::to_string(error);
  }
}

}  // namespace

void require_address_space() {
  constexpr rlim_t kLeast = rlim_t{1} << 30;
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur >= kLeast) return;
  throw RuntimeFailure("the address space is limited to " + std::to_string(limit.rlim_cur >> 20) +
                           " MiB, and OpenGL needs at least " + std::to_string(kLeast >> 20),
                       "raise the limit (ulimit -v)");
}

DriverInfo query_driver() {
  DriverInfo info{text(GL_VENDOR), text(GL_RENDERER), text(GL_VERSION), false};
  info.is_software =
      info.renderer.find("llvmpipe") != std::string::npos || info.renderer.find("softpipe") != std::string::npos;
  if (epoxy_gl_version() < 45)
    throw RuntimeFailure("OpenGL 4.5 is needed, but " + info.renderer + " offers " + info.version,
                         "install a newer driver, or Mesa's software renderer (libgl1-mesa-dri, libegl-mesa0)");
  return info;
}

void set_up_context() {
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glDisable(GL_DITHER);
}

void check_errors(const char* where) {
  const GLenum reset = glGetGraphicsResetStatus();
  if (reset != GL_NO_ERROR)
    throw RuntimeFailure(std::string("the OpenGL context was lost in ") + where,
                         "start again; if it returns, look for a GPU fault with `dmesg`");
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  if (error == GL_OUT_OF_MEMORY)
    throw RuntimeFailure(std::string("out of GPU memory in ") + where, "give less with --texture-memory-mb");
  throw RuntimeFailure("OpenGL reported " + error_name(error) + " in " + where, "please report this as a bug");
}

}  // namespace foresight::gl
