#include "display/warp/second_eye.hpp"

#include <cmath>
#include <stdexcept>

#include "display/warp/warp_shaders.hpp"

namespace foresight {
namespace {

constexpr double kSameRows = 0.05;  // px
constexpr double kSameWay = 1e-3;   // rad
constexpr double kBeside = 2e-4;    // m above, below, before or behind the first

int rows_apart(const Lens& first, const Lens& second) {
  return static_cast<int>(std::lround(first.parameters().cy - second.parameters().cy));
}

bool rows_fit(const Lens& first, const Lens& second) {
  const auto plain = [](const Lens& lens) { return !lens.has_distortion() && lens.model() != LensModel::equidistant; };
  const auto &a = first.parameters(), &b = second.parameters();
  return plain(first) && plain(second) && std::abs(a.cy - b.cy - rows_apart(first, second)) < kSameRows &&
         std::abs(a.fy - b.fy) * b.height < kSameRows * a.fy;
}

}  // namespace

SecondEye::SecondEye(const Lens& first, const Lens& second)
    : first_(first),
      second_(second),
      program_(gl::Program::compute(gl::warp_shaders(), "second_eye.comp")),
      picture_(GL_RGBA8, second.width(), second.height(), 0, 1, "picture of the second eye"),
      holes_(GL_R8, second.width(), second.height(), 0, 1, "holes of the second eye"),
      count_("count of holes") {
  if (!rows_fit(first, second)) throw std::invalid_argument("rows of the second eye are not those of the first");
}

bool SecondEye::fits(const Lens& first, const Lens& second, const Pose& T_first_second) {
  const Eigen::Vector3d t = T_first_second.translation();
  return rows_fit(first, second) && Eigen::AngleAxisd(T_first_second.linear()).angle() < kSameWay &&
         t.tail<2>().norm() < kBeside;
}

void SecondEye::operator()(const gl::Texture& picture, const gl::Texture& depth, double side) {
  count_.start(0);
  const auto &a = first_.parameters(), &b = second_.parameters();
  // Column in the second = x.x * column in the first + x.y - x.z * inverse depth.
  const double scale = b.fx / a.fx;
  program_.set("x", Eigen::Vector4d(scale, b.cx - scale * a.cx, b.fx * side, 0).cast<float>().eval());
  program_.set("first_size", Eigen::Vector2i(a.width, a.height));
  program_.set("second_size", Eigen::Vector2i(b.width, b.height));
  program_.set("rows_apart", rows_apart(first_, second_));
  glBindTextureUnit(0, depth.name());
  glBindTextureUnit(1, picture.name());
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glBindImageTexture(1, holes_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R8);
  program_.dispatch(b.height);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  count_.finish();
}

}  // namespace foresight
