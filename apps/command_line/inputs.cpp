#include "apps/command_line/inputs.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "apps/command_line/named_files.hpp"
#include "common/partial_path.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

/// What a word may mean: itself; of NODE=FILE the file; of a pattern its folder.
std::vector<fs::path> meanings_of(const std::string& word) {
  std::vector<fs::path> out{word};
  if (const std::size_t equals = word.find('='); equals != word.npos) out.emplace_back(word.substr(equals + 1));
  if (word.find_first_of("*?[") != word.npos) {
    const fs::path folder = fs::path(word).parent_path();
    out.push_back(folder.empty() ? fs::path(".") : folder);
  }
  return out;
}

}  // namespace

fs::path canonical_place(const fs::path& path) {
  std::error_code error;
  fs::path out = fs::weakly_canonical(fs::absolute(path), error);
  if (error) out = fs::absolute(path).lexically_normal();
  return without_end_slash(out);
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return a == b || (fs::equivalent(a, b, error) && !error);
}

bool lies_in(const fs::path& outer, const fs::path& inner) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

std::optional<Inputs::Id> Inputs::id_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return Id{status.st_dev, status.st_ino};
}

Inputs::Inputs(const std::vector<GivenPath>& given) {
  for (const GivenPath& path : given) {
    if (path.outputs) continue;
    for (const fs::path& meaning : meanings_of(path.word)) {
      std::error_code ignored;
      if (fs::is_directory(meaning, ignored))
        add_folder(meaning);
      else if (fs::is_regular_file(meaning, ignored))
        for (const fs::path& file : with_named_files(meaning)) add_file(file);
    }
  }
}

void Inputs::add_file(const fs::path& file) {
  files_.push_back(canonical_place(file));
  if (const auto id = id_of(file)) named_.emplace(*id, file.string());
}

void Inputs::add_folder(const fs::path& folder) {
  folders_.push_back(canonical_place(folder));
  std::error_code ignored;
  const auto skip = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator at(folder, skip, ignored), end; at != end; at.increment(ignored))
    if (at->is_regular_file(ignored))
      if (const auto id = id_of(at->path())) in_folders_.emplace(*id, at->path().string());
}

std::optional<std::string> Inputs::find(const fs::path& file, bool marked) const {
  const auto id = id_of(file);
  if (!id) return std::nullopt;
  if (const auto found = named_.find(*id); found != named_.end()) return found->second;
  if (const auto found = in_folders_.find(*id); found != in_folders_.end() && !marked) return found->second;
  return std::nullopt;
}

std::optional<std::string> Inputs::find_below(const fs::path& folder, bool replaced) const {
  for (const fs::path& input : folders_)
    if (same_file(folder, input) || (replaced && lies_in(folder, input))) return input.string();
  if (replaced)
    for (const fs::path& input : files_)
      if (lies_in(folder, input)) return input.string();
  return std::nullopt;
}

}  // namespace foresight
