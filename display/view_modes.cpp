#include "display/view_modes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/statistics.hpp"
#include "display/doubt_kinds.hpp"

namespace foresight {
namespace {

constexpr int kSettled = 24;          // pictures between changes
constexpr double kUsual = 0.9;        // quantile of what they cost
constexpr double kWorthIt = 1.4;      // change of the pixels' number
constexpr double kTooSlow = 1.15;     // likewise, where there are too many
constexpr double kLeastShare = 0.25;  // of the pixels, however slow the renderer is
constexpr double kGrip = 12;          // px beside the border
constexpr double kNarrowest = 0.02;   // share of the width on either side

int scaled(int size, double scale) {
  return std::max(1, static_cast<int>(std::floor(size * scale + 1e-6)));
}

double pixels_of(const Lens& lens) {
  return static_cast<double>(lens.width()) * lens.height();
}

Lens resized(const Lens& lens, int width, int height) {
  Lens::Parameters p = lens.parameters();
  const double sx = width / static_cast<double>(p.width), sy = height / static_cast<double>(p.height);
  p.width = width;
  p.height = height;
  p.fx *= sx;
  p.fy *= sy;
  p.cx = (p.cx + 0.5) * sx - 0.5;
  p.cy = (p.cy + 0.5) * sy - 0.5;
  return Lens(p);
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
      static_assert(kRarelyWrong == 0.016 && kOftenWrong == 0.15);
      return "wrong how often: plain to 1.6 %, thin lines to 15 %, dense lines beyond, checked: not known";
  }
  return "";
}

Lens fitted_lens(const Lens& camera, int width, int height) {
  const double scale = std::min(std::max(1, width) / static_cast<double>(camera.width()),
                                std::max(1, height) / static_cast<double>(camera.height()));
  return resized(camera, scaled(camera.width(), scale), scaled(camera.height(), scale));
}

Lens scaled_lens(const Lens& lens, double scale) {
  if (scale >= 1) return lens;
  // Mesa's software renderer compiles programs anew for textures whose size is a power of two (gl::no_power_of_two).
  const auto side = [scale](int size) {
    const int out = scaled(size, scale);
    return out > 1 && std::has_single_bit(static_cast<unsigned>(out)) ? out - 1 : out;
  };
  return resized(lens, side(lens.width()), side(lens.height()));
}

bool ViewSize::settles(int width, int height, double drawing_ms) {
  if (width != width_ || height != height_ || calls_ == kSettled) {
    calls_ = 0;
    costs_ms_.clear();
  }
  width_ = width;
  height_ = height;
  if (drawing_ms > 0) costs_ms_.push_back(drawing_ms);
  return ++calls_ == kSettled;
}

/// So many times what is drawn now could be drawn. Something must be known of it.
double ViewSize::share_in_time() const {
  return most_ms_ / quantile(costs_ms_, kUsual);
}

/// Of all that is drawn at full size, `whole`, so many pixels can be drawn in time.
void ViewSize::shrink(double possible, double whole) {
  const double least = std::clamp(few_pixels_ / pixels_of(camera_), kLeastShare, 1.0);
  const double now = scale_ * scale_, share = std::clamp(possible / whole, least, 1.0);
  if (share > now ? share < kWorthIt * now && share < 1 : share * kTooSlow > now) return;
  scale_ = std::sqrt(share);
  own_ = scaled_lens(camera_, scale_);
}

void ViewSize::choose_for(std::span<const Lens> others, int width, int height, double drawing_ms) {
  lens_.reset();
  if (!settles(width, height, drawing_ms)) return;
  double whole = pixels_of(camera_);
  for (const Lens& lens : others) whole += pixels_of(lens);
  shrink(costs_ms_.empty() ? whole : scale_ * scale_ * whole * share_in_time(), whole);
}

void ViewSize::choose(int width, int height, double drawing_ms) {
  if (!settles(width, height, drawing_ms)) return;
  const Lens fills = fitted_lens(camera_, width, height);
  const double camera = pixels_of(camera_), place = pixels_of(fills), now = lens_ ? pixels_of(*lens_) : 0;
  // Before anything is known, the camera's own.
  const double possible = costs_ms_.empty() ? camera : (pixels_of(own_) + now) * share_in_time();
  const double pixels = std::min(place, possible - camera);
  if (pixels < (lens_ ? camera : kWorthIt * camera)) {
    lens_.reset();
    shrink(possible, camera);
    return;
  }
  scale_ = 1;
  own_ = camera_;
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
