#include "scene/collada_check.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"

namespace foresight {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

// The value of an attribute in the text of a tag, `a="b"` or `a='b'`.
std::optional<std::string_view> attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    if (at == 0 || kBlank.find(tag[at - 1]) == std::string_view::npos) continue;
    std::string_view rest = tag.substr(at + name.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
    if (!rest.starts_with('=')) continue;
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlank, 1), rest.size()));
    if (rest.empty() || (rest[0] != '"' && rest[0] != '\'')) continue;
    const std::size_t end = rest.find(rest[0], 1);
    if (end != std::string_view::npos) return rest.substr(1, end - 1);
  }
  return std::nullopt;
}

class ColladaCheck {
 public:
  ColladaCheck(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {}

  void run() {
    bool has_root = false;
    for (std::size_t at = text_.find('<'); at != std::string_view::npos; at = text_.find('<', at + 1)) {
      at_ = at;
      const std::string_view rest = text_.substr(at);
      if (rest.starts_with("<!--") || rest.starts_with("<![CDATA[")) {
        at = text_.find(rest.starts_with("<!--") ? "-->" : "]]>", at);
        if (at == std::string_view::npos) break;
        continue;
      }
      const std::string_view tag = rest.substr(1, std::min(rest.find('>'), rest.size()) - 1);
      const std::string_view name = tag.substr(0, tag.find_first_of(" \t\r\n/"));
      has_root = has_root || name == "COLLADA";
      if (name == "float_array") add_array(tag);
      if (name == "accessor") add_accessor(tag);
      if (name == "param" && !accessors_.empty()) ++accessors_.back().params;
      if (name == "triangles" || name == "polylist" || name == "polygons") begin_primitives(name, tag);
      if (name == "p") ++lists_;
      if (tag == "/triangles" || tag == "/polylist" || tag == "/polygons") end_primitives();
      if ((name == "p" || name == "vcount") && !tag.ends_with('/')) {
        const long long count = check_indices(rest.substr(std::min(tag.size() + 2, rest.size())));
        if (name == "vcount") sizes_ += count;
      }
    }
    at_ = 0;
    if (!has_root) fail("has no COLLADA element in UTF-8");
    for (const Accessor& accessor : accessors_) check_accessor(accessor);
  }

 private:
  struct Accessor {
    std::size_t at;
    std::string_view source;
    long long offset, count, stride, params;
  };

  [[noreturn]] void fail(const std::string& what) const {
    const auto line = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw InputError(at_line(file_, static_cast<int>(line) + 1), what, "export the mesh again, the file is damaged");
  }

  long long number(std::string_view tag, const char* name, std::optional<long long> otherwise) const {
    const auto text = attribute(tag, name);
    const auto value = text ? parse_integer(*text) : otherwise;
    // No array of a readable file is longer than the file; this also keeps the products small.
    if (!value || *value < 0 || *value > static_cast<long long>(text_.size()))
      fail(std::string("an array or accessor has no valid ") + name);
    return *value;
  }

  void add_array(std::string_view tag) {
    const long long count = number(tag, "count", std::nullopt);
    const auto [it, is_new] = arrays_.emplace(attribute(tag, "id").value_or(""), count);
    if (!is_new) it->second = std::min(it->second, count);
  }

  void add_accessor(std::string_view tag) {
    accessors_.push_back({at_, attribute(tag, "source").value_or(""), number(tag, "offset", 0),
                          number(tag, "count", std::nullopt), number(tag, "stride", 1), 0});
  }

  void check_accessor(const Accessor& a) {
    at_ = a.at;
    const auto array = arrays_.find(a.source.substr(std::min<std::size_t>(1, a.source.size())));
    if (array == arrays_.end() || a.count == 0) return;  // not of floats
    if (a.offset + (a.count - 1) * a.stride + std::max(a.stride, a.params) > array->second)
      fail("an accessor reads beyond its array of " + std::to_string(array->second) + " numbers");
  }

  void begin_primitives(std::string_view name, std::string_view tag) {
    const long long count = number(tag, "count", 0);
    expected_lists_ = name == "polygons" ? count : std::min(count, 1LL);
    expected_sizes_ = name == "polylist" ? count : 0;
    lists_ = sizes_ = 0;
  }

  // assimp takes the number of polygon sizes on trust; it counts index lists along and aborts the
  // program where it comes out with another number.
  void end_primitives() const {
    if (sizes_ != expected_sizes_)
      fail("has " + std::to_string(sizes_) + " polygon sizes where " + std::to_string(expected_sizes_) +
           " are announced");
    if (lists_ != expected_lists_)
      fail("has " + std::to_string(lists_) + " index lists where " + std::to_string(expected_lists_) +
           " are announced");
  }

  // Returns how many there are.
  long long check_indices(std::string_view content) const {
    const std::size_t end = content.find_first_not_of(" \t\r\n0123456789");
    if (end == std::string_view::npos || content[end] != '<') fail("an index list holds something else than indices");
    long long count = 0;
    for (std::size_t i = 0; i < end; ++i)
      count += kBlank.find(content[i]) == std::string_view::npos &&
               (i == 0 || kBlank.find(content[i - 1]) != std::string_view::npos);
    return count;
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::map<std::string_view, long long> arrays_;  // id -> count
  std::vector<Accessor> accessors_;
  // Of the current group of primitives: p elements, and numbers in vcount.
  long long lists_ = 0, expected_lists_ = 0, sizes_ = 0, expected_sizes_ = 0;
};

}  // namespace

void check_collada(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  ColladaCheck(file, text).run();
}

}  // namespace foresight
