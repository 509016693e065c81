// Fields of a YAML file, checked: every error names file, line and field.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

/// A mapping in a YAML file. Cheap to copy. All methods throw InputError.
class YamlMap {
 public:
  /// Reads the file, whose top level must be a mapping. Refuses what is not YAML.
  static YamlMap load(const std::filesystem::path& file);

  /// The same for the text of `file`, which is only named.
  static YamlMap parse(const std::filesystem::path& file, const std::string& text);

  /// Refuses keys that are not in `known` (naming the nearest that is) and keys given twice.
  void require_known(const std::vector<std::string>& known) const;

  const std::filesystem::path& file() const { return file_; }
  bool has(const std::string& key) const { return node_[key].IsDefined(); }
  std::vector<std::string> keys() const;
  /// What it says, without `left_out`: the same text for the same values, however they are set out and commented.
  std::string text_without(const std::string& left_out) const;
  std::string where(const std::string& key) const;  ///< "file:line: a.b.key", of this map when absent

  std::string text(const std::string& key) const;                ///< a scalar that is not empty
  std::vector<std::string> texts(const std::string& key) const;  ///< a list of scalars, none of them empty
  double number(const std::string& key) const;                   ///< finite
  double positive(const std::string& key) const;                 ///< finite, above 0
  int integer(const std::string& key) const;                     ///< within int
  int integer(const std::string& key, int least, int most) const;
  std::vector<double> numbers(const std::string& key) const;  ///< a list, a list of rows, or {rows, cols, data}; finite
  std::vector<double> numbers(const std::string& key, std::size_t count) const;
  YamlMap map(const std::string& key) const;
  std::vector<YamlMap> maps(const std::string& key) const;  ///< a list of mappings

  /// What stands beside the key's word in `known`; refuses other words, naming the nearest.
  template <typename T>
  T choice(const std::string& key, const std::vector<std::pair<std::string, T>>& known) const {
    const std::string word = text(key);
    std::vector<std::string> names;
    for (const auto& [name, value] : known) {
      if (name == word) return value;
      names.push_back(name);
    }
    refuse_word(key, word, names);
  }

  /// {xyz: [..], quaternion: [x, y, z, w]} (either may be absent), or a rigid 4x4 matrix,
  /// row-major, as a list of 16, of 4 rows, or as {rows, cols, data}.
  Pose pose(const std::string& key) const;

 private:
  YamlMap(std::filesystem::path file, std::string prefix, YAML::Node node);
  [[noreturn]] void refuse_word(const std::string& key, const std::string& word,
                                const std::vector<std::string>& known) const;
  YAML::Node require(const std::string& key) const;
  double finite(const YAML::Node& node, const std::string& key) const;

  std::filesystem::path file_;
  std::string prefix_;  // "robots[0].", for messages
  YAML::Node node_;
};

}  // namespace foresight
