// A folder that appears complete or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/removed_when_stopped.hpp"

namespace foresight {

/// How a folder is known as one that the same command wrote, with nothing else in it.
struct FolderForm {
  std::string marker, marker_line;                                   ///< a file, and its first line
  std::function<bool(const std::filesystem::path& relative)> holds;  ///< whether such a folder has a file of that name
  /// What it holds cannot be made again: it stays where the program was killed or could not finish it.
  bool irreplaceable = false;
};

/// Throws InputError at `where` unless `folder` is missing, empty, or of that form: then nothing is lost where another
/// takes its place.
void require_replaceable(const std::string& where, const std::filesystem::path& folder, const FolderForm& form);

/// Neighbours of `target` with what was irreplaceable, and of which its program could not finish the folder.
std::vector<std::filesystem::path> unfinished_beside(const std::filesystem::path& target);

/// All is written into path(), a neighbour of the target, which commit() gives the target's name. Without commit()
/// nothing stays, unless keep() is called; a stop signal that ends the program at once removes it while it is empty.
/// One thread.
class TargetFolder {
 public:
  /// Throws InputError: what require_replaceable() refuses, or a place that cannot be written.
  TargetFolder(const std::filesystem::path& target, FolderForm form);
  ~TargetFolder();
  TargetFolder(const TargetFolder&) = delete;

  const std::filesystem::path& path() const { return partial_; }
  const std::filesystem::path& target() const { return target_; }

  /// Throws RuntimeFailure unless the disk has `bytes` left.
  void require_space(double bytes) const;
  /// Throws InputError where the target has come to hold something foreign meanwhile: what was written stays at path()
  /// then. Throws std::filesystem::filesystem_error.
  void commit();
  /// What was written stays where it is, which is returned.
  std::filesystem::path keep() { return std::exchange(partial_, {}); }

 private:
  FolderForm form_;
  std::filesystem::path target_, partial_;
  std::optional<RemovedWhenStopped> empty_;
};

}  // namespace foresight
