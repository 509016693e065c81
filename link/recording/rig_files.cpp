#include "link/recording/rig_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"

namespace foresight::link {
namespace {

namespace fs = std::filesystem;

fs::path folder_of_all(std::span<const fs::path> files) {
  fs::path out = files.front().parent_path();
  const auto holds = [&](const fs::path& file) {
    const fs::path relative = file.lexically_relative(out);
    return !relative.empty() && *relative.begin() != "..";
  };
  for (const fs::path& file : files)
    while (!holds(file) && out.has_relative_path()) out = out.parent_path();
  return out;
}

}  // namespace

std::string attach_rig(McapWriter& out, std::span<const fs::path> files, std::int64_t time_ns) {
  std::vector<fs::path> places;
  for (const fs::path& file : files) places.push_back(fs::absolute(file).lexically_normal());
  const fs::path base = folder_of_all(places);
  std::string rig;
  for (const fs::path& place : places) {
    const std::string content = read_file(place);
    const std::string name = kRigFolder + place.lexically_relative(base).generic_string();
    if (rig.empty()) rig = name;
    out.add_attachment(name, "application/octet-stream", time_ns,
                       {reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
  }
  return rig;
}

UnpackedRig::UnpackedRig() {
  std::string name = (fs::temp_directory_path() / "foresight-rig-XXXXXX").string();
  if (!::mkdtemp(name.data()))
    throw RuntimeFailure("cannot make a folder like " + name + " (" + std::strerror(errno) + ")",
                         "free some space there, or set TMPDIR to a folder that can be written");
  folder_ = name;
}

UnpackedRig::~UnpackedRig() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void UnpackedRig::take(const std::string& name, std::span<const std::uint8_t> data) {
  if (!name.starts_with(kRigFolder)) return;
  const fs::path place = file(name);
  fs::create_directories(place.parent_path());
  write_bytes(place, data.data(), data.size());
}

fs::path UnpackedRig::file(const std::string& name) const {
  const fs::path relative = fs::path(name).lexically_normal();
  const auto control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  if (relative.is_absolute() || relative.empty() || *relative.begin() == ".." || std::ranges::any_of(name, control))
    throw InputError("the recording", "has an attachment " + in_quotes(name) + ", which leads elsewhere",
                     "do not trust it; record with `foresight record --line`");
  return folder_ / relative;
}

}  // namespace foresight::link
