#include "calibration/target/view_names.hpp"

#include <filesystem>
#include <regex>

namespace foresight {
namespace {

std::string trimmed(const std::string& text) {
  static const std::regex kEnds("^[/_.\\-]+|[/_.\\-]+$");
  static const std::regex kDoubled("[_.\\-]*/[/_.\\-]*");
  return std::regex_replace(std::regex_replace(text, kDoubled, "/"), kEnds, "");
}

}  // namespace

SidedName split_side(std::string_view path) {
  static const std::regex kSide(
      "(left)|(right)|(?:camera|cam)[_\\-]?(?:(0)|(1))(?![0-9])|(?:^|[/_.\\-])(?:(l)|(r))(?![a-z0-9])",
      std::regex::icase);
  const std::filesystem::path file(path);
  const std::string name = (file.parent_path() / file.stem()).string();
  std::smatch last;
  for (std::sregex_iterator at(name.begin(), name.end(), kSide), end; at != end; ++at) last = *at;
  if (last.empty()) return {std::nullopt, name};
  const bool left = last[1].matched || last[3].matched || last[5].matched;
  std::string rest = trimmed(last.prefix().str() + "/" + last.suffix().str());
  // The side may stand inside a name: "cal_left_07" is "cal_07", not two folders.
  const auto slash = [](const std::string& text) { return text.find('/') != std::string::npos; };
  if (!slash(name)) rest = std::regex_replace(rest, std::regex("/"), "_");
  return {left ? PairSide::left : PairSide::right, rest.empty() ? name : rest};
}

}  // namespace foresight
