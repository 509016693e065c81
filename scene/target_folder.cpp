#include "scene/target_folder.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <fstream>

#include "common/error.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

void require_ours(const fs::path& target, const std::string& marker, const std::string& marker_line) {
  if (!fs::exists(fs::symlink_status(target))) return;
  if (fs::is_symlink(target) || !fs::is_directory(target))
    throw InputError(target.string(), "exists and is not a folder", "choose another place");
  if (fs::is_empty(target)) return;
  std::string line;
  std::ifstream stream(target / marker);
  if (std::getline(stream, line) && line == marker_line) return;
  const bool recorded = fs::exists(target / "rgb.txt");
  throw InputError(target.string(),
                   recorded ? "holds a run that was not made by this command" : "is not empty and holds no run of ours",
                   "choose a new or empty folder");
}

}  // namespace

TargetFolder::TargetFolder(const fs::path& target, const std::string& marker, const std::string& marker_line)
    : target_(fs::absolute(target).lexically_normal()) {
  if (!target_.has_filename()) target_ = target_.parent_path();
  try {
    require_ours(target_, marker, marker_line);
    partial_ = target_.string() + ".partial-" + std::to_string(getpid());
    fs::create_directories(target_.parent_path());
    fs::create_directory(partial_);
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
  fs::remove_all(target_);  // ours, or an empty folder
  fs::rename(partial_, target_);
  partial_.clear();
}

}  // namespace foresight
