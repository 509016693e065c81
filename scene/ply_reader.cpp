#include "scene/ply_reader.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/ply_header.hpp"

namespace foresight {
namespace {

using ply::Element, ply::Format, ply::Header, ply::Property, ply::Type;

template <typename T>
double decode(const char* bytes, bool swap) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swap) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<T>(raw));
}

// Integers of up to 32 bits and floats are all exact as doubles.
double decode(Type type, const char* bytes, bool swap) {
  switch (type) {
    case Type::int8: return decode<std::int8_t>(bytes, swap);
    case Type::uint8: return decode<std::uint8_t>(bytes, swap);
    case Type::int16: return decode<std::int16_t>(bytes, swap);
    case Type::uint16: return decode<std::uint16_t>(bytes, swap);
    case Type::int32: return decode<std::int32_t>(bytes, swap);
    case Type::uint32: return decode<std::uint32_t>(bytes, swap);
    case Type::float32: return decode<float>(bytes, swap);
    case Type::float64: return decode<double>(bytes, swap);
  }
  return 0;
}

class BodyReader {
 public:
  BodyReader(const std::filesystem::path& file, std::string_view content)
      : file_(file),
        header_(ply::read_header(file, content)),
        rest_(content.substr(header_.size)),
        line_(header_.lines + 1) {}

  Mesh read() {
    for (const Element& element : header_.elements) read_element(element);
    return build();
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& cure) const {
    const bool ascii = header_.format == Format::ascii;
    throw InputError(ascii ? at_line(file_, line_) : file_.string(), item_ + what, cure);
  }
  [[noreturn]] void fail_truncated() const {
    fail("the file ends before the data that its header announces", "copy or export the mesh again, it is truncated");
  }

  // Fewest bytes that a value can take; lets a header with absurd counts fail before anything
  // of that size is allocated.
  std::size_t smallest(Type type) const { return header_.format == Format::ascii ? 2 : ply::size_of(type); }

  void require_left(std::uint64_t count, std::size_t bytes_each) const {
    // The last value of an ascii file needs no separator behind it.
    if (bytes_each > 0 && count > (rest_.size() + 1) / bytes_each) fail_truncated();
  }

  void read_element(const Element& element) {
    std::size_t bytes = 0;
    for (const Property& p : element.properties) bytes += smallest(p.count.value_or(p.type));
    if (bytes == 0) return;  // nothing is stored
    item_ = element.name + ": ";
    require_left(element.count, bytes);
    const bool vertices = element.name == "vertex", faces = element.name == "face";
    if (vertices) begin_vertices(element);
    if (faces) begin_faces(element);
    std::vector<double> values(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      item_ = element.name + " " + std::to_string(i) + ": ";
      for (std::size_t k = 0; k < values.size(); ++k) {
        const Property& property = element.properties[k];
        if (property.count)
          read_list(property, faces && k == index_list_);
        else
          values[k] = next(property.type);
      }
      if (vertices) add_vertex(values);
    }
    item_.clear();
  }

  void begin_vertices(const Element& element) {
    constexpr const char* kNames[] = {"x", "y", "z"};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = element.find(kNames[k]);
      if (!at || element.properties[*at].count)
        fail(std::string("has no property ") + kNames[k], "export the vertices with x, y and z");
      xyz_[k] = *at;
    }
    if (element.count >= std::numeric_limits<std::uint32_t>::max()) fail("too many vertices", "reduce the mesh");
    vertices_.reserve(element.count);
  }

  void begin_faces(const Element& element) {
    auto at = element.find("vertex_indices");
    if (!at) at = element.find("vertex_index");
    if (!at || !element.properties[*at].count || ply::is_float(element.properties[*at].type))
      fail("has no list of integers vertex_indices", "export the faces with vertex_indices");
    index_list_ = *at;
  }

  void add_vertex(const std::vector<double>& values) {
    const Eigen::Vector3f v = Eigen::Vector3d(values[xyz_[0]], values[xyz_[1]], values[xyz_[2]]).cast<float>();
    if (!v.allFinite()) fail("a coordinate is not finite", "remove the vertex or repair the mesh");
    vertices_.push_back(v);
  }

  void read_list(const Property& property, bool keep) {
    const double count = next(*property.count);
    if (count < 0) fail("a list has a negative length", "export the mesh again, the file is damaged");
    const auto n = static_cast<std::uint64_t>(count);
    require_left(n, smallest(property.type));
    if (keep) face_sizes_.push_back(static_cast<std::uint32_t>(n));
    for (std::uint64_t i = 0; i < n; ++i) {
      const double value = next(property.type);
      if (keep) indices_.push_back(static_cast<std::int64_t>(value));
    }
  }

  double next(Type type) { return header_.format == Format::ascii ? next_word(type) : next_bytes(type); }

  double next_bytes(Type type) {
    const std::size_t size = ply::size_of(type);
    if (rest_.size() < size) fail_truncated();
    const bool swap = (header_.format == Format::big_endian) != (std::endian::native == std::endian::big);
    const double value = decode(type, rest_.data(), swap);
    rest_.remove_prefix(size);
    return value;
  }

  double next_word(Type type) {
    std::size_t begin = 0;
    for (; begin < rest_.size() && is_blank(rest_[begin]); ++begin) line_ += rest_[begin] == '\n';
    std::size_t end = begin;
    while (end < rest_.size() && !is_blank(rest_[end])) ++end;
    if (begin == end) fail_truncated();
    const std::string_view word = rest_.substr(begin, end - begin);
    const auto value = parse_number(word);
    const bool integer =
        value && std::abs(*value) <= std::numeric_limits<std::uint32_t>::max() && *value == std::floor(*value);
    if (!value || (!ply::is_float(type) && !integer))
      fail(in_quotes(word) + " is not " + (ply::is_float(type) ? "a number" : "an integer"), "correct the line");
    rest_.remove_prefix(end);
    return *value;
  }

  static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

  Mesh build() {
    if (face_sizes_.empty())
      throw InputError(file_.string(), "has no faces",
                       "export a triangle mesh; a point cloud or triangle strips cannot be textured");
    MeshBuilder builder;
    std::vector<Eigen::Vector3f> corners;
    std::size_t at = 0;
    for (std::size_t face = 0; face < face_sizes_.size(); ++face) {
      corners.clear();
      for (std::uint32_t k = 0; k < face_sizes_[face]; ++k) {
        const std::int64_t index = indices_[at++];
        if (index < 0 || index >= static_cast<std::int64_t>(vertices_.size()))
          throw InputError(file_.string(),
                           "face " + std::to_string(face) + ": vertex index " + std::to_string(index) +
                               " is out of range, there are " + std::to_string(vertices_.size()) + " vertices",
                           "export the mesh again, the file is damaged");
        corners.push_back(vertices_[static_cast<std::size_t>(index)]);
      }
      builder.add(corners);
    }
    return std::move(builder).take();
  }

  const std::filesystem::path& file_;
  const Header header_;
  std::string_view rest_;
  int line_;
  std::string item_;  // "vertex 17: ", for messages

  std::array<std::size_t, 3> xyz_{};  // places of x, y, z among a vertex's properties
  std::size_t index_list_ = 0;        // place of vertex_indices among a face's properties
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<std::uint32_t> face_sizes_;
  std::vector<std::int64_t> indices_;
};

}  // namespace

Mesh read_ply(const std::filesystem::path& file) {
  const std::string content = read_file(file, kLargestMesh);
  return BodyReader(file, content).read();
}

}  // namespace foresight
