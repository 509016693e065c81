#include "apps/command_line/output_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <functional>

#include "common/error.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 200;  // of a file, which may have 255 with what is put around it

fs::path lock_file_of(const fs::path& target) {
  std::string name = target.filename().string();
  if (name.size() > kLongestName) name = std::to_string(std::hash<std::string>{}(name));
  return target.parent_path() / ("." + name + ".lock");
}

bool is_still(const std::string& file, int fd) {
  struct stat open {
  }, there{};
  return ::fstat(fd, &open) == 0 && ::stat(file.c_str(), &there) == 0 && open.st_ino == there.st_ino &&
         open.st_dev == there.st_dev;
}

std::string holder(int fd) {
  std::array<char, 32> text{};
  const ssize_t size = ::pread(fd, text.data(), text.size(), 0);
  const std::string pid(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return pid.empty() ? "" : " (process " + pid.substr(0, pid.find('\n')) + ")";
}

}  // namespace

bool is_lock(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') && name.ends_with(".lock");
}

OutputLock::OutputLock(const std::string& where, const fs::path& target) : file_(lock_file_of(target).string()) {
  const StopSignalsHeld held;  // until who stops us knows of the file that we make
  for (;;) {
    fd_ = UniqueFd(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (!fd_) break;
    if (::flock(fd_.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) continue;
      if (errno == EWOULDBLOCK)
        throw InputError(where, "another program is writing it" + holder(fd_.get()),
                         "wait until that has ended, or give another place");
      break;
    }
    if (is_still(file_, fd_.get())) break;  // else its last holder removed it while we waited for nothing
  }
  if (!fd_) return;
  const std::string pid = std::to_string(::getpid()) + "\n";
  [[maybe_unused]] const bool told =
      ::ftruncate(fd_.get(), 0) == 0 && ::pwrite(fd_.get(), pid.data(), pid.size(), 0) > 0;  // only for people
  removed_.emplace(file_);
}

OutputLock::~OutputLock() {
  if (!fd_) return;
  removed_.reset();
  ::unlink(file_.c_str());  // before the lock ends
}

}  // namespace foresight
