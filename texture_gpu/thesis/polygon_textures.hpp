// The normalised textures of all polygons, as they are kept from image to image.
#pragma once

#include <opencv2/core.hpp>

#include "texture_gpu/thesis/polygon_frame.hpp"
#include "texture_gpu/thesis/texel_drawing.hpp"

namespace foresight::thesis {

/// Belongs to one context. A polygon gets its texture with the first image that it is in.
class PolygonTextures {
 public:
  PolygonTextures(std::vector<Polygon> polygons, double texels_per_metre, int max_texture);

  const std::vector<Polygon>& polygons() const { return polygons_; }
  const PolygonFrame& frame(std::size_t polygon) const { return frames_[polygon]; }
  int max_texture() const { return max_texture_; }

  /// RGBA8: alpha 1 seen, 0 not seen (colour by hole filling). Created on the first call.
  const gl::Texture& writable(std::size_t polygon);
  /// Null: the polygon was never in an image.
  const gl::Texture* find(std::size_t polygon) const;

  /// Counts the texels that the drawing between the two calls writes: any at all means that the
  /// polygon has colours. Ends by itself once that is known.
  void begin_looking(std::size_t polygon);
  void end_looking();
  /// False: in images, but hidden in all of them. Waits for the drawing.
  bool has_colours(std::size_t polygon) const;

  /// CV_8UC4 (BGRA), row j the texels (0 .. s, j). Waits for the GPU.
  cv::Mat read(std::size_t polygon) const;

  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Kept {
    gl::Texture texture;
    gl::Query query;
    mutable bool looked = false, coloured = false;
  };
  bool known_coloured(const Kept& kept, bool wait) const;

  std::vector<Polygon> polygons_;
  std::vector<PolygonFrame> frames_;
  std::vector<Kept> kept_;
  int max_texture_ = 1;
  std::uint64_t bytes_ = 0;
  bool looking_ = false;
};

}  // namespace foresight::thesis
