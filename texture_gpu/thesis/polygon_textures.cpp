#include "texture_gpu/thesis/polygon_textures.hpp"

#include <algorithm>

namespace foresight::thesis {

PolygonTextures::PolygonTextures(std::vector<Polygon> polygons, double texels_per_metre, int max_texture)
    : polygons_(std::move(polygons)), kept_(polygons_.size()) {
  for (const Polygon& polygon : polygons_) {
    frames_.push_back(frame_of(polygon, texels_per_metre, max_texture));
    max_texture_ = std::max({max_texture_, frames_.back().s, frames_.back().t});
  }
}

const gl::Texture& PolygonTextures::writable(std::size_t polygon) {
  Kept& kept = kept_[polygon];
  if (!kept.texture) {
    const PolygonFrame& frame = frames_[polygon];
    kept.texture = smooth_texture(GL_RGBA8, frame.s, frame.t, "normalised texture");
    glClearTexImage(kept.texture.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    bytes_ += static_cast<std::uint64_t>(frame.s) * static_cast<std::uint64_t>(frame.t) * 4;
  }
  return kept.texture;
}

const gl::Texture* PolygonTextures::find(std::size_t polygon) const {
  return kept_[polygon].texture ? &kept_[polygon].texture : nullptr;
}

void PolygonTextures::begin_looking(std::size_t polygon) {
  Kept& kept = kept_[polygon];
  if (known_coloured(kept, false)) return;
  if (!kept.query) {
    GLuint name = 0;
    glCreateQueries(GL_ANY_SAMPLES_PASSED, 1, &name);
    kept.query = gl::Query(name);
  }
  glBeginQuery(GL_ANY_SAMPLES_PASSED, kept.query.name());
  kept.looked = looking_ = true;
}

void PolygonTextures::end_looking() {
  if (std::exchange(looking_, false)) glEndQuery(GL_ANY_SAMPLES_PASSED);
}

bool PolygonTextures::has_colours(std::size_t polygon) const {
  return known_coloured(kept_[polygon], true);
}

bool PolygonTextures::known_coloured(const Kept& kept, bool wait) const {
  if (kept.coloured || !kept.looked) return kept.coloured;
  GLint ready = 0;
  if (!wait) glGetQueryObjectiv(kept.query.name(), GL_QUERY_RESULT_AVAILABLE, &ready);
  if (!wait && !ready) return false;
  GLuint any = 0;
  glGetQueryObjectuiv(kept.query.name(), GL_QUERY_RESULT, &any);
  return kept.coloured = any != 0;
}

cv::Mat PolygonTextures::read(std::size_t polygon) const {
  const PolygonFrame& frame = frames_[polygon];
  cv::Mat texels(frame.t, frame.s, CV_8UC4, cv::Scalar::all(0));
  if (const gl::Texture* texture = find(polygon))
    glGetTextureImage(texture->name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(texels.total() * 4),
                      texels.data);
  return texels;
}

}  // namespace foresight::thesis
