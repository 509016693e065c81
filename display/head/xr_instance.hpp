// The connection to an OpenXR runtime.
#pragma once

#include <string>

#include "display/head/graphics_binding.hpp"
#include "display/head/xr_calls.hpp"

namespace foresight::head {

/// One OpenXR instance, with OpenGL. One at a time in a process, one thread.
class Instance {
 public:
  /// Of the active runtime. Throws CallFailed: no runtime, none with OpenGL, none that takes a context of that kind.
  explicit Instance(ContextKind kind);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  XrInstance get() const { return instance_; }
  const std::string& runtime() const { return runtime_; }  ///< its name and version

  /// The headset. Throws CallFailed where none is there.
  XrSystemId headset() const;
  /// Throws CallFailed where the runtime needs a newer OpenGL than the current context has. To be asked before a
  /// session is made.
  void check_graphics(XrSystemId system) const;

 private:
  XrInstance instance_ = XR_NULL_HANDLE;
  std::string runtime_;
};

}  // namespace foresight::head
