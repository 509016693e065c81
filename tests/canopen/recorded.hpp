// Where recorded data lies: FORESIGHT_DATA, else ../shared/data beside the project.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace foresight::canopen {

inline std::filesystem::path recorded(const char* folder) {
  const char* set = std::getenv("FORESIGHT_DATA");
  return (set ? std::filesystem::path(set) : std::filesystem::path(FORESIGHT_SOURCE_DIR) / "../shared/data") / folder;
}

}  // namespace foresight::canopen
