// The header of a PLY file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foresight::ply {

enum class Format { ascii, little_endian, big_endian };
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(Type type);
inline bool is_float(Type type) {
  return type == Type::float32 || type == Type::float64;
}

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count;  ///< of a list: type of the number in front of it
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  std::optional<std::size_t> find(std::string_view property) const;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;  ///< in the order of the data
  std::size_t size = 0;           ///< bytes up to the data
  int lines = 0;
};

/// Throws InputError naming file and line.
Header read_header(const std::filesystem::path& file, std::string_view content);

}  // namespace foresight::ply
