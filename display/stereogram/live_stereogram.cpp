#include "display/stereogram/live_stereogram.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "gl/read_texture.hpp"

namespace foresight {
namespace {

constexpr double kDepths[] = {0.15, 1 / 3., 0.55};
constexpr const char* kDepthWords[] = {"flat", "deep", "very deep"};
constexpr const char* kPatternWords[] = {"fine dots", "coarse dots", "clouds"};
constexpr double kEyesOfWidth = 0.25;
constexpr int kMostWidth = 1280;  // px: no finer dots are told apart
constexpr int kSmallWidth = 96;
constexpr unsigned kRangeEvery = 16;  // pictures
constexpr double kFollows = 0.3;      // share of a new range that counts at once

/// The camera's view through a pinhole of so many px.
Lens pinhole_like(const Lens& camera, int width, int height) {
  Lens::Parameters p;
  p.width = width;
  p.height = height;
  p.fx = p.fy = camera.parameters().fx * width / camera.width();
  p.cx = 0.5 * (width - 1);
  p.cy = 0.5 * (height - 1);
  return Lens(p);
}

cv::Mat clouds() {
  cv::Mat noise(128, 128, CV_8UC3), soft, out;
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, soft, {}, 2);
  cv::normalize(soft, out, 0, 255, cv::NORM_MINMAX);
  return out;
}

bool has_size(const std::unique_ptr<gl::FaceImages>& faces, const Lens& lens) {
  return faces && faces->depth.width() == lens.width() && faces->depth.height() == lens.height();
}

}  // namespace

std::string StereogramLook::words() const {
  return std::string(kDepthWords[depth]) + ", " + kPatternWords[pattern] + ", " +
         (variant < 2 ? "look through it" : "cross your eyes before it") +
         (variant % 2 == 0 ? "" : "; strips in two pictures in turn");
}

void LiveStereogram::look_at_range(const Pose& T_world_camera, const SceneState& state, const Lens& lens) {
  if (!has_size(small_, lens)) small_ = std::make_unique<gl::FaceImages>(gl::faces_for(lens, 0), false);
  raster_(T_world_camera, state, *small_);
  const DepthRange seen = depth_range(gl::read_texture(small_->depth) / gl::kNearPlane);
  if (!(seen.far > 0)) return;  // nothing there: as before
  const double share = range_.far > 0 ? kFollows : 1;
  range_ = {std::lerp(range_.near, seen.near, share), std::lerp(range_.far, seen.far, share)};
}

void LiveStereogram::draw(const StereogramLook& look, const Pose& T_world_camera, const SceneState& state,
                          const Lens& camera, int width, int height) {
  const int across = std::clamp(width, kSmallWidth, kMostWidth);
  const Lens lens = pinhole_like(camera, across, std::max(1, across * height / std::max(1, width)));
  if (!has_size(faces_, lens) || look.pattern != pattern_) {
    faces_ = std::make_unique<gl::FaceImages>(gl::faces_for(lens, 0), false);
    stereogram_ = std::make_unique<Stereogram>(lens.width(), lens.height(), look.pattern == 2 ? clouds() : cv::Mat());
    pattern_ = look.pattern;
  }
  if (frame_ % kRangeEvery == 0 || !(range_.far > 0))
    look_at_range(T_world_camera, state,
                  pinhole_like(camera, kSmallWidth, std::max(1, kSmallWidth * lens.height() / lens.width())));
  raster_(T_world_camera, state, *faces_);
  StereogramOptions options;
  options.depth = {kEyesOfWidth * lens.width(), kDepths[look.depth], look.variant >= 2};
  options.pictures = look.variant % 2 == 0 ? StripPictures::one : StripPictures::two;
  options.dot = look.pattern == 1 ? 4 : 2;
  options.frame = frame_++;
  // A size below which strips would be too thin keeps its separations apart.
  if (options.depth.least() < Stereogram::kLeastSeparation)
    options.depth.eye_distance *= Stereogram::kLeastSeparation / options.depth.least() * 1.01;
  (*stereogram_)(faces_->depth, range_.far > 0 ? range_ : DepthRange{0.5, 2}, options);
}

}  // namespace foresight
