// Nothing of the user's is lost: the one check of all outputs, before a command does anything.
//
// An output is refused where
//   - its name is empty or "-", or it cannot be written,
//   - it is an input, or a file that an input names, under whatever name: other spellings, symbolic and hard links,
//   - it is another output, or lies in a folder that is replaced as a whole,
//   - something is there that no such command wrote (file_forms.hpp), or that is write-protected,
//   - another program is writing it.
// Pipes and character devices can be outputs; a pipe needs its reader first.
#pragma once

#include <deque>
#include <vector>

#include "apps/command_line/output_lock.hpp"
#include "apps/command_line/path_roles.hpp"
#include "apps/command_line/writable.hpp"

namespace foresight {

/// Keeps all outputs of a command line for this program while it lives. One thread.
class OutputGuard {
 public:
  /// Checks all that is said above, makes folders that are missing (they go with this, where nothing came into them),
  /// locks the outputs, and sweeps what dead programs left of them (common/partial_path.hpp). Throws InputError naming
  /// the option, the path and the cure.
  explicit OutputGuard(const std::vector<GivenPath>& given);

 private:
  MadeFolders folders_;  // go after the locks in them
  std::deque<OutputLock> locks_;
  std::vector<UniqueFd> open_;  // pipes
};

}  // namespace foresight
