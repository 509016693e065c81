#include "sim/live_view/lab_buffers.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace foresight::sim {
namespace {

struct Vertex {
  Eigen::Vector3f p, n;
  Eigen::Vector2f uv;
  std::int32_t first, steps;  // of its facet's light
};
static_assert(sizeof(Vertex) == 10 * sizeof(float));

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

}  // namespace

LabBuffers::LabBuffers(const Lab& lab, const LightMap& light, const LightMap::Irradiance& irradiance,
                       std::span<const Print> prints)
    : prints_(prints.begin(), prints.end()) {
  for (const Material& material : lab.materials) pictures_.push_back(upload(material));
  std::map<std::tuple<bool, int, int>, std::vector<Vertex>> sorted;  // glossy, part, material
  std::int32_t first = 0;
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k)
    for (const Facet& facet : lab.parts[static_cast<std::size_t>(k)].facets) {
      const int n = light.steps(facets_++);
      const bool glossy = lab.materials[static_cast<std::size_t>(facet.material)].gloss > 0;
      for (const auto& corner : facet.corners)
        sorted[{glossy, k, facet.material}].push_back({corner.p, corner.n, corner.uv, first, n});
      first += (n + 1) * (n + 2) / 2;
    }
  std::vector<Vertex> vertices;
  for (const auto& [key, some] : sorted) {
    draws_.push_back(
        {std::get<1>(key), std::get<2>(key), static_cast<GLint>(vertices.size()), static_cast<GLsizei>(some.size())});
    vertices.insert(vertices.end(), some.begin(), some.end());
  }
  vertices_ = gl::Buffer(vertices.size() * sizeof(Vertex), "lab vertices");
  vertices_.write(std::span<const Vertex>(vertices));
  light_ = gl::BufferTexture(GL_RGB32F, static_cast<std::size_t>(first) * sizeof(Eigen::Vector3f), "lab light");
  light_anew(light, irradiance);
}

// Grids as live.frag reads them: one facet after the other, row by row.
void LabBuffers::light_anew(const LightMap& light, const LightMap::Irradiance& irradiance) {
  irradiance_.clear();
  for (int number = 0; number < facets_; ++number) {
    const int n = light.steps(number);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i)
        irradiance_.push_back(light.at(irradiance, number, static_cast<float>(i) / static_cast<float>(n),
                                       static_cast<float>(j) / static_cast<float>(n)));
  }
  light_.buffer().write(std::span<const Eigen::Vector3f>(irradiance_));
}

gl::VertexArray LabBuffers::create_vertex_array() const {
  gl::VertexArray array = gl::create_vertex_array("lab");
  glVertexArrayVertexBuffer(array.name(), 0, vertices_.name(), 0, sizeof(Vertex));
  constexpr struct {
    GLint size;
    std::size_t offset;
  } kPlaces[] = {{3, offsetof(Vertex, p)}, {3, offsetof(Vertex, n)}, {2, offsetof(Vertex, uv)}};
  for (GLuint i = 0; i < 4; ++i) {
    glEnableVertexArrayAttrib(array.name(), i);
    glVertexArrayAttribBinding(array.name(), i, 0);
    if (i < 3)
      glVertexArrayAttribFormat(array.name(), i, kPlaces[i].size, GL_FLOAT, GL_FALSE,
                                static_cast<GLuint>(kPlaces[i].offset));
    else
      glVertexArrayAttribIFormat(array.name(), i, 2, GL_INT, offsetof(Vertex, first));
  }
  return array;
}

}  // namespace foresight::sim
