// All files that a command line reads, and files compared as the system sees them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line/path_roles.hpp"

namespace foresight {

/// Absolute, without links and dots as far as it exists. Never throws for what is not there.
std::filesystem::path canonical_place(const std::filesystem::path& path);
/// The same file or folder, by whatever links; paths that do not exist compare by their names. Both canonical.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);
/// `inner` is `outer` or below it. Both canonical.
bool lies_in(const std::filesystem::path& outer, const std::filesystem::path& inner);

/// What the words that are read stand for: files and what they name (named_files.hpp), all files in a folder, the
/// folder of a pattern. Words that are no paths ("serial:A1") stand for nothing. Immutable.
class Inputs {
 public:
  explicit Inputs(const std::vector<GivenPath>& given);

  /// The name of the input that `file` is, if any. `marked`: `file` carries our mark, so that in a folder it is none.
  std::optional<std::string> find(const std::filesystem::path& file, bool marked) const;
  /// An input folder that `folder` is; where `replaced`, also an input that lies below it.
  std::optional<std::string> find_below(const std::filesystem::path& folder, bool replaced) const;

 private:
  struct Id {
    std::uint64_t device, number;
    auto operator<=>(const Id&) const = default;
  };
  static std::optional<Id> id_of(const std::filesystem::path& file);
  void add_file(const std::filesystem::path& file);
  void add_folder(const std::filesystem::path& folder);

  std::map<Id, std::string> named_, in_folders_;
  std::vector<std::filesystem::path> files_, folders_;  // canonical
};

}  // namespace foresight
