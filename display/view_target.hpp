// Where a picture is drawn to, on the GPU.
#pragma once

#include "gl/objects.hpp"

namespace foresight {

/// A rectangle of a framebuffer that the current context can draw into: of a window, of a texture of ours, or of one
/// that somebody else lends, such as that of an eye of a head display. Borrows the framebuffer.
struct ViewTarget {
  GLuint framebuffer = 0;         ///< 0: the window's
  int x = 0, y = 0;               ///< px, from the framebuffer's first row and column
  int width = 0, height = 0;      ///< px
  bool first_row_at_top = false;  ///< as in our own pictures; windows begin at the bottom
  bool operator==(const ViewTarget&) const = default;
};

/// The largest rectangle in the middle of `target` that has the proportions of `width` x `height`; at least 1 px.
ViewTarget fitted(const ViewTarget& target, int width, int height);

/// Column `index` of `count` of the same width, with `gap` px around each.
ViewTarget column(const ViewTarget& target, int index, int count, int gap);

/// A texture as a target: its own, or a layer of an array of textures. Belongs to one context.
class TextureTarget {
 public:
  /// `texture` (2-D; a 2-D array where `layer` >= 0) of `width` x `height` px must outlive this. Its first row is the
  /// top of the picture unless the lender says otherwise.
  TextureTarget(GLuint texture, int width, int height, int layer = -1, bool first_row_at_top = true);
  const ViewTarget& whole() const { return whole_; }

 private:
  gl::Framebuffer framebuffer_;
  ViewTarget whole_;
};

/// Draws pictures, whose first row is the top, into targets. Belongs to one context.
class PictureCopy {
 public:
  PictureCopy();
  /// Fills `target` with `picture` (RGBA8), scaled by linear interpolation; alpha comes along. Nothing outside of it
  /// is touched. `columns`: of the picture, from the left; 0: all.
  void operator()(const gl::Texture& picture, const ViewTarget& target, int columns = 0) const;

 private:
  gl::Framebuffer source_;
};

/// Fills `target` with one colour, opaque. Nothing outside of it is touched.
void fill(const ViewTarget& target, float red, float green, float blue);

}  // namespace foresight
