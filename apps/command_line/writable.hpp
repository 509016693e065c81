// Whether something can be written, found out by trying.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "common/removed_when_stopped.hpp"
#include "common/unique_fd.hpp"

namespace foresight {

/// A folder, and those above it, made where they are missing; those that were made and stay empty go with this, or with
/// a stop signal that ends the program. One thread.
class MadeFolder {
 public:
  explicit MadeFolder(const std::filesystem::path& folder);
  ~MadeFolder();
  MadeFolder(const MadeFolder&) = delete;
  MadeFolder& operator=(const MadeFolder&) = delete;

  std::error_code error() const { return error_; }  ///< why it could not be made

 private:
  std::vector<std::filesystem::path> made_;  // the innermost first
  std::deque<RemovedWhenStopped> on_signal_;
  std::error_code error_;
};

/// Those of a command line; the last one made goes first, as it may lie in another.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders() {
    while (!made_.empty()) made_.pop_back();
  }
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Why it could not be made.
  std::error_code make(const std::filesystem::path& folder) { return made_.emplace_back(folder).error(); }

 private:
  std::deque<MadeFolder> made_;
};

/// `path`, a file or folder, may be missing. Makes the folder that it is to lie in, which `folders` gets, and in that
/// (`inside`: in `path` itself, where it is a folder) a file, which goes at once. A pipe must have a reader, and stays
/// open with what this returns: its reader would take an end for the end. Throws InputError at `where`.
UniqueFd require_writable(const std::string& where, const std::filesystem::path& path, bool inside,
                          MadeFolders& folders);

}  // namespace foresight
