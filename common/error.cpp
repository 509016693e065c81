#include "common/error.hpp"

namespace foresight {

InputError::InputError(const std::string& where, const std::string& what, const std::string& cure)
    : std::runtime_error(where + ": " + what + "; " + cure) {}

RuntimeFailure::RuntimeFailure(const std::string& what, const std::string& cure)
    : std::runtime_error(what + "; " + cure) {}

void require(bool ok, const std::string& where, const std::string& what, const std::string& cure) {
  if (!ok) throw InputError(where, what, cure);
}

std::string at_line(const std::filesystem::path& file, int line) {
  return file.string() + ":" + std::to_string(line);
}

}  // namespace foresight
