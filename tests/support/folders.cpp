#include "tests/support/folders.hpp"

#include <cstdlib>

namespace foresight {

std::filesystem::path source_folder() {
  return FORESIGHT_SOURCE_DIR;
}

std::filesystem::path data_folder() {
  const char* set = std::getenv("FORESIGHT_DATA");
  return set ? std::filesystem::path(set) : source_folder() / "../shared/data";
}

}  // namespace foresight
