#include "display/view_range.hpp"

#include <cmath>

namespace foresight {

ViewRange::ViewRange(const Lens& lens, const gl::Faces& faces) : width_(lens.width()), height_(lens.height()) {
  lookups_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int v = 0; v < height_; ++v)
    for (int u = 0; u < width_; ++u) {
      Lookup lookup{0, 0};
      const auto ray = lens.unproject({u, v});
      for (int face = 0; ray && face < faces.count; ++face) {
        const Eigen::Vector3d p = gl::Faces::rotation(face) * *ray;
        if (!(p.z() > 1e-6)) continue;
        const auto x = std::lround(faces.fx * p.x() / p.z() + faces.cx),
                   y = std::lround(faces.fy * p.y() / p.z() + faces.cy);
        if (x < 0 || y < 0 || x >= faces.width || y >= faces.height) continue;
        if (faces.count > 1 && p.cwiseAbs().maxCoeff() > p.z() * (1 + 1e-9)) continue;  // its neighbour's
        lookup = {static_cast<std::uint32_t>((face * faces.height + y) * faces.width + x),
                  static_cast<float>(1 / p.z())};
        break;
      }
      lookups_.push_back(lookup);
    }
}

cv::Mat ViewRange::read(const gl::FaceImages& images) const {
  const auto& f = images.faces;
  std::vector<float> depth(static_cast<std::size_t>(f.width) * static_cast<std::size_t>(f.height) *
                           static_cast<std::size_t>(f.count));
  glGetTextureImage(images.depth.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    static_cast<GLsizei>(depth.size() * sizeof(float)), depth.data());
  cv::Mat range(height_, width_, CV_32FC1);
  float* out = range.ptr<float>();
  for (const Lookup& lookup : lookups_) {
    const float inverse = lookup.length > 0 ? depth[lookup.place] : 0;
    *out++ = inverse > 0 ? lookup.length * static_cast<float>(gl::kNearPlane) / inverse : 0;
  }
  return range;
}

}  // namespace foresight
