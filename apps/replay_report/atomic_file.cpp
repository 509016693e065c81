#include "apps/replay_report/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/error.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  const bool full = error == ENOSPC || error == EDQUOT;
  throw RuntimeFailure("cannot write " + path.string() + ": " + std::generic_category().message(error),
                       full ? "free some disk space" : "name a file in a folder that exists and can be written");
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

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view bytes) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) fail(path, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    const int error = fd < 0 ? errno : write_and_close(fd, bytes);
    if (error) fail(path, error);
    return;
  }
  const fs::path target = fs::exists(status) ? fs::canonical(path) : path;
  fs::path temporary = target;
  temporary += ".part" + std::to_string(::getpid());
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) fail(path, errno);
  int error = write_and_close(fd, bytes);
  if (!error && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error) {
    ::unlink(temporary.c_str());
    fail(path, error);
  }
}

}  // namespace foresight
