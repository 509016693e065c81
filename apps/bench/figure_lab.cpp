#include "apps/bench/figure_lab.hpp"

#include <Eigen/Geometry>

namespace foresight {
namespace {

constexpr int kGrid = 16;  // points along each side of the image

/// Mean displacement over the image, px, where the camera turns by R.
double mean_displacement(const Lens& lens, const Eigen::Matrix3d& R) {
  double sum = 0;
  int count = 0;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      const Eigen::Vector2d pixel(lens.width() * (i + 0.5) / kGrid - 0.5, lens.height() * (j + 0.5) / kGrid - 0.5);
      const auto ray = lens.unproject(pixel);
      const auto moved = ray ? lens.project(R * *ray) : std::nullopt;
      if (!moved) continue;
      sum += (*moved - pixel).norm();
      ++count;
    }
  return count ? sum / count : 0;
}

}  // namespace

FigureTextures::FigureTextures(const RunFolder& run, const thesis::Options& options, bool software)
    : pipeline(run.scene(), run.lens_left(), std::nullopt, options, software), view(pipeline, run.lens_left()) {}

FigureLab::FigureLab(const RunFolder& run) : run_(run), context_(gl::create_headless_context()) {
  software_ = gl::query_driver().is_software;
  gl::set_up_context();
}

PosedImage FigureLab::load(std::size_t frame) const {
  const RunImage& image = run_.frames()[frame].left;
  return {read_run_image(image, run_.lens_left()), image.time, image.T_world_camera, run_.state_at(image.time)};
}

std::unique_ptr<FigureTextures> FigureLab::extract(const PosedImage& image, const thesis::Options& options) const {
  auto textures = std::make_unique<FigureTextures>(run_, options, software_);
  textures->pipeline.process({image, std::nullopt});
  return textures;
}

cv::Mat FigureLab::look(FigureTextures& textures, std::size_t frame) const {
  const RunImage& at = run_.frames()[frame].left;
  textures.view.draw(at.T_world_camera, run_.state_at(at.time));
  return textures.view.read();
}

thesis::Options figure_options() {
  thesis::Options options;
  options.texels_per_metre = 1000;
  options.max_texture = 1024;
  options.expansion = thesis::Expansion::none;
  options.iterations = 0;
  options.hole_filling = thesis::HoleFilling::none;
  return options;
}

PosedImage misregistered(PosedImage image, const Lens& lens, double mean_px, int direction) {
  const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY(),
                                  Eigen::Vector3d::UnitX()};
  const auto turn = [&](double angle) { return Eigen::AngleAxisd(angle, axes[direction]).toRotationMatrix(); };
  double angle = mean_px / lens.parameters().fx;
  for (int i = 0; i < 5; ++i) angle *= mean_px / mean_displacement(lens, turn(angle));  // nearly linear
  image.T_world_camera.linear() = image.T_world_camera.linear() * turn(angle).transpose();
  return image;
}

}  // namespace foresight
