// What the paths on a command line are for. Commands say so when they add their options; output_guard.hpp checks it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line/file_forms.hpp"

namespace foresight {

/// A place that a command will write to.
struct Output {
  enum class Kind {
    file,
    folder,           ///< keeps what else is in it
    replaced_folder,  ///< is removed with all its content when the new one is complete
    either,           ///< a file or a folder, as another option says
  };
  std::filesystem::path path;
  Kind kind = Kind::file;
  std::optional<FileForm> form = {};  ///< of a file: what may be replaced
  /// Called where something is there. Throws InputError at `where` where it must stay: of a folder, for the first entry
  /// that no such command wrote. May be empty.
  std::function<void(const std::string& where, const std::filesystem::path& path)> refuse_foreign = {};
};

/// All that a command writes where `word` was given: the file or folder itself, and what lies beside it.
using OutputsOf = std::function<std::vector<Output>(const std::filesystem::path& word)>;

/// One that is to be new: whatever is there stays, but for an empty file or folder.
Output new_output(const std::filesystem::path& path, Output::Kind kind);

/// A page and the data of its plots (common/plot_data.hpp).
std::vector<Output> page_outputs(const std::filesystem::path& page);

/// One word of an option that names a file or folder.
struct GivenPath {
  std::string option;  ///< "--out", or the name of a positional one
  std::string word;
  OutputsOf outputs;  ///< empty: it is read
};

}  // namespace foresight
