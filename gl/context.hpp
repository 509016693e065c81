// OpenGL contexts: one per thread, all sharing their objects.
#pragma once

#include <memory>
#include <string>

namespace foresight::gl {

/// What the driver calls itself, for reports and messages.
struct DriverInfo {
  std::string vendor, renderer, version;
  bool is_software = false;  ///< llvmpipe or softpipe: "GPU" times are CPU times there
};

/// An OpenGL 4.5 core context. Current on at most one thread at a time; create and destroy all
/// contexts of a share group on the thread that created the first.
class Context {
 public:
  virtual ~Context() = default;

  /// Makes the context current on the calling thread. Throws RuntimeFailure where the driver
  /// refuses.
  virtual void make_current() = 0;

  /// Detaches the context from the calling thread, on which it must be current.
  virtual void release() = 0;

  /// A second context that shares textures, buffers and programs with this one.
  virtual std::unique_ptr<Context> create_shared() = 0;
};

/// A context without a window or display: a device through EGL_EXT_platform_device (a GPU server
/// has no display), else Mesa's surfaceless platform. Current on the calling thread on return.
/// Throws RuntimeFailure that lists what was tried and found where OpenGL 4.5 is missing.
std::unique_ptr<Context> create_headless_context();

/// Throws RuntimeFailure where a limit on this process's memory (ulimit -v) leaves less than any driver needs: some end
/// the process without a word then. Both kinds of contexts ask it.
void require_address_space();

/// Asks the current context; throws RuntimeFailure where it is older than OpenGL 4.5.
DriverInfo query_driver();

/// Fixes the conventions that all passes rely on, once per context: depth from 0 to 1 without
/// remapping, byte-aligned rows, no dithering, and (debug builds) messages from the driver.
void set_up_context();

/// Throws RuntimeFailure if the context was lost or an error is pending; `where` names the caller.
/// Costs a round trip: call it once per frame, not per command.
void check_errors(const char* where);

}  // namespace foresight::gl
