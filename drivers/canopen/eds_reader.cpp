#include "drivers/canopen/eds_reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <vector>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

struct Field {
  std::string text;
  int line = 0;
};
struct Section {
  std::string name;  // as written
  int line = 0;
  std::map<std::string, Field> fields;  // keys in lower case
};

// CiA 306, 4.4: decimal, hexadecimal with 0x, octal with a leading 0. Up to 64 bits; wider is nothing.
std::optional<std::int64_t> parse_c_integer(std::string_view text) {
  const bool negative = !text.empty() && text[0] == '-';
  if (negative) text.remove_prefix(1);
  int base = 10;
  if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text[0] == '0') {
    base = 8;
    text.remove_prefix(1);
  }
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if (negative && value > std::uint64_t{1} << 63) return std::nullopt;
  return static_cast<std::int64_t>(negative ? ~value + 1 : value);
}

std::optional<unsigned> parse_hex(std::string_view text, unsigned largest) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || value > largest) return std::nullopt;
  return value;
}

class Reader {
 public:
  Reader(std::filesystem::path file, int node) : file_(std::move(file)), node_(node) {}

  ObjectDictionary read(std::string_view text) {
    split(text);
    for (const char* list : {"mandatoryobjects", "optionalobjects", "manufacturerobjects"}) read_list(list);
    if (out_.size() == 0)
      throw InputError(file_.string(), "no object is listed",
                       "give [MandatoryObjects] with SupportedObjects and 1=0x1000");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what, const std::string& cure) const {
    throw InputError(at_line(file_, line), what, cure);
  }

  void split(std::string_view text) {
    Section* section = nullptr;
    for (int line = 1; !text.empty(); ++line) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      const std::string_view content = trimmed(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
      if (content.empty() || content[0] == ';' || content[0] == '#') continue;
      if (content[0] == '[') {
        section = &open_section(content, line);
      } else if (section == nullptr) {
        fail(line, in_quotes(content) + " stands before the first section", "expected a section such as [FileInfo]");
      } else {
        add_field(*section, content, line);
      }
    }
  }

  Section& open_section(std::string_view content, int line) {
    if (content.back() != ']' || content.size() < 3)
      fail(line, "the section " + in_quotes(content) + " is not closed", "expected [name]");
    const std::string_view name = trimmed(content.substr(1, content.size() - 2));
    const auto [it, fresh] = sections_.try_emplace(lower(name), Section{std::string(name), line, {}});
    if (!fresh)
      fail(line, "section [" + std::string(name.substr(0, 60)) + "] occurs again",
           "remove it, the first is in line " + std::to_string(it->second.line));
    return it->second;
  }

  void add_field(Section& section, std::string_view content, int line) const {
    const std::size_t equals = content.find('=');
    if (equals == std::string_view::npos || equals == 0)
      fail(line, in_quotes(content) + " is neither a section nor a field", "expected Name=value");
    const std::string_view name = trimmed(content.substr(0, equals));
    const Field field{std::string(trimmed(content.substr(equals + 1))), line};
    const auto [it, fresh] = section.fields.try_emplace(lower(name), field);
    if (!fresh)
      fail(line, in_quotes(name) + " occurs again in its section",
           "remove it, the first is in line " + std::to_string(it->second.line));
  }

  const Field* field(const Section& section, const std::string& name) const {
    const auto it = section.fields.find(name);
    return it == section.fields.end() || it->second.text.empty() ? nullptr : &it->second;
  }

  std::int64_t integer(const Field& f, const char* name, std::int64_t low, std::int64_t high) const {
    const auto value = parse_c_integer(f.text);
    if (!value || *value < low || *value > high)
      fail(f.line, std::string(name) + " is " + in_quotes(f.text),
           "expected an integer from " + std::to_string(low) + " to " + std::to_string(high));
    return *value;
  }

  std::int64_t integer_or(const Section& s, const std::string& key, const char* name, std::int64_t low,
                          std::int64_t high, std::int64_t absent) const {
    const Field* f = field(s, key);
    return f ? integer(*f, name, low, high) : absent;
  }

  void read_list(const std::string& name) {
    const auto it = sections_.find(name);
    if (it == sections_.end()) return;
    const Section& list = it->second;
    const Field* count = field(list, "supportedobjects");
    if (!count)
      fail(list.line, "[" + list.name + "] has no SupportedObjects", "expected SupportedObjects=<number of objects>");
    const std::int64_t objects = integer(*count, "SupportedObjects", 0, 65535);
    for (std::int64_t i = 1; i <= objects; ++i) {
      const Field* entry = field(list, std::to_string(i));
      if (!entry)
        fail(count->line,
             "[" + list.name + "] promises " + std::to_string(objects) + " objects but has no entry " +
                 std::to_string(i),
             "expected " + std::to_string(i) + "=0x<index>");
      read_object(static_cast<std::uint16_t>(integer(*entry, "the index", 1, 0xffff)), entry->line);
    }
  }

  void read_object(std::uint16_t index, int listed) {
    const std::string name = fmt::format("{:04x}", index);
    const auto it = sections_.find(name);
    if (it == sections_.end()) fail(listed, "object " + name + " has no section", "expected a section [" + name + "]");
    const Section& object = it->second;
    const std::int64_t kind = integer_or(object, "objecttype", "ObjectType", 0, 9, 7);
    const std::int64_t subs = integer_or(object, "subnumber", "SubNumber", 0, 255, 0);
    const std::int64_t compact = integer_or(object, "compactsubobj", "CompactSubObj", 0, 254, 0);
    if (compact > 0) return expand(object, index, static_cast<int>(compact));
    if (kind != 8 && kind != 9 && kind != 6) return add(object, index, 0, listed);
    const int found = read_subs(index, name, listed);
    if (found < subs)
      fail(object.line,
           "[" + object.name + "] promises " + std::to_string(subs) + " sub-indexes but has " + std::to_string(found),
           "expected sections [" + object.name + "sub0] and so on");
  }

  int read_subs(std::uint16_t index, const std::string& name, int listed) {
    const std::string prefix = name + "sub";
    int found = 0;
    for (auto it = sections_.lower_bound(prefix); it != sections_.end() && it->first.starts_with(prefix);
         ++it, ++found) {
      const auto sub = parse_hex(std::string_view(it->first).substr(prefix.size()), 0xff);
      if (!sub)
        fail(it->second.line, in_quotes(it->second.name) + " names no sub-index",
             "expected [" + name + "sub0] to [" + name + "subFF]");
      add(it->second, index, static_cast<std::uint8_t>(*sub), listed);
    }
    return found;
  }

  // CiA 306, 4.6.3: sub-index 0 is the count, all others are alike but for their names and values.
  void expand(const Section& object, std::uint16_t index, int count) {
    ObjectEntry zero;
    zero.index = index;
    zero.name = "NrOfObjects";
    zero.type = DataType::unsigned8;
    zero.line = object.line;
    zero.default_value = ObjectValue{std::to_string(count), count, false};
    insert(zero);
    for (int sub = 1; sub <= count; ++sub) {
      ObjectEntry entry = parse(object, index, static_cast<std::uint8_t>(sub));
      if (const Field* name = compact_field(object, "name", sub)) entry.name = name->text;
      if (const Field* value = compact_field(object, "value", sub))
        entry.configured_value = parse_value(*value, entry.type, "the value");
      insert(std::move(entry));
    }
  }

  const Field* compact_field(const Section& object, const char* suffix, int sub) const {
    const auto it = sections_.find(lower(object.name) + suffix);
    return it == sections_.end() ? nullptr : field(it->second, std::to_string(sub));
  }

  void add(const Section& s, std::uint16_t index, std::uint8_t sub, int listed) {
    if (out_.find(index, sub)) fail(listed, "object " + object_name(index, sub) + " is listed again", "list it once");
    insert(parse(s, index, sub));
  }

  void insert(ObjectEntry entry) {
    const int line = entry.line;
    const std::string name = object_name(entry.index, entry.sub);
    if (!out_.add(std::move(entry))) fail(line, "object " + name + " is listed again", "list it once");
  }

  ObjectEntry parse(const Section& s, std::uint16_t index, std::uint8_t sub) const {
    ObjectEntry out;
    out.index = index;
    out.sub = sub;
    out.line = s.line;
    if (const Field* f = field(s, "parametername")) out.name = f->text;
    const bool domain = integer_or(s, "objecttype", "ObjectType", 0, 9, 7) == 2;
    const Field* type = field(s, "datatype");
    if (type) out.type = static_cast<DataType>(integer(*type, "DataType", 1, 0xffff));
    if (!type && domain) out.type = DataType::domain;
    if (out.type == DataType::none)
      fail(s.line, "[" + s.name + "] has no DataType", "expected DataType=0x0001 to 0x001B");
    out.access = parse_access(s, domain);
    out.mappable = integer_or(s, "pdomapping", "PDOMapping", 0, 1, 0) == 1;
    if (const Field* f = field(s, "defaultvalue")) out.default_value = parse_value(*f, out.type, "DefaultValue");
    if (const Field* f = field(s, "parametervalue")) out.configured_value = parse_value(*f, out.type, "ParameterValue");
    if (integer_bits(out.type) > 0) {
      if (const Field* f = field(s, "lowlimit")) out.low = parse_value(*f, out.type, "LowLimit").number;
      if (const Field* f = field(s, "highlimit")) out.high = parse_value(*f, out.type, "HighLimit").number;
    }
    if (out.low && out.high && *out.low > *out.high && (is_signed(out.type) || integer_bits(out.type) < 64))
      fail(
          s.line,
          "[" + s.name + "] has LowLimit " + std::to_string(*out.low) + " above HighLimit " + std::to_string(*out.high),
          "expected LowLimit <= HighLimit");
    return out;
  }

  Access parse_access(const Section& s, bool domain) const {
    const Field* f = field(s, "accesstype");
    if (!f && domain) return Access::read_write;  // CiA 306, table 9: the default of a domain
    if (!f) fail(s.line, "[" + s.name + "] has no AccessType", "expected AccessType=ro, wo, rw, rwr, rww or const");
    const std::string text = lower(f->text);
    if (text == "ro") return Access::read_only;
    if (text == "wo") return Access::write_only;
    if (text == "rw" || text == "rwr" || text == "rww") return Access::read_write;
    if (text == "const") return Access::constant;
    fail(f->line, "AccessType is " + in_quotes(f->text), "expected ro, wo, rw, rwr, rww or const");
  }

  ObjectValue parse_value(const Field& f, DataType type, const char* name) const {
    ObjectValue out{f.text, std::nullopt, false};
    const int bits = integer_bits(type);
    if (type == DataType::real32 || type == DataType::real64) {
      // Either the number itself or its bit pattern.
      if (!parse_number(f.text) && !parse_c_integer(f.text))
        fail(f.line, std::string(name) + " is " + in_quotes(f.text), "expected a number");
      return out;
    }
    if (bits == 0) return out;
    const auto value = evaluate(f.text, out.node_relative);
    if (!value)
      fail(f.line, std::string(name) + " is " + in_quotes(f.text),
           "expected an integer (12, 0x0C) or $NODEID+<integer>");
    // From the lowest signed to the highest unsigned pattern of that many bits.
    const bool fits = bits == 64 || (*value < std::int64_t{1} << bits &&
                                     *value >= (is_signed(type) ? -(std::int64_t{1} << (bits - 1)) : 0));
    if (!fits)
      fail(f.line, std::string(name) + " " + in_quotes(f.text) + " does not fit its data type",
           "expected an integer of " + std::to_string(bits) + " bits");
    out.number = is_signed(type) ? sign_extended(static_cast<std::uint64_t>(*value), bits) : *value;
    return out;
  }

  // "12", "$NODEID", "$NODEID+0x200" or "0x200 + $NodeID".
  std::optional<std::int64_t> evaluate(const std::string& text, bool& node_relative) const {
    constexpr std::string_view kNode = "$nodeid";
    const std::string words = lower(text);
    const std::size_t at = words.find(kNode);
    if (at == std::string::npos) return parse_c_integer(trimmed(text));
    node_relative = true;
    const std::string_view before = trimmed(std::string_view(words).substr(0, at));
    const std::string_view after = trimmed(std::string_view(words).substr(at + kNode.size()));
    if (before.empty() && after.empty()) return node_;
    std::string_view number;
    if (before.empty() && after[0] == '+') number = trimmed(after.substr(1));
    if (after.empty() && before.back() == '+') number = trimmed(before.substr(0, before.size() - 1));
    const auto offset = parse_c_integer(number);
    if (!offset || *offset > INT64_MAX - node_) return std::nullopt;
    return *offset + node_;
  }

  std::filesystem::path file_;
  int node_;
  std::map<std::string, Section> sections_;  // names in lower case
  ObjectDictionary out_;
};

}  // namespace

ObjectDictionary parse_eds(std::string_view text, const std::filesystem::path& file, int node) {
  if (node < 1 || node > kLargestNode)
    throw InputError(file.string(), "node id " + std::to_string(node) + " is asked for", "expected 1 to 127");
  return Reader(file, node).read(text);
}

ObjectDictionary read_eds(const std::filesystem::path& file, int node) {
  constexpr std::uintmax_t kLargestFile = 16 << 20;
  const std::string text = read_file(file, kLargestFile);
  return parse_eds(text, file, node);
}

}  // namespace foresight::canopen
