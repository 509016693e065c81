// Lists on the GPU: one dispatch decides what needs work, the next does just that.
#pragma once

#include <cstddef>

#include "gl/program.hpp"

namespace foresight {

/// C++ side of work_list.glsl and work_item.glsl. The order of items differs from run to run, so
/// what works them off must not depend on it. One context.
class WorkList {
 public:
  /// `words_per_item`: 32 bits each; more than one where the filling program says more of an item, and appends it
  /// itself.
  explicit WorkList(const char* label, std::size_t words_per_item = 1);

  /// Empties the list, makes room for `most` items, and binds it for append_work().
  void start(std::size_t most);
  /// Binds it for append_work() once more, or as another storage block, for a program that fills two lists.
  void bind(unsigned block = 1) const;

  /// After the filling dispatch: binds the list for next_work() (`unit`: WORK_UNIT there) and as indirect arguments.
  /// Runs a program of its own; append_work() fills this list afterwards. `by` works it off: `invocations` an item,
  /// which is INVOCATIONS_PER_ITEM there.
  void finish(const gl::Program& by, unsigned unit = 15, unsigned invocations = 1) const;
  /// Likewise, where each item takes a whole group: there is no INVOCATIONS_PER_ITEM.
  void finish_for_groups(unsigned unit = 15) const;

  /// Uses `program` and dispatches it over the list.
  void dispatch(const gl::Program& program) const;

 private:
  void finish(std::size_t items_per_group, unsigned unit) const;

  std::size_t bytes_per_item_;
  gl::Program args_;
  gl::BufferTexture buffer_;
};

}  // namespace foresight
