// Places to write to: checked before any work is done.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "apps/run_options.hpp"
#include "scene/run_folder.hpp"

namespace foresight {

/// Every file that the run was read from, canonical.
std::set<std::filesystem::path> input_files(const RunFolder& run, const RunOptions& options);

/// These throw InputError naming `where` (an option and its value), the reason and the cure. To
/// find out, a missing folder and a file in it are made, and removed again.
void require_writable(const std::string& where, const std::filesystem::path& folder, const std::string& name);
void require_not_an_input(const std::string& where, const std::filesystem::path& file,
                          const std::set<std::filesystem::path>& inputs);

/// Both of the above for a file that `option` names: no folder, writable, none of `inputs`.
void check_output_file(const std::string& option, const std::filesystem::path& file,
                       const std::set<std::filesystem::path>& inputs);

/// Makes `folder` and all above it. Throws RuntimeFailure.
void make_folder(const std::filesystem::path& folder);

}  // namespace foresight
