#include "scene/ply_header.hpp"

#include <algorithm>
#include <map>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight::ply {
namespace {

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::string_view content) : file_(file), content_(content) {}

  Header read() {
    if (next_line() != std::vector<std::string_view>{"ply"}) fail("is not a PLY file", "name a PLY mesh");
    while (true) {
      const auto words = next_line();
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format")
        read_format(words);
      else if (words[0] == "element")
        read_element(words);
      else if (words[0] == "property")
        read_property(words);
      else
        fail("unknown header word " + in_quotes(words[0]), "export the mesh again");
    }
    if (!has_format_) fail("the header has no format line", "export the mesh again");
    header_.size = at_;
    header_.lines = line_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& cure) const {
    throw InputError(at_line(file_, line_), what, cure);
  }

  std::vector<std::string_view> next_line() {
    ++line_;
    const std::size_t end = content_.find('\n', at_);
    // No real header line is long: binary data without end_header must not be split as words.
    if (end == std::string_view::npos || end - at_ > 4096)
      fail("the header ends without end_header", "copy or export the mesh again, the file is damaged");
    std::string_view line = content_.substr(at_, end - at_);
    at_ = end + 1;
    std::vector<std::string_view> words;
    while (true) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
      if (line.empty()) return words;
      const std::size_t length = std::min(line.find_first_of(" \t\r"), line.size());
      words.push_back(line.substr(0, length));
      line.remove_prefix(length);
    }
  }

  void read_format(const std::vector<std::string_view>& words) {
    static const std::map<std::string_view, Format> kFormats = {{"ascii", Format::ascii},
                                                                {"binary_little_endian", Format::little_endian},
                                                                {"binary_big_endian", Format::big_endian}};
    const auto format = words.size() == 3 ? kFormats.find(words[1]) : kFormats.end();
    if (format == kFormats.end() || words[2] != "1.0")
      fail("unknown format", "export as ascii, binary_little_endian or binary_big_endian 1.0");
    header_.format = format->second;
    has_format_ = true;
  }

  void read_element(const std::vector<std::string_view>& words) {
    const auto count = words.size() == 3 ? parse_integer(words[2]) : std::nullopt;
    if (!count || *count < 0) fail("an element line is not 'element NAME COUNT'", "export the mesh again");
    for (const Element& element : header_.elements)
      if (element.name == words[1]) fail("element " + in_quotes(words[1]) + " appears twice", "export the mesh again");
    header_.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(*count), {}});
  }

  Type type(std::string_view name) const {
    static const std::map<std::string_view, Type> kTypes = {
        {"char", Type::int8},     {"int8", Type::int8},       {"uchar", Type::uint8},    {"uint8", Type::uint8},
        {"short", Type::int16},   {"int16", Type::int16},     {"ushort", Type::uint16},  {"uint16", Type::uint16},
        {"int", Type::int32},     {"int32", Type::int32},     {"uint", Type::uint32},    {"uint32", Type::uint32},
        {"float", Type::float32}, {"float32", Type::float32}, {"double", Type::float64}, {"float64", Type::float64}};
    const auto it = kTypes.find(name);
    if (it == kTypes.end()) fail("unknown type " + in_quotes(name), "export the mesh again");
    return it->second;
  }

  void read_property(const std::vector<std::string_view>& words) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (header_.elements.empty() || (!list && words.size() != 3))
      fail("a property line is not 'property TYPE NAME' below an element", "export the mesh again");
    Property property{std::string(words.back()), type(words[words.size() - 2]), std::nullopt};
    if (list) property.count = type(words[2]);
    if (list && is_float(*property.count)) fail("a list counts in floating point", "export the mesh again");
    header_.elements.back().properties.push_back(property);
  }

  const std::filesystem::path& file_;
  std::string_view content_;
  std::size_t at_ = 0;
  int line_ = 0;
  bool has_format_ = false;
  Header header_;
};

}  // namespace

std::size_t size_of(Type type) {
  switch (type) {
    case Type::int8:
    case Type::uint8: return 1;
    case Type::int16:
    case Type::uint16: return 2;
    case Type::int32:
    case Type::uint32:
    case Type::float32: return 4;
    case Type::float64: return 8;
  }
  return 8;
}

std::optional<std::size_t> Element::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return i;
  return std::nullopt;
}

Header read_header(const std::filesystem::path& file, std::string_view content) {
  return HeaderReader(file, content).read();
}

}  // namespace foresight::ply
