// A folder for as long as somebody needs it.
#pragma once

#include <filesystem>

namespace foresight {

/// Empty at first; removed, with all that is in it, at the end.
class TemporaryFolder {
 public:
  /// Throws RuntimeFailure: no room.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace foresight
