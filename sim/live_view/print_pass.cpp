#include "sim/live_view/print_pass.hpp"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "sim/hemisphere.hpp"
#include "sim/lamp.hpp"

namespace foresight::gl {
const ShaderSources& live_view_shaders();
}  // namespace foresight::gl

namespace foresight::sim {
namespace {

constexpr int kLevels = 6;
constexpr int kDaylight = 128;  // directions
// Nearer by this share where prints and what they stick to are compared: 4 mm at a metre.
constexpr float kNearer = 1.004f;

// Halving an odd number of texels would move what the next level shows.
int divisible(int pixels) {
  constexpr int kStep = 1 << (kLevels - 1);
  return (pixels + kStep - 1) / kStep * kStep;
}

Eigen::Vector4f light_at(const Pose& T_world_print, double x, double y) {
  const Eigen::Vector3f p = (T_world_print * Eigen::Vector3d(x, y, 0)).cast<float>();
  const Eigen::Vector3f n = -T_world_print.linear().col(2).cast<float>();
  Eigen::Vector3f daylight = Eigen::Vector3f::Zero();
  for (int k = 0; k < kDaylight; ++k) daylight += lamp::daylight(cosine_direction(n, k, kDaylight));
  const Eigen::Vector3f sum =
      lamp::irradiance(p, n, ~std::uint64_t{0}) + daylight * (std::numbers::pi_v<float> / kDaylight);
  return {sum.x(), sum.y(), sum.z(), 0};
}

}  // namespace

PrintPicture::PrintPicture(const Print& print)
    : texture(GL_R16, divisible(print.picture.cols), divisible(print.picture.rows), 0, kLevels, "print"),
      size_m(Eigen::Vector2d(print.width_m, print.height_m).cast<float>()) {
  cv::Mat level;
  print.picture.convertTo(level, CV_32F, 65535.0 / 255);
  cv::resize(level, level, {texture.width(), texture.height()}, 0, 0, cv::INTER_LINEAR);
  for (int k = 0; k < kLevels; ++k) {
    if (k > 0) cv::resize(level, level, {level.cols / 2, level.rows / 2}, 0, 0, cv::INTER_AREA);
    cv::Mat texels;
    level.convertTo(texels, CV_16U);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture.name(), k, 0, 0, texels.cols, texels.rows, GL_RED, GL_UNSIGNED_SHORT, texels.data);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  }
  glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

PrintPass::PrintPass() : program_(gl::Program::graphics(gl::live_view_shaders(), "print.vert", "print.frag")) {}

void PrintPass::operator()(const gl::Faces& faces, const Pose& T_face_world, std::span<const PrintPicture> prints,
                           std::span<const Pose> T_world_print) const {
  program_.use();
  program_.set("face", Eigen::Vector4d(faces.fx, faces.fy, faces.cx, faces.cy).cast<float>().eval());
  program_.set("face_size", Eigen::Vector2i(faces.width, faces.height).cast<float>().eval());
  program_.set("nearer", kNearer);
  for (std::size_t k = 0; k < prints.size(); ++k) {
    const Pose& T = T_world_print[k];
    const Eigen::Vector2d half = prints[k].size_m.cast<double>() / 2;
    program_.set("T_face_print", (T_face_world * T).matrix().cast<float>().eval());
    program_.set("half_size", half.cast<float>().eval());
    program_.set("light_00", light_at(T, -half.x(), -half.y()));
    program_.set("light_10", light_at(T, half.x(), -half.y()));
    program_.set("light_01", light_at(T, -half.x(), half.y()));
    program_.set("light_11", light_at(T, half.x(), half.y()));
    glBindTextureUnit(0, prints[k].texture.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
}

}  // namespace foresight::sim
