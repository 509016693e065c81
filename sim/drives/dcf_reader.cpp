#include "sim/drives/dcf_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <optional>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"

namespace foresight::sim {
namespace {

constexpr std::size_t kLargestFile = 1 << 20, kMostObjects = 20'000;

struct Field {
  std::string value;
  int line = 0;
};

// One [section] of the file: fields by their name in small letters.
struct Section {
  int line = 0;
  std::map<std::string, Field> fields;
};

// The key of "1018sub1", "1018" (whose sub-index is 0); nothing where the section describes no object.
std::optional<std::uint32_t> section_key(const std::string& name, bool& has_sub) {
  const auto hex = [](std::string_view digits) -> std::optional<unsigned> {
    unsigned value = 0;
    const auto end = digits.data() + digits.size();
    const auto [rest, error] = std::from_chars(digits.data(), end, value, 16);
    if (digits.empty() || error != std::errc() || rest != end) return std::nullopt;
    return value;
  };
  const std::size_t at = name.find("sub");
  has_sub = at != std::string::npos;
  const auto index = name.substr(0, at).size() == 4 ? hex(name.substr(0, at)) : std::nullopt;
  const auto sub = has_sub ? hex(name.substr(at + 3)) : std::optional<unsigned>(0);
  if (!index || !sub || *sub > 0xff) return std::nullopt;
  return object_key(*index, *sub);
}

// CiA 306-1, 4.5.2.2: decimal, hexadecimal with 0x, octal with a leading 0; any of them next to "$NODEID +".
std::optional<std::int64_t> parse_value(std::string_view text, int node) {
  std::string compact;
  for (char c : lower(text))
    if (c != ' ' && c != '\t') compact += c;
  std::int64_t base = 0;
  if (const std::size_t at = compact.find("$nodeid"); at != std::string::npos) {
    base = node;
    compact.erase(at, 7);
    if (compact.empty()) return base;
    if (compact.front() == '+')
      compact.erase(0, 1);
    else if (compact.back() == '+')
      compact.pop_back();
    else
      return std::nullopt;
  }
  const bool negative = compact.starts_with('-');
  if (negative) compact.erase(0, 1);
  const int radix = compact.starts_with("0x") ? 16 : compact.size() > 1 && compact.front() == '0' ? 8 : 10;
  const char* const first = compact.data() + (radix == 16 ? 2 : 0);
  const char* const end = compact.data() + compact.size();
  std::uint64_t value = 0;
  const auto [rest, error] = std::from_chars(first, end, value, radix);
  if (first == end || error != std::errc() || rest != end) return std::nullopt;
  const std::uint64_t magnitude = value + static_cast<std::uint64_t>(negative ? -base : base);
  return static_cast<std::int64_t>(negative ? 0 - magnitude : magnitude);
}

bool fits(std::int64_t value, DataType type) {
  const std::size_t bits = 8 * size_of(type);
  if (bits == 0 || bits == 64) return true;
  // Both readings of a bit pattern are seen in the field: 0xFFFF as the default of an int16.
  return value >= -(std::int64_t{1} << (bits - 1)) && value < std::int64_t{1} << bits;
}

class Reader {
 public:
  Reader(std::filesystem::path name, int node) : name_(std::move(name)), node_(node) {}
  ObjectDictionary read(std::string_view text);

 private:
  void take_line(std::string_view line, int number);
  [[noreturn]] void fail(int line, const std::string& what, const std::string& cure) const {
    throw InputError(at_line(name_, line), what, cure);
  }
  const Field* field(const Section& section, const std::string& key) const;
  std::optional<std::int64_t> number(const Section& section, const std::string& key) const;
  void add(const Section& section, std::uint32_t key, bool has_sub);
  void add_compact(const Section& section, std::uint32_t key, std::int64_t count);
  ObjectEntry entry(const Section& section) const;
  void set_value(const Section& section, ObjectEntry& entry) const;

  std::filesystem::path name_;
  int node_;
  std::map<std::string, Section> sections_;
  Section* current_ = nullptr;
  ObjectDictionary dictionary_;
};

void Reader::take_line(std::string_view line, int number) {
  line = trimmed(line);
  if (line.empty() || line.front() == ';' || line.front() == '#') return;
  if (line.front() == '[') {
    const std::size_t end = line.find(']');
    if (end == std::string_view::npos) fail(number, in_quotes(line) + " is no section", "close it with ]");
    const auto [place, fresh] = sections_.try_emplace(lower(trimmed(line.substr(1, end - 1))));
    if (!fresh) fail(number, "section " + in_quotes(line) + " is given twice", "keep one of them");
    place->second.line = number;
    current_ = &place->second;
    return;
  }
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || current_ == nullptr)
    fail(number, in_quotes(line) + " is neither a section nor a key in one", "write it as KEY=VALUE below a [section]");
  current_->fields[lower(trimmed(line.substr(0, equals)))] = {std::string(trimmed(line.substr(equals + 1))), number};
}

const Field* Reader::field(const Section& section, const std::string& key) const {
  const auto found = section.fields.find(key);
  return found == section.fields.end() || found->second.value.empty() ? nullptr : &found->second;
}

std::optional<std::int64_t> Reader::number(const Section& section, const std::string& key) const {
  const Field* const text = field(section, key);
  if (text == nullptr) return std::nullopt;
  const auto value = parse_value(text->value, node_);
  if (!value) fail(text->line, in_quotes(text->value) + " is not an integer", "write it as 16, 0x10 or $NODEID+0x10");
  return value;
}

ObjectEntry Reader::entry(const Section& section) const {
  ObjectEntry out;
  const auto type = number(section, "datatype");
  if (!type) fail(section.line, "the object has no DataType", "name it, such as DataType=0x0007");
  constexpr std::array known{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 15, 17, 21, 27};
  if (std::find(known.begin(), known.end(), *type) == known.end())
    fail(section.line, "data type " + std::to_string(*type) + " is not known here", "use one of CiA 301, table 44");
  out.type = static_cast<DataType>(*type);
  if (const Field* const access = field(section, "accesstype")) {
    constexpr std::array<std::string_view, 6> names{"ro", "wo", "rw", "rwr", "rww", "const"};
    const auto found = std::find(names.begin(), names.end(), lower(access->value));
    if (found == names.end())
      fail(access->line, in_quotes(access->value) + " is no access type", "use ro, wo, rw, rwr, rww or const");
    out.access = static_cast<Access>(found - names.begin());
  }
  out.mappable = number(section, "pdomapping").value_or(0) != 0;
  if (size_of(out.type) != 0 && out.type != DataType::real32 && out.type != DataType::real64) {
    out.low = number(section, "lowlimit");
    out.high = number(section, "highlimit");
    if (out.low && out.high && *out.low > *out.high) out.low = out.high = std::nullopt;
  }
  set_value(section, out);
  return out;
}

void Reader::set_value(const Section& section, ObjectEntry& entry) const {
  const bool configured = field(section, "parametervalue") != nullptr;
  const std::string key = configured ? "parametervalue" : "defaultvalue";
  const Field* const text = field(section, key);
  entry.value.assign(size_of(entry.type), 0);
  if (text == nullptr || entry.type == DataType::domain) return;
  if (entry.type == DataType::real32 || entry.type == DataType::real64) {
    const auto real = parse_number(text->value);
    if (!real) fail(text->line, in_quotes(text->value) + " is not a number", "write it as 1.5");
    const bool single = entry.type == DataType::real32;
    encode_integer(single ? static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(static_cast<float>(*real)))
                          : std::bit_cast<std::int64_t>(*real),
                   entry.value);
  } else if (size_of(entry.type) == 0) {
    entry.value.assign(text->value.begin(), text->value.end());
  } else {
    const std::int64_t value = *number(section, key);
    if (!fits(value, entry.type)) fail(text->line, in_quotes(text->value) + " does not fit its DataType", "correct it");
    encode_integer(value, entry.value);
  }
}

// CiA 306-1, 4.5.2.4: an array whose elements are all like its own section.
void Reader::add_compact(const Section& section, std::uint32_t key, std::int64_t count) {
  if (count < 1 || count > 0xfe)
    fail(section.line, "CompactSubObj is " + std::to_string(count), "use a value from 1 to 254");
  dictionary_.define(key, DataType::uint8, Access::ro, count);
  const ObjectEntry like = entry(section);
  for (unsigned sub = 1; sub <= count; ++sub) dictionary_.entries()[key + sub] = like;
}

void Reader::add(const Section& section, std::uint32_t key, bool has_sub) {
  const auto kind = number(section, "objecttype").value_or(7);
  const auto compact = number(section, "compactsubobj").value_or(0);
  const bool variable = kind == 7 || kind == 2;  // VAR, DOMAIN; else an array or a record, told by its parts
  if (has_sub || variable)
    dictionary_.entries()[key] = entry(section);
  else if (compact != 0)
    add_compact(section, key, compact);
  if (dictionary_.entries().size() > kMostObjects)
    fail(section.line, "there are more than 20000 objects", "use the dictionary of one device");
}

ObjectDictionary Reader::read(std::string_view text) {
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    take_line(text.substr(0, end), ++number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  for (const auto& [name, section] : sections_) {
    bool has_sub = false;
    if (const auto key = section_key(name, has_sub)) add(section, *key, has_sub);
  }
  if (dictionary_.entries().empty())
    fail(1, "no objects in it", "give an EDS or DCF file, with sections such as [1000]");
  return std::move(dictionary_);
}

}  // namespace

ObjectDictionary parse_dcf(std::string_view text, int node, const std::filesystem::path& name) {
  return Reader(name, node).read(text);
}

ObjectDictionary read_dcf(const std::filesystem::path& file, int node) {
  return parse_dcf(read_file(file, kLargestFile), node, file);
}

}  // namespace foresight::sim
