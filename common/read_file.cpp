#include "common/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/error.hpp"
#include "common/unique_fd.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse_size(const fs::path& file, std::uintmax_t size, std::uintmax_t largest) {
  throw InputError(file.string(),
                   "has " + std::to_string(size) + " bytes, more than the " + std::to_string(largest) +
                       " that are read of such a file",
                   "check that it is the right one");
}

[[noreturn]] void refuse_missing(const fs::path& path) {
  throw InputError(path.string(), "no such file", "put it there or correct the name");
}

[[noreturn]] void refuse_reading(const fs::path& file) {
  throw InputError(file.string(), std::string("cannot be read (") + std::strerror(errno) + ")",
                   "check its permissions and the disk");
}

}  // namespace

void require_regular_file(const fs::path& file, std::uintmax_t largest) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) {
    if (errno != ENOENT && errno != ENOTDIR) refuse_reading(file);
    refuse_missing(file);
  }
  if (!S_ISREG(status.st_mode)) throw InputError(file.string(), "is not a regular file", "name a file");
  if (const auto size = static_cast<std::uintmax_t>(status.st_size); size > largest) refuse_size(file, size, largest);
}

void require_there(const fs::path& path) {
  if (!fs::exists(path)) refuse_missing(path);
}

std::string read_file(const fs::path& file, std::uintmax_t largest) {
  require_regular_file(file, largest);
  const UniqueFd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  struct stat status {};
  if (!fd || ::fstat(fd.get(), &status) != 0) refuse_reading(file);
  if (!S_ISREG(status.st_mode)) throw InputError(file.string(), "is not a regular file", "name a file");
  // Of some files (in /proc) the size is not known before.
  constexpr std::size_t kPiece = 65536;
  std::string content(static_cast<std::size_t>(status.st_size) + 1, '\0');
  for (std::size_t end = 0;;) {
    if (end == content.size()) content.resize(end + std::max(end / 2, kPiece));
    const ssize_t got = ::read(fd.get(), content.data() + end, content.size() - end);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse_reading(file);
    end += static_cast<std::size_t>(got);
    if (end > largest) refuse_size(file, end, largest);
    if (got > 0) continue;
    content.resize(end);
    return content;
  }
}

std::ifstream open_input(const fs::path& file, std::uintmax_t largest) {
  require_regular_file(file, largest);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse_reading(file);
  return stream;
}

}  // namespace foresight
