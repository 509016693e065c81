#include "common/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/partial_path.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  throw RuntimeFailure("cannot write " + path.string() + ": " + std::generic_category().message(error),
                       cure_of_write_error(error));
}

// Writes all bytes and closes `fd`. Returns 0 or errno.
int write_and_close(int fd, std::string_view bytes) {
  int error = 0;
  while (!bytes.empty() && !error) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      error = errno;
  }
  // Network file systems report a full disk only here.
  if (::close(fd) != 0 && !error) error = errno;
  return error;
}

/// A file written under a temporary name, which goes with this unless it was renamed.
class WrittenFile {
 public:
  WrittenFile(fs::path path, std::string_view bytes) : path_(std::move(path)) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path_, ignored);
    if (fs::is_directory(status)) fail(path_, EISDIR);
    if (fs::exists(status) && !fs::is_regular_file(status)) {  // a pipe or a device
      const int fd = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
      const int error = fd < 0 ? errno : write_and_close(fd, bytes);
      if (error) fail(path_, error);
      return;
    }
    target_ = fs::exists(status) ? fs::canonical(path_) : path_;
    fs::path temporary = partial_path(target_);
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) fail(path_, errno);
    temporary_ = std::move(temporary);
    if (const int error = write_and_close(fd, bytes)) {
      ::unlink(temporary_.c_str());
      fail(path_, error);
    }
  }
  WrittenFile(WrittenFile&& other) noexcept
      : path_(std::move(other.path_)),
        target_(std::move(other.target_)),
        temporary_(std::exchange(other.temporary_, fs::path())) {}
  ~WrittenFile() {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
  }

  void rename() {
    if (temporary_.empty()) return;
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
    temporary_.clear();
  }

 private:
  fs::path path_, target_;
  fs::path temporary_;  // empty: nothing to rename or to remove
};

}  // namespace

const char* cure_of_write_error(int error) {
  if (error == ENOSPC || error == EDQUOT) return "free some disk space";
  if (error == EFBIG) return "raise the limit on the size of files (ulimit -f)";
  return "name a file in a folder that exists and can be written";
}

void write_file_atomically(const fs::path& path, std::string_view bytes) {
  WrittenFile(path, bytes).rename();
}

void write_files_atomically(std::span<const FileContent> files) {
  std::vector<WrittenFile> written;
  written.reserve(files.size());
  for (const FileContent& file : files) written.emplace_back(file.path, file.bytes);
  for (WrittenFile& file : written) file.rename();
}

}  // namespace foresight
