#include "scene/gltf_writer.hpp"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace foresight {
namespace {

using nlohmann::json;

// Numbers of the glTF and OpenGL specifications.
constexpr int kFloat = 5126, kUnsignedInt = 5125;
constexpr int kVertices = 34962, kIndices = 34963;
constexpr int kLinear = 9729, kTrilinear = 9987, kClampToEdge = 33071;

/// Collects binary data and the views of it.
class Binary {
 public:
  /// Index of the view. `target` 0: neither vertices nor indices.
  std::size_t add(const void* data, std::size_t size, int target) {
    json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target) view["target"] = target;
    bytes_.append(static_cast<const char*>(data), size);
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');  // what follows may hold floats
    views_.push_back(std::move(view));
    return views_.size() - 1;
  }
  const json& views() const { return views_; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  json views_ = json::array();
};

template <typename T>
std::size_t add_accessor(json& gltf, Binary& binary, const std::vector<T>& items, int target, const char* type,
                         std::size_t count) {
  const std::size_t view = binary.add(items.data(), items.size() * sizeof(T), target);
  gltf["accessors"].push_back({{"bufferView", view},
                               {"componentType", target == kIndices ? kUnsignedInt : kFloat},
                               {"count", count},
                               {"type", type}});
  return gltf["accessors"].size() - 1;
}

json mesh_of(const GltfNode& node, json& gltf, Binary& binary) {
  const std::size_t positions = add_accessor(gltf, binary, node.vertices, kVertices, "VEC3", node.vertices.size());
  Eigen::Vector3f lower = node.vertices.front(), upper = lower;
  for (const Eigen::Vector3f& v : node.vertices) {
    lower = lower.cwiseMin(v);
    upper = upper.cwiseMax(v);
  }
  gltf["accessors"][positions]["min"] = {lower.x(), lower.y(), lower.z()};
  gltf["accessors"][positions]["max"] = {upper.x(), upper.y(), upper.z()};
  const std::size_t texcoords = add_accessor(gltf, binary, node.texcoords, kVertices, "VEC2", node.texcoords.size());
  const std::size_t indices = add_accessor(gltf, binary, node.triangles, kIndices, "SCALAR", 3 * node.triangles.size());
  const json primitive{
      {"attributes", {{"POSITION", positions}, {"TEXCOORD_0", texcoords}}}, {"indices", indices}, {"material", 0}};
  return {{"name", node.name}, {"primitives", json::array({primitive})}};
}

void add_material(json& gltf) {
  const json sampler{
      {"magFilter", kLinear}, {"minFilter", kTrilinear}, {"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}};
  const json texture{{"sampler", 0}, {"source", 0}};
  const json surface{{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
  const json material{{"name", "camera images"},
                      {"pbrMetallicRoughness", surface},
                      {"doubleSided", true},
                      {"extensions", {{"KHR_materials_unlit", json::object()}}}};
  gltf["extensionsUsed"] = json::array({"KHR_materials_unlit"});
  gltf["samplers"] = json::array({sampler});
  gltf["textures"] = json::array({texture});
  gltf["materials"] = json::array({material});
}

void add_nodes(const GltfModel& model, json& gltf, Binary& binary) {
  const double half = std::sqrt(0.5);  // a quarter turn back about x: (x, y, z) to (x, z, -y)
  json children = json::array();
  gltf["nodes"].push_back({{"name", "world, z up"}, {"rotation", {-half, 0, 0, half}}});
  for (const GltfNode& node : model.nodes) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(node.T_world_node.linear()).normalized();
    const Eigen::Vector3d t = node.T_world_node.translation();
    json out{{"name", node.name}, {"translation", {t.x(), t.y(), t.z()}}, {"rotation", {q.x(), q.y(), q.z(), q.w()}}};
    if (!node.triangles.empty()) {
      gltf["meshes"].push_back(mesh_of(node, gltf, binary));
      out["mesh"] = gltf["meshes"].size() - 1;
    }
    children.push_back(gltf["nodes"].size());
    gltf["nodes"].push_back(std::move(out));
  }
  gltf["nodes"][0]["children"] = std::move(children);
  gltf["scene"] = 0;
  gltf["scenes"].push_back({{"nodes", json::array({0})}});
}

/// All but the image and the buffer.
json describe(const GltfModel& model, Binary& binary) {
  json gltf{{"asset", {{"version", "2.0"}, {"generator", model.generator}}}};
  add_material(gltf);
  add_nodes(model, gltf, binary);
  return gltf;
}

/// Names come from files of the user and may hold any bytes.
std::string text_of(const json& gltf) {
  return gltf.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// A file name as a relative URI reference (RFC 3986).
std::string as_uri(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || std::strchr("-._~", c)) {
      out += c;
    } else {
      constexpr const char* kHex = "0123456789ABCDEF";
      out += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return out;
}

void append_word(std::string& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 255);
}

void append_chunk(std::string& bytes, std::string data, const char* type, char padding) {
  data.resize((data.size() + 3) / 4 * 4, padding);
  append_word(bytes, data.size());
  bytes.append(type, 4);
  bytes += data;
}

}  // namespace

std::string to_glb(const GltfModel& model) {
  Binary binary;
  json gltf = describe(model, binary);
  gltf["images"].push_back(
      {{"mimeType", "image/png"}, {"bufferView", binary.add(model.png.data(), model.png.size(), 0)}});
  gltf["bufferViews"] = binary.views();
  gltf["buffers"].push_back({{"byteLength", binary.bytes().size()}});
  std::string chunks;
  append_chunk(chunks, text_of(gltf), "JSON", ' ');
  append_chunk(chunks, binary.bytes(), "BIN\0", '\0');
  std::string out = "glTF";
  append_word(out, 2);
  append_word(out, 12 + chunks.size());
  return out + chunks;
}

GltfFiles to_gltf(const GltfModel& model, const std::string& bin_name, const std::string& png_name) {
  Binary binary;
  json gltf = describe(model, binary);
  gltf["images"].push_back({{"uri", as_uri(png_name)}});
  gltf["bufferViews"] = binary.views();
  gltf["buffers"].push_back({{"uri", as_uri(bin_name)}, {"byteLength", binary.bytes().size()}});
  return {text_of(gltf), binary.bytes()};
}

}  // namespace foresight
