#include "link/recording/message_definitions.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <stdexcept>

#include "link/messages/message_types.hpp"

namespace foresight::link {
namespace {

/// "sequence<octet> data;" or "double k[9];".
struct Field {
  std::string type;  // of one: "octet", or a struct's name with its modules
  std::string name;
  bool sequence = false;
  std::string count;  // of an array; "" of none
  std::string label;  // of a union: "0"
};
struct Type {
  std::vector<Field> fields;
  bool is_union = false;
};
using Types = std::map<std::string, Type>;  // by name on DDS

/// Words and signs of our IDL; without comments, annotations and #include.
std::vector<std::string> tokens_of(std::string_view idl) {
  std::vector<std::string> out;
  const auto in_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  for (std::size_t at = 0; at < idl.size();) {
    if (idl.substr(at).starts_with("//") || idl[at] == '#') {
      at = std::min(idl.find('\n', at), idl.size());
    } else if (idl[at] == '@') {
      for (++at; at < idl.size() && in_word(idl[at]);) ++at;
    } else if (in_word(idl[at])) {
      std::string word;
      while (at < idl.size() && (in_word(idl[at]) || idl.substr(at).starts_with("::"))) {
        const std::size_t length = in_word(idl[at]) ? 1 : 2;
        word += idl.substr(at, length);
        at += length;
      }
      out.push_back(std::move(word));
    } else {
      if (!std::isspace(static_cast<unsigned char>(idl[at]))) out.emplace_back(1, idl[at]);
      ++at;
    }
  }
  return out;
}

/// Reads the IDL that is written here: modules, structs, unions that switch by a number; no other.
class IdlReader {
 public:
  IdlReader(std::string_view idl, Types& out) : tokens_(tokens_of(idl)), types_(out) {
    while (at_ < tokens_.size()) declaration("");
  }

 private:
  const std::string& peek() const {
    if (at_ >= tokens_.size()) throw std::logic_error("IDL ends too early");
    return tokens_[at_];
  }
  std::string next() {
    const std::string out = peek();
    ++at_;
    return out;
  }
  void expect(const std::string& token) {
    if (next() != token) throw std::logic_error("IDL: no " + token + " before token " + std::to_string(at_));
  }

  void declaration(const std::string& scope) {
    const std::string kind = next(), name = scope + next();
    if (kind == "module") {
      expect("{");
      while (peek() != "}") declaration(name + "::");
    } else if (kind == "struct") {
      expect("{");
      while (peek() != "}") types_[name].fields.push_back(field(scope));
    } else if (kind == "union") {
      types_[name].is_union = true;
      for (const char* token : {"switch", "(", "long", ")", "{"}) expect(token);
      while (peek() != "}") {
        expect("case");
        const std::string label = next();
        expect(":");
        types_[name].fields.push_back(field(scope));
        types_[name].fields.back().label = label;
      }
    } else {
      throw std::logic_error("IDL: " + kind + " is not known here");
    }
    expect("}");
    expect(";");
  }

  Field field(const std::string& scope) {
    Field out;
    if (peek() == "sequence") {
      next();
      expect("<");
      out.sequence = true;
    }
    out.type = type(scope);
    if (out.sequence) expect(">");
    out.name = next();
    if (peek() == "[") {
      next();
      out.count = next();
      expect("]");
    }
    expect(";");
    return out;
  }

  std::string type(const std::string& scope) {
    std::string out = next();
    while (peek() == "long") out += " " + next();
    if (out == "unsigned") out += " " + next();
    return types_.contains(scope + out) ? scope + out : out;
  }

  std::vector<std::string> tokens_;
  std::size_t at_ = 0;
  Types& types_;
};

const Types& types() {
  static const Types all = [] {
    Types out;
    for (const char* text : detail::idl_texts()) IdlReader(text, out);
    return out;
  }();
  return all;
}

/// The type, and all that are in it, each once, those before that others need.
void gather(const std::string& name, std::vector<std::string>& out) {
  const auto found = types().find(name);
  if (found == types().end() || std::ranges::find(out, name) != out.end()) return;
  for (const Field& field : found->second.fields) gather(field.type, out);
  out.push_back(name);
}

/// "geometry_msgs/Pose", as .msg files call it.
std::string short_name(const std::string& dds_type) {
  std::string out = ros_name(dds_type);
  const std::size_t middle = out.find("/msg/");
  return middle == out.npos ? out : out.erase(middle, 4);
}

std::string ros_field(const Field& field) {
  static const std::map<std::string, std::string> names{
      {"boolean", "bool"},    {"octet", "uint8"},           {"long", "int32"},     {"unsigned long", "uint32"},
      {"long long", "int64"}, {"float", "float32"},         {"double", "float64"}, {"unsigned long long", "uint64"},
      {"short", "int16"},     {"unsigned short", "uint16"}, {"string", "string"}};
  const auto plain = names.find(field.type);
  std::string out = plain == names.end() ? short_name(field.type) : plain->second;
  if (field.sequence) out += "[]";
  if (!field.count.empty()) out += "[" + field.count + "]";
  const bool escaped = field.name.starts_with('_');  // IDL's way to say that it is no keyword
  return out + " " + field.name.substr(escaped ? 1 : 0) + "\n";
}

std::string ros_text(const std::vector<std::string>& gathered) {
  std::string out;
  for (auto name = gathered.rbegin(); name != gathered.rend(); ++name) {
    if (name != gathered.rbegin()) out.append(80, '=').append("\nMSG: ").append(short_name(*name)).append("\n");
    for (const Field& field : types().at(*name).fields) out += ros_field(field);
  }
  return out;
}

std::string idl_text(const std::vector<std::string>& gathered) {
  std::string out;
  for (const std::string& name : gathered) {
    std::string end;
    std::size_t begin = 0;
    for (std::size_t at = name.find("::"); at != name.npos; at = name.find("::", begin)) {
      out += "module " + name.substr(begin, at - begin) + " { ";
      end += " };";
      begin = at + 2;
    }
    const Type& type = types().at(name);
    out += std::string("@final ") + (type.is_union ? "union " : "struct ") + name.substr(begin) +
           (type.is_union ? " switch (long) {\n" : " {\n");
    for (const Field& field : type.fields) {
      if (type.is_union) out += "  case " + field.label + ":";
      out += "  " + (field.sequence ? "sequence<" + field.type + ">" : field.type) + " " + field.name +
             (field.count.empty() ? "" : "[" + field.count + "]") + ";\n";
    }
    out += "};" + end + "\n";
  }
  return out;
}

}  // namespace

MessageDefinition message_definition(std::string_view dds_type) {
  std::vector<std::string> gathered;
  gather(std::string(dds_type), gathered);
  if (gathered.empty()) return {ros_name(dds_type), "", ""};
  const bool unions = std::ranges::any_of(gathered, [](const std::string& name) { return types().at(name).is_union; });
  // In OMG's own IDL, the name is the type's there, too.
  if (unions) return {std::string(dds_type), "omgidl", idl_text(gathered)};
  return {ros_name(dds_type), "ros2msg", ros_text(gathered)};
}

}  // namespace foresight::link
