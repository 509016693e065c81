#include "sim/shutter.hpp"

namespace foresight::sim {
namespace {

constexpr int kSubInstants = 5;  // of an exposure; odd, so that one is in its middle

// Light between two instants.
class ChangingLight {
 public:
  ChangingLight(const LightMap& light, const LabMotion& motion, double begin, double end)
      : begin_(begin), end_(end), first_(light.lit(motion.T_world_part(begin))) {
    if (end > begin) last_ = light.lit(motion.T_world_part(end));
  }

  const LightMap::Irradiance& at(double t) {
    if (last_.empty()) return first_;
    const auto s = static_cast<float>((t - begin_) / (end_ - begin_));
    mixed_.resize(first_.size());
    for (std::size_t i = 0; i < mixed_.size(); ++i) mixed_[i] = (1 - s) * first_[i] + s * last_[i];
    return mixed_;
  }

 private:
  double begin_, end_;
  LightMap::Irradiance first_, last_, mixed_;
};

}  // namespace

Picture expose(const Renderer& renderer, const RayTable& rays, const LabMotion& motion, const Shutter& shutter,
               double t) {
  const int rows = rays.height(), instants = shutter.exposure_s > 0 ? kSubInstants : 1;
  const int band = shutter.readout_s > 0 ? 1 : rows;
  ChangingLight light(renderer.light(), motion, shutter.row_time(t, 0, rows) - shutter.exposure_s / 2,
                      shutter.row_time(t, rows - 1, rows) + shutter.exposure_s / 2);
  const cv::Size size(rays.width(), rows);
  Picture out(size), part(size);
  for (int row = 0; row < rows; row += band)
    for (int k = 0; k < instants; ++k) {
      const double centre = band == 1 ? shutter.row_time(t, row, rows) : t;
      const double instant = centre + shutter.exposure_s * ((k + 0.5) / instants - 0.5);
      renderer.render(rays, motion.T_world_camera(instant), motion.T_world_part(instant), light.at(instant), row,
                      row + band, part);
      const cv::Range here(row, row + band);
      out.light.rowRange(here) += part.light.rowRange(here) / instants;
      if (k != instants / 2) continue;
      part.depth.rowRange(here).copyTo(out.depth.rowRange(here));
      part.facet.rowRange(here).copyTo(out.facet.rowRange(here));
    }
  return out;
}

}  // namespace foresight::sim
