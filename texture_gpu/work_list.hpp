// Lists on the GPU: one dispatch decides what needs work, the next does just that.
#pragma once

#include <optional>

#include "gl/program.hpp"

namespace foresight {

/// C++ side of work_list.glsl and work_item.glsl. The order of items differs from run to run, so
/// what works them off must not depend on it. One context.
class WorkList {
 public:
  /// `items_per_group`: items that one work group of the program takes that works the list off.
  /// `words_per_item`: 32 bits each; more than one where the filling program says more of an item, and appends it
  /// itself.
  explicit WorkList(const char* label, unsigned items_per_group = 1, std::size_t words_per_item = 1);

  /// Empties the list, makes room for `most` items, and binds it for append_work().
  void start(std::size_t most);
  /// Binds it for append_work() once more, or as another storage block, for a program that fills two lists.
  void bind(unsigned block = 1) const;

  /// After the filling dispatch: binds the list for next_work() (`unit`: WORK_UNIT there) and as indirect arguments.
  /// Runs a program of its own; append_work() fills this list afterwards. `items_per_group`: of a program that takes
  /// others than it was made with.
  void finish(unsigned unit = 15, std::optional<unsigned> items_per_group = std::nullopt) const;

  /// Dispatches the current program over the list.
  void dispatch() const;

 private:
  unsigned items_per_group_;
  std::size_t bytes_per_item_;
  gl::Program args_;
  gl::BufferTexture buffer_;
};

}  // namespace foresight
