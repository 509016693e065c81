// A folder that appears complete or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace foresight {

/// How a folder is known as one that the same command wrote, with nothing else in it.
struct FolderForm {
  std::string marker, marker_line;                                   ///< a file, and its first line
  std::function<bool(const std::filesystem::path& relative)> holds;  ///< whether such a folder has a file of that name
};

/// Throws InputError at `where` unless `folder` is missing, empty, or of that form: then nothing is lost where another
/// takes its place.
void require_replaceable(const std::string& where, const std::filesystem::path& folder, const FolderForm& form);

/// All is written into path(), a neighbour of the target, which commit() gives the target's name.
/// Without commit() nothing stays. One thread.
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

 private:
  FolderForm form_;
  std::filesystem::path target_, partial_;
};

}  // namespace foresight
