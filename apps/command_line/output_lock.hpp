// One program at a time writes a file or folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/removed_when_stopped.hpp"
#include "common/unique_fd.hpp"

namespace foresight {

/// Holds `target` for this program: a file ".NAME.lock" beside it, with this process's number and the kernel's lock on
/// it, which ends with the process in whatever way; the file goes with the object. One thread.
class OutputLock {
 public:
  /// `target`: canonical. Throws InputError at `where` where another program holds it. A
  /// file system that knows no locks gives none.
  OutputLock(const std::string& where, const std::filesystem::path& target);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  std::string file_;
  UniqueFd fd_;
  std::optional<RemovedWhenStopped> removed_;
};

/// Whether it has the name of such a lock: one may have been left by a program that was killed.
bool is_lock(const std::filesystem::path& path);

}  // namespace foresight
