// The lab in GPU memory, and the light on it.
#pragma once

#include <vector>

#include "gl/objects.hpp"
#include "sim/light_map.hpp"
#include "sim/live_view/print_pass.hpp"

namespace foresight::sim {

/// The lab's facets, each with a grid of light samples that its pixels look up; the materials' pictures with mipmaps.
/// The light is that of one state of the lab, until it is lit anew: parts that move carry it along, and their shadows
/// stay where they were. Usable from every context of the share group.
class LabBuffers {
 public:
  struct Draw {
    int part = 0, material = 0;
    GLint first = 0;  ///< vertex; three make a facet
    GLsizei count = 0;
  };
  struct Picture {
    gl::Texture texture;              ///< square roots of linear light, mirrored outside
    Eigen::Vector2f per_metre{0, 0};  ///< pictures per metre
    float gloss = 0;
  };

  LabBuffers(const Lab& lab, const LightMap& light, const LightMap::Irradiance& irradiance,
             std::span<const Print> prints = {});

  /// The light of another state, for what is drawn from now on.
  void light_anew(const LightMap& light, const LightMap::Irradiance& irradiance);

  const std::vector<Draw>& draws() const { return draws_; }  ///< ordered by gloss, then by part
  const Picture& picture(int material) const { return pictures_[static_cast<std::size_t>(material)]; }
  const std::vector<PrintPicture>& prints() const { return prints_; }
  /// A samplerBuffer: the irradiance on each facet's grid, row by row, as sim/light_map.hpp draws it.
  GLuint light() const { return light_.texture(); }

  /// Of the current context: attributes 0 place, 1 normal, 2 place on the picture (metres), 3 where in light() the
  /// facet's grid begins, and how many steps it has (integers).
  gl::VertexArray create_vertex_array() const;

 private:
  std::vector<Picture> pictures_;
  std::vector<PrintPicture> prints_;
  std::vector<Draw> draws_;
  gl::Buffer vertices_;
  gl::BufferTexture light_;
  std::vector<Eigen::Vector3f> irradiance_;  // as light_
  int facets_ = 0;
};

}  // namespace foresight::sim
