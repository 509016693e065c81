// What fills an operator's window, and how it is painted. Plain descriptions, without OpenGL.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/lens.hpp"
#include "display/view_target.hpp"

namespace foresight {

enum class ViewMode : std::uint8_t {
  predicted,         ///< the scene as it will be
  newest,            ///< the newest image
  both,              ///< newest image | as it will be
  split,             ///< one picture, cut by a border that the mouse drags: left of it the newest image
  two_eyes,          ///< left eye | right eye
  interlaced,        ///< rows of the screen in turn, for screens whose rows are polarised alike
  anaglyph,          ///< red | cyan spectacles, grey: without colours that fight between the eyes
  anaglyph_colours,  ///< the same, half coloured
  stereogram,        ///< one picture of dots for both eyes, on any screen: depth alone
  observer,          ///< from beside the robot, the operator's view as a spotlight
};
inline constexpr int kMainModes = 4;  ///< the first ones
/// In words, for the window.
const char* to_string(ViewMode mode);
constexpr bool has_two_eyes(ViewMode mode) {
  return mode >= ViewMode::two_eyes && mode <= ViewMode::anaglyph_colours;
}

/// What the pixels of a view tell. Each class of a false colour has a hatching of its own, too.
enum class ViewPaint : std::uint8_t {
  colours,     ///< the scene's own
  wireframe,   ///< borders of triangles
  age,         ///< for how long, at the instant shown, no image has shown what is there
  confidence,  ///< how finely images have shown it, against how finely it is shown
  doubt,       ///< how often such pixels are wrong (DoubtPaint), for one eye
};
inline constexpr int kViewPaints = 5;
/// In words, with what the colours mean; "" for colours.
const char* to_string(ViewPaint paint);

/// The camera's lens with another number of pixels, the largest that fits into width x height px in the camera's
/// proportions. Both at least 1.
Lens fitted_lens(const Lens& camera, int width, int height);

/// Of the time between pictures, what live seats let their drawings take: ViewSize.
inline constexpr double kDrawingShare = 0.6;

/// With how many pixels the operator's views are drawn, so that they come in time: as many as their place in the window
/// has, and where not even the camera's can be drawn, fewer, down to half of them along each side. The camera's own
/// view, which images are compared with, is drawn anyhow; a second one has more pixels than that, or there are two
/// eyes.
class ViewSize {
 public:
  /// With fewer pixels, most of the time goes into what does not depend on their number.
  static constexpr double kFewPixels = 320 * 240;

  /// Drawings may take `most_ms` in all. The camera's own view never becomes smaller than `few_pixels`.
  ViewSize(const Lens& camera, double most_ms, double few_pixels = kFewPixels)
      : camera_(camera), own_(camera), most_ms_(most_ms), few_pixels_(few_pixels) {}

  /// The place has width x height px, and the last picture took `drawing_ms`; 0: not known. For each picture; changes
  /// its mind only after a place has stayed the same for some, and where it is worth it.
  void choose(int width, int height, double drawing_ms);
  /// The same where it is not this view that fills the place, but others beside it: through these lenses where nothing
  /// is left out.
  void choose_for(std::span<const Lens> others, int width, int height, double drawing_ms);

  /// Of the camera's own view.
  const Lens& own() const { return own_; }
  /// Of the second one. Nothing: the camera's own view is as good, or all that can be drawn.
  const std::optional<Lens>& lens() const { return lens_; }
  /// Of what is drawn, along each side: 1, or less where drawing takes too long.
  double scale() const { return scale_; }

 private:
  bool settles(int width, int height, double drawing_ms);
  double share_in_time() const;
  void shrink(double possible, double whole);

  Lens camera_, own_;
  double most_ms_, few_pixels_;
  double scale_ = 1;
  std::optional<Lens> lens_;
  int width_ = 0, height_ = 0, calls_ = 0;  // of the place, since it or the size changed
  std::vector<double> costs_ms_;            // of pictures since then
};

/// The same lens with so many times its pixels along each side, 1 at most.
Lens scaled_lens(const Lens& lens, double scale);

/// Where the border of a split picture lies, as a share of the width; the mouse takes it where it is pressed near it.
class SplitBorder {
 public:
  /// `x`: of the pointer from the picture's left side, px. True: the border is held.
  bool drag(double x, double width, bool pressed, bool held);
  double at() const { return at_; }

 private:
  double at_ = 0.5;
  bool dragging_ = false;
};

}  // namespace foresight
