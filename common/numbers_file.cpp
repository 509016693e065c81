#include "common/numbers_file.hpp"

#include "common/atomic_file.hpp"

namespace foresight {

void write_numbers(const std::optional<std::filesystem::path>& file, const std::string& object) {
  if (!file) return;
  const std::string more = object.size() > 2 ? "," : "";  // "{}" has no other key
  write_file_atomically(*file, "{\n  \"generator\": \"foresight\"" + more + object.substr(1) + "\n");
}

}  // namespace foresight
