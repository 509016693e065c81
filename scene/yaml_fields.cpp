#include "scene/yaml_fields.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "common/error.hpp"
#include "common/rotation.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/text_table.hpp"

namespace foresight {

namespace {

/// Bytes of the character at `at`; 0 where it is none in UTF-8 (RFC 3629).
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(at), second = byte(at + 1);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool no_character = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || no_character ? 0 : length;
}

void require_utf8(const std::filesystem::path& file, std::string_view text) {
  int line = 1;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0)
      throw InputError(at_line(file, line), "has a letter that is not in UTF-8",
                       "save the file as UTF-8; `iconv -f latin1 -t utf-8` makes it of a Latin-1 one");
    if (text[at] == '\n') ++line;
    at += length;
  }
}

/// The first line, up to `last`, that a tab indents; 0: none. Counted from 1.
int line_indented_by_tab(std::string_view text, int last) {
  for (int line = 1; line <= last; ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view indent = text.substr(0, std::min(text.find_first_not_of(" \t"), end));
    if (indent.find('\t') != std::string_view::npos) return line;
    if (end == text.size()) break;
    text.remove_prefix(end + 1);
  }
  return 0;
}

YAML::Node only_document(const std::filesystem::path& file, const std::string& text) {
  std::vector<YAML::Node> documents = YAML::LoadAll(text);
  for (std::size_t i = 1; i < documents.size(); ++i)
    if (!documents[i].IsNull())
      throw InputError(at_line(file, documents[i].Mark().line + 1), "begins a second document, after `---`",
                       "keep one of them: the others would not be read");
  return documents.empty() ? YAML::Node() : documents.front();
}

}  // namespace

YamlMap::YamlMap(std::filesystem::path file, std::string prefix, YAML::Node node)
    : file_(std::move(file)), prefix_(std::move(prefix)), node_(std::move(node)) {}

YamlMap YamlMap::load(const std::filesystem::path& file) {
  return parse(file, read_file(file));
}

YamlMap YamlMap::parse(const std::filesystem::path& file, const std::string& text) {
  require_utf8(file, text);
  YAML::Node node;
  try {
    node = only_document(file, text);
  } catch (const YAML::Exception& error) {
    if (const int line = line_indented_by_tab(text, error.mark.line + 1); line > 0)
      throw InputError(at_line(file, line), "is indented by a tab, which YAML does not allow",
                       "indent it by spaces, as the lines about it");
    throw InputError(at_line(file, error.mark.line + 1), "is not valid YAML (" + error.msg + ")", "correct the line");
  }
  if (!node.IsMap()) throw InputError(file.string(), "is not a mapping", "write one 'key: value' a line");
  return YamlMap(file, "", node);
}

void YamlMap::require_known(const std::vector<std::string>& known) const {
  std::vector<std::string> seen;
  for (const std::string& key : keys()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      const std::string question = question_of_near(key, known);
      throw InputError(where(key), "unknown key " + in_quotes(key),
                       (question.empty() ? "k" : question + " K") + "nown are " + joined(known));
    }
    if (std::find(seen.begin(), seen.end(), key) != seen.end())
      throw InputError(where(key), "key " + in_quotes(key) + " appears twice", "remove one of the two");
    seen.push_back(key);
  }
}

std::string YamlMap::text_without(const std::string& left_out) const {
  YAML::Emitter out;
  out << YAML::Flow << YAML::BeginMap;
  for (const std::string& key : keys())
    if (key != left_out) out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::Clone(node_[key]);
  out << YAML::EndMap;
  return out.c_str();
}

std::vector<std::string> YamlMap::keys() const {
  std::vector<std::string> out;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar())
      throw InputError(at_line(file_, entry.first.Mark().line + 1), "a key is not a plain word", "write 'key: value'");
    out.push_back(entry.first.Scalar());
  }
  return out;
}

void YamlMap::refuse_word(const std::string& key, const std::string& word,
                          const std::vector<std::string>& known) const {
  throw InputError(where(key), in_quotes(word) + " is not known here", did_you_mean(word, known));
}

std::string YamlMap::where(const std::string& key) const {
  const YAML::Node value = node_[key];
  const YAML::Mark mark = value.IsDefined() ? value.Mark() : node_.Mark();
  const std::string shown = in_quotes(prefix_ + key);
  return at_line(file_, std::max(mark.line, 0) + 1) + ": " + shown.substr(1, shown.size() - 2);
}

YAML::Node YamlMap::require(const std::string& key) const {
  const YAML::Node value = node_[key];
  if (!value.IsDefined() || value.IsNull()) throw InputError(where(key), "is missing", "add the key '" + key + "'");
  return value;
}

std::string YamlMap::text(const std::string& key) const {
  const YAML::Node value = require(key);
  if (!value.IsScalar() || value.Scalar().empty()) throw InputError(where(key), "is not a word", "write one word");
  return value.Scalar();
}

std::vector<std::string> YamlMap::texts(const std::string& key) const {
  const YAML::Node list = require(key);
  if (!list.IsSequence()) throw InputError(where(key), "is not a list", "write [a, b, ...]");
  std::vector<std::string> out;
  for (const YAML::Node& entry : list) {
    if (!entry.IsScalar() || entry.Scalar().empty())
      throw InputError(where(key), "has an entry that is not a word", "write [a, b, ...]");
    out.push_back(entry.Scalar());
  }
  return out;
}

double YamlMap::finite(const YAML::Node& node, const std::string& key) const {
  const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
  if (!value || !std::isfinite(*value))
    throw InputError(where(key), (node.IsScalar() ? in_quotes(node.Scalar()) : "an entry") + " is not a finite number",
                     "write a decimal number");
  return *value;
}

double YamlMap::number(const std::string& key) const {
  return finite(require(key), key);
}

double YamlMap::positive(const std::string& key) const {
  const double value = number(key);
  if (!(value > 0)) throw InputError(where(key), "is " + std::to_string(value), "give a number above 0");
  return value;
}

int YamlMap::integer(const std::string& key, int least, int most) const {
  const int value = integer(key);
  if (value < least || value > most)
    throw InputError(where(key), "is " + std::to_string(value),
                     "choose from " + std::to_string(least) + " to " + std::to_string(most));
  return value;
}

int YamlMap::integer(const std::string& key) const {
  const YAML::Node node = require(key);
  const auto value = node.IsScalar() ? parse_integer(node.Scalar()) : std::nullopt;
  if (!value || *value > std::numeric_limits<int>::max() || *value < std::numeric_limits<int>::min())
    throw InputError(where(key), (node.IsScalar() ? in_quotes(node.Scalar()) : "the value") + " is not an integer",
                     "write a whole number");
  return static_cast<int>(*value);
}

std::vector<double> YamlMap::numbers(const std::string& key) const {
  YAML::Node list = require(key);
  if (list.IsMap()) {
    const YamlMap matrix = map(key);
    matrix.require_known({"rows", "cols", "data"});
    std::vector<double> out = matrix.numbers("data");
    const long long cells = static_cast<long long>(matrix.integer("rows")) * matrix.integer("cols");
    if (cells != static_cast<long long>(out.size()))
      throw InputError(where(key), "data has " + std::to_string(out.size()) + " numbers",
                       "write rows x cols = " + std::to_string(cells) + " of them");
    return out;
  }
  if (!list.IsSequence()) throw InputError(where(key), "is not a list of numbers", "write [a, b, ...]");
  std::vector<double> out;
  for (const YAML::Node& entry : list) {
    if (!entry.IsSequence()) out.push_back(finite(entry, key));
    if (entry.IsSequence() && entry.size() != list[0].size())
      throw InputError(where(key), "has rows of different lengths", "write as many numbers in every row");
    if (entry.IsSequence())
      for (const YAML::Node& number : entry) out.push_back(finite(number, key));
  }
  return out;
}

std::vector<double> YamlMap::numbers(const std::string& key, std::size_t count) const {
  std::vector<double> out = numbers(key);
  if (out.size() != count)
    throw InputError(where(key), "has " + std::to_string(out.size()) + " numbers",
                     "write " + std::to_string(count) + " of them");
  return out;
}

YamlMap YamlMap::map(const std::string& key) const {
  const YAML::Node value = require(key);
  if (!value.IsMap()) throw InputError(where(key), "is not a mapping", "write {key: value, ...}");
  return YamlMap(file_, prefix_ + key + ".", value);
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) const {
  const YAML::Node list = require(key);
  if (!list.IsSequence()) throw InputError(where(key), "is not a list", "start each entry with '-'");
  std::vector<YamlMap> out;
  for (const YAML::Node& entry : list) {
    const std::string name = key + "[" + std::to_string(out.size()) + "]";
    if (!entry.IsMap())
      throw InputError(at_line(file_, entry.Mark().line + 1) + ": " + prefix_ + name, "is not a mapping",
                       "write 'key: value' pairs");
    out.push_back(YamlMap(file_, prefix_ + name + ".", entry));
  }
  return out;
}

Pose YamlMap::pose(const std::string& key) const {
  const YAML::Node value = require(key);
  if (value.IsMap() && !value["data"].IsDefined()) {
    const YamlMap parts = map(key);
    parts.require_known({"xyz", "quaternion"});
    if (!parts.has("xyz") && !parts.has("quaternion"))
      throw InputError(where(key), "is empty", "write {xyz: [x, y, z], quaternion: [x, y, z, w]}");
    const auto t = parts.has("xyz") ? parts.numbers("xyz", 3) : std::vector<double>{0, 0, 0};
    const auto q = parts.has("quaternion") ? parts.numbers("quaternion", 4) : std::vector<double>{0, 0, 0, 1};
    return checked_pose(Eigen::Vector3d(t.data()), Eigen::Vector4d(q.data()), where(key));
  }
  const auto m = numbers(key, 16);
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool rigid = matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
                     ((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 2e-3) &&
                     R.determinant() > 0;
  if (!rigid)
    throw InputError(where(key), "the 4x4 matrix is no rotation and translation",
                     "write an orthonormal rotation and the last row 0 0 0 1, row by row");
  // The nearest rotation; a quaternion from R itself would keep part of its rounding.
  const Eigen::Quaterniond q(nearest_rotation(R));
  return checked_pose(matrix.topRightCorner<3, 1>(), q.normalized().coeffs(), where(key));
}

}  // namespace foresight
