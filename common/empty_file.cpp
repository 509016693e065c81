#include "common/empty_file.hpp"

namespace foresight {

void remove_empty(const std::filesystem::path& file) noexcept {
  std::error_code error;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, error))) return;
  if (std::filesystem::file_size(file, error) == 0 && !error) std::filesystem::remove(file, error);
}

}  // namespace foresight
