#include "apps/command_line/writable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "common/error.hpp"
#include "common/partial_path.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

std::error_code try_file(const fs::path& file) {
  const RemovedWhenStopped removed(file);  // its name is this process's own
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const std::error_code error = fd < 0 ? std::error_code{errno, std::generic_category()} : std::error_code{};
  if (fd >= 0) {
    ::close(fd);
    ::unlink(file.c_str());
  }
  return error;
}

/// A pipe or a device: opened as it will be, but without waiting.
UniqueFd opened(const std::string& where, const fs::path& file) {
  UniqueFd fd(::open(file.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (fd) return fd;
  if (errno == ENXIO) throw InputError(where, "is a pipe that nobody reads", "start its reader first");
  throw InputError(where, "cannot be written to (" + std::generic_category().message(errno) + ")",
                   "give another place, or change its rights");
}

}  // namespace

MadeFolder::MadeFolder(const fs::path& folder) {
  std::error_code ignored;
  for (fs::path at = folder; at.has_relative_path() && !fs::exists(at, ignored); at = at.parent_path())
    on_signal_.emplace_back(made_.emplace_back(at));
  fs::create_directories(folder, error_);
  if (!error_ && !fs::is_directory(folder, ignored)) error_ = std::make_error_code(std::errc::not_a_directory);
}

MadeFolder::~MadeFolder() {
  for (const fs::path& folder : made_) ::rmdir(folder.c_str());  // only empty ones go
}

UniqueFd require_writable(const std::string& where, const fs::path& path, bool inside, MadeFolders& folders) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return opened(where, path);
  const fs::path whole = without_end_slash(fs::absolute(path).lexically_normal());
  const fs::path folder = inside && fs::is_directory(status) ? whole : whole.parent_path();
  std::error_code error = folders.make(folder);
  if (!error) error = try_file(partial_path(folder / whole.filename()));
  if (error)
    throw InputError(where, folder.string() + " cannot be written to (" + error.message() + ")",
                     "give another place, or change its rights");
  return {};
}

}  // namespace foresight
