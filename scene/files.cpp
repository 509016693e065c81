#include "scene/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

bool is_inside(const fs::path& root, const fs::path& path) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

}  // namespace

void write_bytes(const fs::path& file, const void* data, std::size_t size) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  stream.close();
  if (!stream)
    throw RuntimeFailure("cannot write " + file.string() + " (" + std::strerror(errno) + ")",
                         cure_of_write_error(errno));
}

void write_text(const fs::path& file, const std::string& text) {
  write_bytes(file, text.data(), text.size());
}

fs::path resolve_inside(const fs::path& root, const fs::path& folder, std::string_view name, const std::string& where) {
  const std::string shown = in_quotes(name);
  const bool odd = std::any_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < 32) || c == 127; });
  if (name.empty() || odd) throw InputError(where, shown + " is no file name", "write a plain relative path");
  const fs::path relative(name);
  if (relative.is_absolute())
    throw InputError(where, "the path " + shown + " is absolute", "write it relative to " + folder.string());
  const fs::path path = (folder / relative).lexically_normal();
  std::error_code error;
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) throw InputError(where, shown + " cannot be followed (" + error.message() + ")", "correct the path");
  if (!is_inside(root, path) || !is_inside(root, target))
    throw InputError(where, "the path " + shown + " leaves " + root.string(),
                     "copy the file into that folder and name it there");
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw InputError(where, "the file " + path.string() + " is missing", "put it there or remove the entry");
  if (!fs::is_regular_file(status)) throw InputError(where, path.string() + " is not a regular file", "name a file");
  return path;
}

fs::path canonical_folder(const fs::path& folder) {
  std::error_code error;
  const fs::path path = fs::canonical(folder, error);
  if (error)
    throw InputError(folder.string(), "no such folder (" + error.message() + ")", "give the path of a run folder");
  if (!fs::is_directory(path, error))
    throw InputError(folder.string(), "is not a folder", "give the folder that holds camera.yaml and rgb.txt");
  return path;
}

}  // namespace foresight
