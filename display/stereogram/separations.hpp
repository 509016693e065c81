// How far apart on a picture two eyes see the same point of a surface.
//
//        left eye    right eye        s = E (1 - mu z) / (2 - mu z)     z = 0: as far behind the picture as the eyes
//            \  .    .  /                                                     are before it
//   picture --x-+--s-+-x--                                              z = 1: nearest, mu of that way nearer
//                \  /
//                 *  surface                                            (Thimbleby, Inglis, Witten: "Displaying 3D
//                                                                       images", IEEE Computer 27(10), 1994)
#pragma once

#include <opencv2/core.hpp>

namespace foresight {

/// Of an autostereogram; lengths in px of the picture.
struct StereogramDepth {
  double eye_distance = 240;       ///< E: of the viewer, on the picture; > 0
  double depth_of_field = 1 / 3.;  ///< mu: of the way behind the picture; above 0, below 1
  bool inverted = false;           ///< for eyes that cross before the picture: what is near becomes far

  /// Of a surface of `nearness` z, 0 .. 1.
  double separation(double nearness) const;
  double least() const { return separation(inverted ? 0 : 1); }
  double most() const { return separation(inverted ? 1 : 0); }
};

/// What of a scene is shown how deep: linear in the inverse distance, so that planes stay planes. Metres, near < far.
struct DepthRange {
  double near = 0, far = 0;
};

/// Of a picture of inverse distances (CV_32F, 1/m; 0: nothing), from the first to the last hundredth of it. Nothing
/// where nothing is in it. What is all at one distance gets a range around it.
DepthRange depth_range(const cv::Mat& inverse_distance);

/// 0 .. 1 as the GPU makes it of inverse distances: CV_32F, 0 where nothing is.
cv::Mat nearness(const cv::Mat& inverse_distance, const DepthRange& range);

}  // namespace foresight
