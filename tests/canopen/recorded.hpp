// Where recorded data lies: FORESIGHT_DATA, else ../shared/data beside the project.
#pragma once

#include <filesystem>

#include "tests/support/folders.hpp"

namespace foresight::canopen {

inline std::filesystem::path recorded(const char* folder) {
  return data_folder() / folder;
}

}  // namespace foresight::canopen
