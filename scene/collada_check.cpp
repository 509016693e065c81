#include "scene/collada_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"

namespace foresight {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

class ColladaCheck final : public pugi::xml_tree_walker {
 public:
  ColladaCheck(const std::filesystem::path& file, const std::string& text) : file_(file), text_(text) {}

  void run() {
    // assimp reads with this parser and this mode, so that both see the same tree.
    const pugi::xml_parse_result result = document_.load_string(text_.c_str(), pugi::parse_full);
    if (!document_.child("COLLADA")) fail(0, "has no COLLADA element in UTF-8");
    if (!result) fail(result.offset, std::string("is no whole XML: ") + result.description());
    document_.traverse(*this);
    for (const Accessor& accessor : accessors_) check_accessor(accessor);
  }

 private:
  struct Accessor {
    pugi::xml_node node;
    long long offset, count, stride, params;
  };

  bool for_each(pugi::xml_node& node) override {
    const std::string_view name = node.name();
    if (name == "float_array") add_array(node);
    if (name == "accessor") add_accessor(node);
    if (name == "input") number(node, "offset", 0);  // assimp makes room for as many indices a vertex
    if (name == "triangles" || name == "polylist" || name == "polygons") check_primitives(node);
    if (name == "p" || name == "vcount") count_indices(node);
    return true;
  }

  [[noreturn]] void fail(std::ptrdiff_t at, const std::string& what) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(at, 0, std::ssize(text_));
    const auto line = std::count(text_.begin(), end, '\n');
    throw InputError(at_line(file_, static_cast<int>(line) + 1), what, "export the mesh again, the file is damaged");
  }
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what) const { fail(node.offset_debug(), what); }

  long long number(pugi::xml_node node, const char* name, std::optional<long long> otherwise) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    const auto value = attribute ? parse_integer(attribute.value()) : otherwise;
    // No array of a readable file is longer than the file; this also keeps the products small.
    if (!value || *value < 0 || *value > static_cast<long long>(text_.size()))
      fail(node, fmt::format("an array, accessor or input has no valid {}", name));
    return *value;
  }

  void add_array(pugi::xml_node node) {
    const long long count = number(node, "count", std::nullopt);
    const auto [it, is_new] = arrays_.emplace(node.attribute("id").value(), count);
    if (!is_new) it->second = std::min(it->second, count);
  }

  void add_accessor(pugi::xml_node node) {
    accessors_.push_back({node, number(node, "offset", 0), number(node, "count", std::nullopt),
                          number(node, "stride", 1), std::ssize(inside(node, "param"))});
  }

  void check_accessor(const Accessor& a) const {
    const std::string_view source = a.node.attribute("source").value();
    const auto array = arrays_.find(source.substr(std::min<std::size_t>(1, source.size())));
    if (array == arrays_.end() || a.count == 0) return;  // not of floats
    if (a.offset + (a.count - 1) * a.stride + std::max(a.stride, a.params) > array->second)
      fail(a.node, "an accessor reads beyond its array of " + std::to_string(array->second) + " numbers");
  }

  // assimp takes the number of polygon sizes on trust; it counts index lists along and aborts the
  // program where it comes out with another number.
  void check_primitives(pugi::xml_node node) const {
    const std::string_view name = node.name();
    const long long count = number(node, "count", 0);
    const long long lists = name == "polygons" ? count : std::min(count, 1LL), sizes = name == "polylist" ? count : 0;
    long long found_sizes = 0;
    for (const pugi::xml_node list : inside(node, "vcount")) found_sizes += count_indices(list);
    if (found_sizes != sizes)
      fail(node,
           "has " + std::to_string(found_sizes) + " polygon sizes where " + std::to_string(sizes) + " are announced");
    if (const long long found = std::ssize(inside(node, "p")); found != lists)
      fail(node, "has " + std::to_string(found) + " index lists where " + std::to_string(lists) + " are announced");
  }

  // All elements of that name, however deep.
  static std::vector<pugi::xml_node> inside(pugi::xml_node node, std::string_view name) {
    struct Finder final : pugi::xml_tree_walker {
      std::string_view name;
      std::vector<pugi::xml_node> found;
      bool for_each(pugi::xml_node& inner) override {
        if (inner.name() == name) found.push_back(inner);
        return true;
      }
    } finder;
    finder.name = name;
    node.traverse(finder);
    return std::move(finder.found);
  }

  // Returns how many there are.
  long long count_indices(pugi::xml_node node) const {
    const std::string_view content = node.text().get();
    if (content.find_first_not_of(" \t\r\n0123456789") != std::string_view::npos)
      fail(node, "an index list holds something else than indices");
    long long count = 0;
    for (std::size_t i = 0; i < content.size(); ++i)
      count += kBlank.find(content[i]) == std::string_view::npos &&
               (i == 0 || kBlank.find(content[i - 1]) != std::string_view::npos);
    return count;
  }

  const std::filesystem::path& file_;
  const std::string& text_;
  pugi::xml_document document_;
  std::map<std::string, long long, std::less<>> arrays_;  // id -> count
  std::vector<Accessor> accessors_;
};

}  // namespace

void check_collada(const std::filesystem::path& file) {
  const std::string text = read_file(file, kLargestMesh);
  ColladaCheck(file, text).run();
}

}  // namespace foresight
