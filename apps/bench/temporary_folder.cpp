#include "apps/bench/temporary_folder.hpp"

#include <cstdlib>
#include <system_error>

#include "common/error.hpp"

namespace foresight {

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "foresight-XXXXXX").string();
  if (!::mkdtemp(name.data())) throw RuntimeFailure("no folder can be made in " + name, "free some disk space");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace foresight
