#include "scene/mesh_finder.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestPackageXml = 1 << 20;

/// What a mesh's name says.
struct MeshName {
  std::string package;  ///< "" where it names none
  fs::path path;
};

MeshName parse(const std::string& name, const std::string& where) {
  const std::size_t scheme_end = name.find("://");
  if (scheme_end == std::string::npos) return {"", name};
  const std::string scheme = name.substr(0, scheme_end), rest = name.substr(scheme_end + 3);
  if (scheme == "file") return {"", rest};
  if (scheme != "package" && scheme != "model")
    throw InputError(where, "the mesh " + in_quotes(name) + " is named by " + in_quotes(scheme + "://"),
                     "write package://NAME/path, file:///path or a relative path");
  const std::size_t slash = rest.find('/');
  if (slash == 0 || slash == std::string::npos || slash + 1 == rest.size())
    throw InputError(where, "the mesh " + in_quotes(name) + " names no file of a package", "write package://NAME/path");
  return {rest.substr(0, slash), rest.substr(slash + 1)};
}

/// The name that a package.xml in the folder gives it; "" without one.
std::string package_name(const fs::path& folder) {
  const fs::path file = folder / "package.xml";
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kLargestPackageXml || error) return "";
  std::string xml;
  try {
    xml = read_file(file, kLargestPackageXml);
  } catch (const InputError&) {
    return "";  // not readable for us: it says nothing
  }
  const std::size_t begin = xml.find("<name>"), end = xml.find("</name>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return "";
  std::string name = xml.substr(begin + 6, end - begin - 6);
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
  return name;
}

void add_folders_above(const fs::path& file, const std::optional<fs::path>& last, std::vector<fs::path>& out) {
  for (fs::path folder = file.parent_path();; folder = folder.parent_path()) {
    if (std::find(out.begin(), out.end(), folder) == out.end()) out.push_back(folder);
    if (folder == last || folder == folder.parent_path()) return;
  }
}

std::vector<fs::path> folders_above(const fs::path& urdf, const std::optional<fs::path>& inside) {
  std::vector<fs::path> out;
  if (inside) {
    add_folders_above(urdf, inside, out);
    return out;
  }
  std::error_code error;
  add_folders_above(fs::absolute(urdf, error).lexically_normal(), {}, out);
  if (const fs::path real = fs::canonical(urdf, error); !error) add_folders_above(real, {}, out);
  return out;
}

/// A folder and what to look for in it.
struct Place {
  fs::path folder, path;
  bool operator==(const Place& other) const {
    return (folder / path).lexically_normal() == (other.folder / other.path).lexically_normal();
  }
};

std::vector<Place> places_of(const MeshName& mesh, const fs::path& urdf, const MeshSearch& search) {
  std::vector<Place> out;
  const auto add = [&](const fs::path& folder, const fs::path& path) {
    const Place place{folder, path};
    if (std::find(out.begin(), out.end(), place) == out.end()) out.push_back(place);
  };
  if (mesh.path.is_absolute()) {
    add(mesh.path.parent_path(), mesh.path.filename());
    if (search.root)
      for (fs::path rest = mesh.path.relative_path(); !rest.empty();) {
        add(*search.root, rest);
        rest = rest.lexically_relative(*rest.begin());
        if (rest == ".") break;
      }
    return out;
  }
  const fs::path in_package = mesh.package / mesh.path;
  if (search.root) {
    if (!mesh.package.empty()) add(*search.root, in_package);
    add(*search.root, mesh.path);
  }
  const std::vector<fs::path> folders = folders_above(urdf, search.inside);
  for (const fs::path& folder : folders) {
    add(folder, in_package);
    if (!mesh.package.empty() && (folder.filename() == mesh.package || package_name(folder) == mesh.package))
      add(folder, mesh.path);
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(2, folders.size()); ++i) add(folders[i], mesh.path);
  return out;
}

}  // namespace

fs::path find_mesh(const std::string& name, const fs::path& urdf, const MeshSearch& search, const std::string& where) {
  const MeshName mesh = parse(name, where);
  if (search.inside && mesh.path.is_absolute())
    throw InputError(where, "the mesh " + in_quotes(name) + " is not named relative to the robot",
                     "write package://NAME/path or a relative path");
  std::string looked_at;
  for (const Place& place : places_of(mesh, urdf, search)) {
    const fs::path file = (place.folder / place.path).lexically_normal();
    std::error_code error;
    if (fs::exists(file, error))
      return search.inside ? resolve_inside(*search.inside, place.folder, place.path.string(), where) : file;
    looked_at += (looked_at.empty() ? "" : ", ") + file.string();
  }
  throw InputError(where, "the mesh " + in_quotes(name) + " is missing; looked for " + looked_at,
                   search.inside ? "put it at one of these places"
                                 : "put it at one of these places, or give a rig robot.mesh_root: the folder that "
                                   "holds it, or its package");
}

}  // namespace foresight
