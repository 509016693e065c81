#include "common/read_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/error.hpp"

namespace foresight {
namespace fs = std::filesystem;

void require_regular_file(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw InputError(file.string(), "no such file", "put it there or correct the name");
  // Reading a device or a pipe could wait forever or never end.
  if (!fs::is_regular_file(status)) throw InputError(file.string(), "is not a regular file", "name a file");
}

std::string read_file(const fs::path& file, std::uintmax_t largest) {
  require_regular_file(file);
  std::error_code error;
  std::ifstream stream(file, std::ios::binary);
  std::string content;
  const auto size = fs::file_size(file, error);
  if (!error && size > largest)
    throw InputError(file.string(),
                     "has " + std::to_string(size) + " bytes, more than the " + std::to_string(largest) +
                         " that are read of such a file",
                     "check that it is the right one");
  if (stream && !error) {
    content.resize(size);
    stream.read(content.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(stream.gcount()) == size) return content;
  }
  throw InputError(file.string(), std::string("cannot be read (") + std::strerror(errno) + ")",
                   "check its permissions and the disk");
}

}  // namespace foresight
