// A depth picture as a single-image stereogram: dots or a pattern that repeat along each row, the nearer the surface
// the closer, so that eyes which look through the picture (or cross before it) see the surface.
//
//   depth --> links: for each pixel, how far to its left the other eye sees the same point; 0 where only one eye does
//         --> strips, from left to right: a pixel is the one that it is linked to; without a link, the pattern's own
//
// All pixels of a strip can be made at once, as none is linked to one closer than the least separation. A strip may not
// read what is written in the same pass, so there are two ways: two pictures in turn, each strip drawn twice; or one
// picture of which another part is read, with a barrier between strips. (The copying
// after L. Geselowitz, "The AbSIRD project", 2002; hidden surfaces after Thimbleby, Inglis, Witten 1994, as a search
// along both eyes' rays.)
#pragma once

#include "display/stereogram/separations.hpp"
#include "gl/program.hpp"

namespace foresight {

enum class StripPictures : std::uint8_t { two, one };

struct StereogramOptions {
  StereogramDepth depth;
  StripPictures pictures = StripPictures::one;
  /// Links of a point that only one eye can see are cut; else the surface is taken to be seen at the pixel itself by
  /// both eyes, as if it had no steps.
  bool hides = true;
  bool smooth = true;  ///< links of fractions of a pixel; else of whole ones, which makes terraces
  int dot = 2;         ///< px, side of a random dot; 1 .. 16
  unsigned seed = 1;   ///< of the dots
  /// Another one gives other dots, or the pattern moved: what moves would else drag shadows of itself along, as eyes
  /// compare each picture with the one before.
  unsigned frame = 0;
};

/// A flat picture in front of or in the surface: it is seen as often as it repeats along the row.
struct Floater {
  cv::Mat picture;      ///< CV_8UC4, BGRA, straight alpha
  double x = 0, y = 0;  ///< px of its middle where the depth picture has it
  double nearness = 1;  ///< 0 .. 1
};

/// Belongs to one context.
class Stereogram {
 public:
  static constexpr double kLeastSeparation = 16;  ///< px: below, strips are thinner than what they read

  /// `pattern` (CV_8UC3, BGR; empty: random dots) repeats downwards, and is scaled to one period's width. Throws
  /// std::invalid_argument: sizes below 1 px.
  Stereogram(int width, int height, const cv::Mat& pattern = {});

  /// `depth`: gl::FaceImages::depth, one face of the same size. Throws std::invalid_argument: a depth of another size,
  /// separations below kLeastSeparation or beyond the width, a range that is none.
  void operator()(const gl::Texture& depth, const DepthRange& range, const StereogramOptions& options);
  /// On top of the picture of the last call, with its options.
  void float_over(const Floater& floater);

  /// RGBA8, row 0 at the top, opaque.
  const gl::Texture& picture() const { return pictures_[shown_]; }
  /// CV_8UC3, BGR; waits for the GPU.
  cv::Mat read() const;

 private:
  void find_links(const gl::Texture& depth, const DepthRange& range);
  void draw_strips();

  int width_, height_;
  gl::Program links_program_, one_, two_, floater_program_;
  gl::Texture pattern_;  // empty: dots
  gl::Texture links_;    // R32F: separation, px; 0: none
  gl::Texture pictures_[2];
  std::size_t shown_ = 0;
  StereogramOptions options_;
};

}  // namespace foresight
