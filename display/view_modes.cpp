#include "display/view_modes.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr int kSettled = 72;  // calls between changes: as many as costs are remembered for (FramePacing), and some
constexpr double kSmoothing = 0.125;  // of costs
constexpr double kWorthIt = 1.4;      // change of the pixels' number
constexpr double kGrip = 12;          // px beside the border
constexpr double kNarrowest = 0.02;   // share of the width on either side

int scaled(int size, double scale) {
  return std::max(1, static_cast<int>(std::floor(size * scale + 1e-6)));
}

double pixels_of(const Lens& lens) {
  return static_cast<double>(lens.width()) * lens.height();
}

}  // namespace

const char* to_string(ViewMode mode) {
  switch (mode) {
    case ViewMode::predicted: return "as it will be";
    case ViewMode::newest: return "the newest image";
    case ViewMode::both: return "newest image | as it will be";
    case ViewMode::split: return "newest image and as it will be: drag the border";
    case ViewMode::two_eyes: return "left eye | right eye";
    case ViewMode::interlaced: return "rows for two eyes";
    case ViewMode::anaglyph: return "red-cyan spectacles, grey";
    case ViewMode::anaglyph_colours: return "red-cyan spectacles, half coloured";
    case ViewMode::stereogram: return "stereogram";
    case ViewMode::observer: return "from beside: drag to look around";
  }
  return "";
}

const char* to_string(ViewPaint paint) {
  switch (paint) {
    case ViewPaint::colours: return "";
    case ViewPaint::wireframe: return "wireframe";
    case ViewPaint::age: return "age: plain under 1 s, thin lines to 5 s, dense lines beyond, checked: never seen";
    case ViewPaint::confidence:
      return "seen how finely: plain at least as shown, thin lines to a quarter, dense lines below, checked: never";
    case ViewPaint::doubt:
      return "may be off by: plain to 10 grey levels, thin lines to 30, dense lines beyond, checked: not known";
  }
  return "";
}

Lens fitted_lens(const Lens& camera, int width, int height) {
  Lens::Parameters p = camera.parameters();
  const double scale =
      std::min(std::max(1, width) / static_cast<double>(p.width), std::max(1, height) / static_cast<double>(p.height));
  const double sx = scaled(p.width, scale) / static_cast<double>(p.width),
               sy = scaled(p.height, scale) / static_cast<double>(p.height);
  p.width = scaled(p.width, scale);
  p.height = scaled(p.height, scale);
  p.fx *= sx;
  p.fy *= sy;
  p.cx = (p.cx + 0.5) * sx - 0.5;
  p.cy = (p.cy + 0.5) * sy - 0.5;
  return Lens(p);
}

void ViewSize::choose(int width, int height, double drawing_ms) {
  if (width != width_ || height != height_) calls_ = 0;
  width_ = width;
  height_ = height;
  cost_ms_ += kSmoothing * (drawing_ms - cost_ms_);
  if (++calls_ < kSettled) return;
  calls_ = 0;
  const Lens fills = fitted_lens(camera_, width, height);
  const double camera = pixels_of(camera_), place = pixels_of(fills), now = lens_ ? pixels_of(*lens_) : 0;
  const double possible = drawing_ms > 0 ? (camera + now) * most_ms_ / cost_ms_ - camera : 0;
  const double pixels = std::min(place, possible);
  if (pixels < (lens_ ? camera : kWorthIt * camera)) {
    lens_.reset();
    return;
  }
  const bool is_alike = now < kWorthIt * pixels && pixels < kWorthIt * now && now <= 1.01 * place;
  if (is_alike && pixels < place) return;
  const double shrink = std::sqrt(pixels / place);
  lens_ = shrink > 0.999 ? fills : fitted_lens(camera_, scaled(width, shrink), scaled(height, shrink));
}

bool SplitBorder::drag(double x, double width, bool pressed, bool held) {
  if (pressed) dragging_ = width > 0 && std::abs(x - at_ * width) < kGrip;
  if (!held) dragging_ = false;
  if (dragging_ && width > 0) at_ = std::clamp(x / width, kNarrowest, 1 - kNarrowest);
  return dragging_;
}

}  // namespace foresight
