#include "gl/lens_rays.hpp"

#include <vector>

namespace foresight::gl {

Texture make_lens_rays(const Lens& lens) {
  if (!lens.has_distortion()) return Texture(GL_RGBA32F, 1, 1, 0, 1, "lens rays (none)");
  Texture rays(GL_RGBA32F, lens.width(), lens.height(), 0, 1, "lens rays");
  std::vector<Eigen::Vector4f> row(static_cast<std::size_t>(lens.width()));
  for (int y = 0; y < lens.height(); ++y) {
    for (int x = 0; x < lens.width(); ++x) {
      const auto ray = lens.unproject({x, y});
      row[static_cast<std::size_t>(x)] =
          ray ? Eigen::Vector4f(static_cast<float>(ray->x()), static_cast<float>(ray->y()),
                                static_cast<float>(ray->z()), 1)
              : Eigen::Vector4f::Zero();  // no ray: the lens does not see anything here
    }
    glTextureSubImage2D(rays.name(), 0, 0, y, lens.width(), 1, GL_RGBA, GL_FLOAT, row.data());
  }
  return rays;
}

}  // namespace foresight::gl
