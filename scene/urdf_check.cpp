#include "scene/urdf_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <pugixml.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "common/edit_distance.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace {

enum class Sign : std::uint8_t { any, above_zero, not_zero, not_negative };

/// An attribute that holds numbers.
struct NumbersRule {
  const char* attribute;
  std::size_t count;
  Sign sign;
  bool required;
  const char* cure;
};

struct ShapeRule {
  const char* shape;
  std::vector<NumbersRule> numbers;
};

const std::vector<ShapeRule>& shapes() {
  static const std::vector<ShapeRule> rules = {
      {"box", {{"size", 3, Sign::above_zero, true, "write size=\"x y z\", three lengths in metres"}}},
      {"cylinder",
       {{"radius", 1, Sign::above_zero, true, "write it in metres"},
        {"length", 1, Sign::above_zero, true, "write it in metres"}}},
      {"sphere", {{"radius", 1, Sign::above_zero, true, "write it in metres"}}},
      {"mesh", {{"scale", 3, Sign::not_zero, false, "write scale=\"x y z\", three factors; negative ones mirror"}}}};
  return rules;
}

const std::vector<NumbersRule> kOrigin = {{"xyz", 3, Sign::any, false, "write xyz=\"x y z\" in metres"},
                                          {"rpy", 3, Sign::any, false, "write rpy=\"roll pitch yaw\" in radians"}};

/// What of a joint holds numbers, by element.
const std::vector<ShapeRule>& joint_parts() {
  static const std::vector<ShapeRule> rules = {
      {"origin", kOrigin},
      {"axis", {{"xyz", 3, Sign::any, false, "write xyz=\"x y z\", a unit vector"}}},
      {"limit",
       {{"lower", 1, Sign::any, false, "write it in radians, or metres where the joint slides"},
        {"upper", 1, Sign::any, false, "write it in radians, or metres where the joint slides"},
        {"velocity", 1, Sign::not_negative, true, "write it per second, in radians or metres"},
        {"effort", 1, Sign::any, true, "write a number"}}},
      {"safety_controller",
       {{"soft_lower_limit", 1, Sign::any, false, "write it in radians, or metres where the joint slides"},
        {"soft_upper_limit", 1, Sign::any, false, "write it in radians, or metres where the joint slides"}}},
      {"mimic",
       {{"multiplier", 1, Sign::any, false, "write a number"}, {"offset", 1, Sign::any, false, "write a number"}}}};
  return rules;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t at = text.find_first_not_of(' '); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    out.emplace_back(text.substr(at, end - at));
    at = text.find_first_not_of(' ', end);
  }
  return out;
}

/// What is wrong with one number; empty where nothing is.
std::string fault_of(const std::string& word, Sign sign) {
  const auto value = parse_number(word);
  if (!value) return word.find(',') != std::string::npos ? "is no number: the decimal sign is a point" : "is no number";
  if (!std::isfinite(*value)) return "is not finite";
  if (std::abs(*value) > kFarthest) return "is too large";
  if (sign == Sign::above_zero && *value <= 0) return "is not positive";
  if (sign == Sign::not_zero && *value == 0) return "is zero";
  if (sign == Sign::not_negative && *value < 0) return "is negative";
  return "";
}

class UrdfCheck {
 public:
  UrdfCheck(const std::filesystem::path& file, const std::string& xml) : file_(file), xml_(xml) {}

  std::map<std::string, UrdfShapeCount> run() {
    std::map<std::string, UrdfShapeCount> out;
    const auto parsed = document_.load_buffer(xml_.data(), xml_.size());
    const pugi::xml_node robot = document_.child("robot");
    if (!parsed && robot)
      fail(parsed.offset, "", std::string("is no whole XML: ") + parsed.description(), "correct it");
    for (const pugi::xml_node link : robot.children("link")) check_link(link, out[link.attribute("name").value()]);
    for (const pugi::xml_node joint : robot.children("joint")) check_joint(joint);
    return out;
  }

 private:
  [[noreturn]] void fail(std::ptrdiff_t at, const std::string& where, const std::string& what,
                         const std::string& cure) const {
    const auto end = xml_.begin() + std::clamp<std::ptrdiff_t>(at, 0, std::ssize(xml_));
    const auto line = std::count(xml_.begin(), end, '\n');
    throw InputError(at_line(file_, static_cast<int>(line) + 1) + where, what, cure);
  }
  [[noreturn]] void fail(pugi::xml_node node, const std::string& where, const std::string& what,
                         const std::string& cure) const {
    fail(node.offset_debug(), ": " + where, what, cure);
  }

  void check_link(pugi::xml_node link, UrdfShapeCount& count) const {
    const std::string where = "link " + in_quotes(link.attribute("name").value());
    for (const pugi::xml_node part : link.children()) {
      const std::string_view name = part.name();
      if (name == "visual" || name == "collision") {
        ++(name == "visual" ? count.visual : count.collision);
        check_origin(part, where + " <" + part.name() + ">");
        check_geometry(part, where + " <" + part.name() + ">");
      } else if (const std::string meant = misspelt(name, {"visual", "collision"}); !meant.empty()) {
        fail(part, where, "has an element <" + std::string(name) + ">", "write <" + meant + ">");
      }
    }
  }

  void check_origin(pugi::xml_node part, const std::string& where) const {
    for (const pugi::xml_node origin : part.children("origin"))
      for (const NumbersRule& rule : kOrigin) check_numbers(origin, rule, where + " <origin>");
  }

  void check_geometry(pugi::xml_node part, const std::string& where) const {
    const auto geometries = elements(part, "geometry");
    if (geometries.size() != 1)
      fail(part, where,
           geometries.empty() ? "has no <geometry>" : "has " + std::to_string(geometries.size()) + " <geometry>",
           "give it one, or write one " + std::string(part.name()) + " for each");
    const auto found = elements(geometries.front());
    if (found.size() != 1)
      fail(part, where, found.empty() ? "has an empty <geometry>" : "has " + std::to_string(found.size()) + " shapes",
           "give it one of box, cylinder, sphere or mesh");
    const pugi::xml_node shape = found.front();
    const auto rule =
        std::ranges::find_if(shapes(), [&](const ShapeRule& r) { return shape.name() == std::string(r.shape); });
    if (rule == shapes().end())
      fail(shape, where, "the shape <" + std::string(shape.name()) + "> is unknown",
           "give one of box, cylinder, sphere or mesh; a mesh can be any shape");
    refuse_misspelt_attributes(shape, *rule, where);
    for (const NumbersRule& numbers : rule->numbers) check_numbers(shape, numbers, where + " <" + shape.name() + ">");
    if (rule->shape == std::string_view("mesh") && *shape.attribute("filename").value() == '\0')
      fail(shape, where + " <mesh>", "has no filename", "name the mesh file");
  }

  // A scale that is misspelt would make the mesh a thousand times too large.
  void refuse_misspelt_attributes(pugi::xml_node shape, const ShapeRule& rule, const std::string& where) const {
    std::vector<std::string> known;
    for (const NumbersRule& numbers : rule.numbers) known.emplace_back(numbers.attribute);
    for (const pugi::xml_attribute attribute : shape.attributes()) {
      if (std::ranges::find(known, attribute.name()) != known.end()) continue;
      if (const std::string meant = misspelt(attribute.name(), known); !meant.empty())
        fail(shape, where + " <" + shape.name() + ">", "has an attribute " + in_quotes(attribute.name()),
             "write " + meant);
    }
  }

  void check_numbers(pugi::xml_node node, const NumbersRule& rule, const std::string& where) const {
    const pugi::xml_attribute attribute = node.attribute(rule.attribute);
    if (!attribute) {
      if (rule.required) fail(node, where, "has no " + std::string(rule.attribute), rule.cure);
      return;
    }
    const std::string shown =
        fmt::format("{}=\"{}\"", rule.attribute, std::string_view(attribute.value()).substr(0, 60));
    const auto words = words_of(attribute.value());
    for (const std::string& word : words)
      if (const std::string fault = fault_of(word, rule.sign); !fault.empty())
        fail(node, where, shown + " " + (words.size() > 1 ? "has " + in_quotes(word) + ", which " : "") + fault,
             rule.cure);
    if (words.size() != rule.count)
      fail(node, where, shown + " has " + std::to_string(words.size()) + (words.size() == 1 ? " number" : " numbers"),
           rule.cure);
  }

  void check_joint(pugi::xml_node joint) const {
    const std::string where = "joint " + in_quotes(joint.attribute("name").value());
    for (const ShapeRule& part : joint_parts())
      for (const pugi::xml_node node : joint.children(part.shape))
        for (const NumbersRule& rule : part.numbers) check_numbers(node, rule, where + " <" + part.shape + ">");
  }

  /// The one of `meant` that `name` almost is, or nothing.
  static std::string misspelt(std::string_view name, const std::vector<std::string>& meant) {
    const std::string word = lower(name);
    const std::string nearest = nearest_word(word, meant);
    return edit_distance(word, nearest) <= 2 ? nearest : "";
  }

  static std::vector<pugi::xml_node> elements(pugi::xml_node parent, const char* name = nullptr) {
    std::vector<pugi::xml_node> out;
    for (const pugi::xml_node child : parent.children())
      if (child.type() == pugi::node_element && (name == nullptr || child.name() == std::string_view(name)))
        out.push_back(child);
    return out;
  }

  const std::filesystem::path& file_;
  const std::string& xml_;
  pugi::xml_document document_;
};

}  // namespace

std::map<std::string, UrdfShapeCount> check_urdf(const std::filesystem::path& file, const std::string& xml) {
  return UrdfCheck(file, xml).run();
}

}  // namespace foresight
