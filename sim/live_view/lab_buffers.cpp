#include "sim/live_view/lab_buffers.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace foresight::sim {
namespace {

struct Vertex {
  Eigen::Vector3f p, n;
  Eigen::Vector2f uv;
};
static_assert(sizeof(Vertex) == 8 * sizeof(float));

LabBuffers::Picture upload(const Material& material) {
  const Texture& from = material.picture;
  const auto base = from.level(0);
  LabBuffers::Picture out{gl::Texture(GL_RGBA8, base.width, base.height, 0, from.level_count(), "lab picture"),
                          Eigen::Vector2f(from.texels_per_metre() / static_cast<float>(base.width),
                                          from.texels_per_metre() / static_cast<float>(base.height)),
                          material.gloss};
  std::vector<std::array<std::uint8_t, 4>> texels;
  for (int k = 0; k < from.level_count(); ++k) {
    const auto level = from.level(k);
    texels.assign(level.texels.size(), {0, 0, 0, 255});
    for (std::size_t i = 0; i < texels.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        texels[i][c] = static_cast<std::uint8_t>(std::lround(255 * std::sqrt(level.texels[i][c] / 65535.0f)));
    glTextureSubImage2D(out.texture.name(), k, 0, 0, level.width, level.height, GL_RGBA, GL_UNSIGNED_BYTE,
                        texels.data());
  }
  glTextureParameteri(out.texture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glTextureParameteri(out.texture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // Texture::sample takes sharper levels, and more rays per pixel.
  glTextureParameterf(out.texture.name(), GL_TEXTURE_LOD_BIAS, -0.5f);
  for (GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTextureParameteri(out.texture.name(), side, GL_MIRRORED_REPEAT);
  return out;
}

// The triangles of one facet's grid of light samples.
void add_facet(const Facet& facet, int n, std::vector<Vertex>& vertices, std::vector<std::uint32_t>& indices) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  const auto place = [&](int i, int j) {
    return first + static_cast<std::uint32_t>(i + j * (n + 1) - j * (j - 1) / 2);
  };
  const auto& c = facet.corners;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i + j <= n; ++i) {
      const float b1 = static_cast<float>(i) / static_cast<float>(n),
                  b2 = static_cast<float>(j) / static_cast<float>(n);
      const float b0 = 1 - b1 - b2;
      vertices.push_back({b0 * c[0].p + b1 * c[1].p + b2 * c[2].p, b0 * c[0].n + b1 * c[1].n + b2 * c[2].n,
                          b0 * c[0].uv + b1 * c[1].uv + b2 * c[2].uv});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i + j < n; ++i) {
      indices.insert(indices.end(), {place(i, j), place(i + 1, j), place(i, j + 1)});
      if (i + j + 2 <= n) indices.insert(indices.end(), {place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)});
    }
}

}  // namespace

LabBuffers::LabBuffers(const Lab& lab, const LightMap& light, const LightMap::Irradiance& irradiance,
                       std::span<const Print> prints)
    : prints_(prints.begin(), prints.end()) {
  for (const Material& material : lab.materials) pictures_.push_back(upload(material));
  std::vector<Vertex> vertices;
  std::map<std::tuple<bool, int, int>, std::vector<std::uint32_t>> sorted;  // glossy, part, material
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k)
    for (const Facet& facet : lab.parts[static_cast<std::size_t>(k)].facets) {
      const bool glossy = lab.materials[static_cast<std::size_t>(facet.material)].gloss > 0;
      add_facet(facet, light.steps(facets_++), vertices, sorted[{glossy, k, facet.material}]);
    }
  std::vector<std::uint32_t> indices;
  for (const auto& [key, some] : sorted) {
    draws_.push_back({std::get<1>(key), std::get<2>(key), static_cast<GLsizei>(some.size()), indices.size()});
    indices.insert(indices.end(), some.begin(), some.end());
  }
  triangles_ = indices.size() / 3;
  vertices_ = gl::Buffer(vertices.size() * sizeof(Vertex), "lab vertices");
  vertices_.write(std::span<const Vertex>(vertices));
  light_ = gl::Buffer(vertices.size() * sizeof(Eigen::Vector3f), "lab light");
  light_anew(light, irradiance);
  indices_ = gl::Buffer(indices.size() * sizeof(std::uint32_t), "lab indices");
  indices_.write(std::span<const std::uint32_t>(indices));
}

// In the order in which add_facet() made the vertices.
void LabBuffers::light_anew(const LightMap& light, const LightMap::Irradiance& irradiance) {
  irradiance_.clear();
  for (int number = 0; number < facets_; ++number) {
    const int n = light.steps(number);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i)
        irradiance_.push_back(light.at(irradiance, number, static_cast<float>(i) / static_cast<float>(n),
                                       static_cast<float>(j) / static_cast<float>(n)));
  }
  light_.write(std::span<const Eigen::Vector3f>(irradiance_));
}

gl::VertexArray LabBuffers::create_vertex_array() const {
  gl::VertexArray array = gl::create_vertex_array("lab");
  glVertexArrayVertexBuffer(array.name(), 0, vertices_.name(), 0, sizeof(Vertex));
  glVertexArrayVertexBuffer(array.name(), 1, light_.name(), 0, sizeof(Eigen::Vector3f));
  glVertexArrayElementBuffer(array.name(), indices_.name());
  constexpr struct {
    GLint size;
    std::size_t offset;
    GLuint buffer;
  } kAttributes[] = {{3, offsetof(Vertex, p), 0}, {3, offsetof(Vertex, n), 0}, {2, offsetof(Vertex, uv), 0}, {3, 0, 1}};
  for (GLuint i = 0; i < 4; ++i) {
    glEnableVertexArrayAttrib(array.name(), i);
    glVertexArrayAttribFormat(array.name(), i, kAttributes[i].size, GL_FLOAT, GL_FALSE,
                              static_cast<GLuint>(kAttributes[i].offset));
    glVertexArrayAttribBinding(array.name(), i, kAttributes[i].buffer);
  }
  return array;
}

}  // namespace foresight::sim
