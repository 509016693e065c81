// Lists on the GPU: one dispatch decides what needs work, the next does just that.
#pragma once

#include "gl/objects.hpp"

namespace foresight {

/// C++ side of work_list.glsl and work_item.glsl. The order of items differs from run to run, so
/// what works them off must not depend on it. One context.
class WorkList {
 public:
  /// `x0`, `x1`: work groups per item in the two ways to dispatch.
  WorkList(unsigned x0, unsigned x1, const char* label);

  /// Empties the list, makes room for `most` items, and binds it for append_work().
  void start(std::size_t most);

  /// After the filling dispatch: binds the list for next_work() and as indirect arguments.
  void finish() const;

  /// Dispatches the current program over the list, `way` 0 or 1.
  void dispatch(int way) const;

 private:
  unsigned x0_, x1_;
  gl::BufferTexture buffer_;
};

}  // namespace foresight
