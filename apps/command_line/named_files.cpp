#include "apps/command_line/named_files.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>

#include "common/read_file.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestText = std::uintmax_t{4} << 20;
constexpr int kDepth = 4;
constexpr std::size_t kLongestWord = 1024;

bool is_text(const fs::path& file) {
  constexpr std::array<std::string_view, 9> known{".yaml", ".yml",  ".urdf", ".xml", ".xacro",
                                                  ".json", ".gltf", ".dae",  ".txt"};
  return std::ranges::find(known, file.extension().string()) != known.end();
}

std::string text_of(const fs::path& file) {
  try {
    return read_file(file, kLargestText);
  } catch (const std::exception&) {
    return {};
  }
}

/// Words between blanks and the signs of YAML, XML and JSON; where quotes stand around several, all of these together
/// too.
std::set<std::string> words_of(std::string_view text) {
  std::set<std::string> out;
  const auto split = [&](std::string_view between) {
    for (std::size_t at = text.find_first_not_of(between); at != text.npos;) {
      const std::size_t end = std::min(text.find_first_of(between, at), text.size());
      if (end - at <= kLongestWord) out.emplace(text.substr(at, end - at));
      at = text.find_first_not_of(between, end);
    }
  };
  split(" \t\r\n\"'<>[]{},=");
  split("\"'\r\n");
  for (std::size_t at = 0; (at = text.find(": ", at)) != text.npos; at += 2) {  // "key: a name with blanks"
    const std::string_view rest = text.substr(at + 2, std::min(text.find('\n', at), text.size()) - at - 2);
    if (rest.size() <= kLongestWord) out.emplace(rest.substr(0, rest.find_last_not_of(" \r") + 1));
  }
  return out;
}

/// The places that `word` may mean in a file of `folder`.
std::vector<fs::path> places_of(const std::string& word, const fs::path& folder) {
  for (const std::string_view scheme : {"package://", "file://", "model://"}) {
    if (!word.starts_with(scheme)) continue;
    const std::string rest = word.substr(scheme.size());
    std::vector<fs::path> out{fs::path("/") / rest};
    const std::string in_package = rest.substr(std::min(rest.find('/'), rest.size() - 1) + 1);
    for (fs::path at = fs::absolute(folder); at.has_relative_path(); at = at.parent_path()) {
      out.push_back(at / rest);
      out.push_back(at / in_package);
    }
    return out;
  }
  return {folder / word};
}

}  // namespace

std::vector<fs::path> with_named_files(const fs::path& file) {
  std::vector<fs::path> all{file};
  std::set<std::string> known;
  std::size_t next = 0;
  for (int depth = 0; depth < kDepth; ++depth)
    for (const std::size_t end = all.size(); next < end; ++next) {
      const fs::path in = all[next];
      if (depth > 0 && !is_text(in)) continue;
      for (const std::string& word : words_of(text_of(in)))
        for (const fs::path& place : places_of(word, in.parent_path())) {
          std::error_code ignored;
          if (fs::is_regular_file(place, ignored) && known.insert(fs::weakly_canonical(place, ignored).string()).second)
            all.push_back(place);
        }
    }
  return all;
}

}  // namespace foresight
