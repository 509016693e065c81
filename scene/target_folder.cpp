#include "scene/target_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>

#include "common/error.hpp"
#include "common/partial_path.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

/// The first file in `folder` that is none of the form's, relative to it; empty where there is none.
fs::path first_foreign(const fs::path& folder, const FolderForm& form) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path relative = entry.path().lexically_relative(folder);
    const fs::file_status status = entry.symlink_status();
    if (!fs::is_directory(status) && !(fs::is_regular_file(status) && form.holds(relative))) return relative;
  }
  return {};
}

constexpr std::string_view kUnfinished = ".unfinished-";

/// A new folder "NAME.unfinished-N".
fs::path make_unfinished(const fs::path& target) {
  for (int number = 1;; ++number) {
    fs::path out = target;
    out += std::string(kUnfinished) + std::to_string(number);
    if (fs::create_directory(out)) return out;
  }
}

fs::path make_partial(const fs::path& target) {
  const fs::path out = partial_path(target);
  fs::create_directory(out);
  return out;
}

/// Absolute, and without the slash that may end a folder's name.
fs::path name_of(const fs::path& target) {
  return without_end_slash(fs::absolute(target).lexically_normal());
}

}  // namespace

std::vector<fs::path> unfinished_beside(const fs::path& target) {
  const fs::path name = name_of(target);
  const std::string prefix = name.filename().string() + std::string(kUnfinished);
  std::vector<fs::path> out;
  std::error_code ignored;
  for (fs::directory_iterator at(name.parent_path(), ignored), end; at != end; at.increment(ignored))
    if (at->path().filename().string().starts_with(prefix)) out.push_back(at->path());
  std::ranges::sort(out);
  return out;
}

void require_replaceable(const std::string& where, const fs::path& folder, const FolderForm& form) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (fs::is_symlink(folder) || !fs::is_directory(folder))
    throw InputError(where, "exists and is not a folder", "choose another place");
  if (fs::is_empty(folder)) return;
  std::string line;
  std::ifstream stream;
  if (fs::is_regular_file(folder / form.marker)) stream.open(folder / form.marker);
  if (!std::getline(stream, line) || line != form.marker_line) {
    const bool recorded = fs::exists(folder / "rgb.txt");
    throw InputError(
        where, recorded ? "holds a run that was not made by this command" : "is not empty and holds no run of ours",
        "choose a new or empty folder");
  }
  if (const fs::path foreign = first_foreign(folder, form); !foreign.empty())
    throw InputError(where, "holds " + foreign.string() + ", which this command did not write",
                     "move it elsewhere, or choose a new or empty folder");
}

TargetFolder::TargetFolder(const fs::path& target, FolderForm form) : form_(std::move(form)), target_(name_of(target)) {
  try {
    require_replaceable(target_.string(), target_, form_);
    fs::create_directories(target_.parent_path());
    const StopSignalsHeld held;
    partial_ = form_.irreplaceable ? make_unfinished(target_) : make_partial(target_);
    empty_.emplace(partial_);
  } catch (const fs::filesystem_error& e) {
    throw InputError(target.string(), "cannot be written (" + e.code().message() + ")", "choose a writable place");
  }
}

TargetFolder::~TargetFolder() {
  std::error_code ignored;
  if (!partial_.empty()) fs::remove_all(partial_, ignored);
}

void TargetFolder::require_space(double bytes) const {
  std::error_code error;
  const fs::space_info space = fs::space(partial_, error);
  if (error || static_cast<double>(space.available) >= bytes) return;
  throw RuntimeFailure(fmt::format("{} needs at least {:.3g} MB, but its disk has only {:.3g} MB left",
                                   target_.string(), bytes / 1e6, static_cast<double>(space.available) / 1e6),
                       "free some disk space, or ask for fewer or smaller images");
}

void TargetFolder::commit() {
  try {
    require_replaceable(target_.string(), target_, form_);
  } catch (const InputError& foreign) {
    throw InputError("what was written is in " + keep().string(), foreign.what(), "then give it its name");
  }
  fs::remove_all(target_);  // ours, or an empty folder
  fs::rename(partial_, target_);
  partial_.clear();
}

}  // namespace foresight
