// How far away each pixel of a drawn view is, for the CPU.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/lens.hpp"
#include "gl/raster_pass.hpp"

namespace foresight {

/// Belongs to the context of the faces it reads.
class ViewRange {
 public:
  /// For views of `lens` that are rasterised into `faces`.
  ViewRange(const Lens& lens, const gl::Faces& faces);

  /// Waits for the GPU. CV_32FC1 of the lens's size: distance from the camera's centre along the
  /// pixel's ray to the surface that the nearest pixel of the faces shows, metres; 0: nothing.
  cv::Mat read(const gl::FaceImages& images) const;

 private:
  struct Lookup {
    std::uint32_t place;  // pixel of the faces
    float length;         // of the ray whose depth in its face is 1; 0: the lens does not see there
  };
  int width_, height_;
  std::vector<Lookup> lookups_;  // one a pixel
};

}  // namespace foresight
