// A folder that appears complete or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace foresight {

/// All is written into path(), a neighbour of the target, which commit() gives the target's name.
/// Without commit() nothing stays. One thread.
class TargetFolder {
 public:
  /// `target` must not exist, be an empty folder, or hold a `marker` file whose first line is
  /// `marker_line`: then it is ours and commit() replaces it. Throws InputError: anything else, or
  /// a place that cannot be written.
  TargetFolder(const std::filesystem::path& target, const std::string& marker, const std::string& marker_line);
  ~TargetFolder();
  TargetFolder(const TargetFolder&) = delete;

  const std::filesystem::path& path() const { return partial_; }
  const std::filesystem::path& target() const { return target_; }

  /// Throws RuntimeFailure unless the disk has `bytes` left.
  void require_space(double bytes) const;
  /// Throws std::filesystem::filesystem_error.
  void commit();

 private:
  std::filesystem::path target_, partial_;
};

}  // namespace foresight
