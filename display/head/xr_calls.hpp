// OpenXR as this module uses it: its header with OpenGL, and what a refused call means.
#pragma once

#include <epoxy/gl.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/error.hpp"

#define XR_USE_GRAPHICS_API_OPENGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

namespace foresight::head {

/// A call that the runtime refused. Thrown within this module; HeadDisplay::step() makes words of it.
class CallFailed : public RuntimeFailure {
 public:
  CallFailed(XrResult why, const std::string& call);
  XrResult result;
  std::string words;  ///< without the cure
};

/// Throws CallFailed where `result` is an error. `call`: "xrCreateSession".
void check(XrResult result, const char* call);

/// "the session was lost", or its name.
std::string words_for(XrResult result);
/// What an operator can do.
std::string cure_for(XrResult result);

/// A list that a runtime hands out in two calls, `most` entries at most: whatever it says, no more is allocated.
/// `call(room, count, entries)` is that function.
template <typename T, typename Call>
std::vector<T> listed(const char* name, const T& empty, Call call, std::uint32_t most = 1024) {
  std::uint32_t count = 0;
  check(call(0, &count, nullptr), name);
  std::vector<T> out(std::min(count, most), empty);
  if (out.empty()) return out;
  check(call(static_cast<std::uint32_t>(out.size()), &count, out.data()), name);
  out.resize(std::min<std::size_t>(count, out.size()));
  return out;
}

}  // namespace foresight::head
