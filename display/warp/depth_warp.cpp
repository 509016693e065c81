#include "display/warp/depth_warp.hpp"

#include <stdexcept>

namespace foresight::gl {
const ShaderSources& warp_shaders();
}  // namespace foresight::gl

namespace foresight {
namespace {

constexpr int kBlock = 16;  // px, as in the shaders

int blocks_in(int pixels) {
  return (pixels + kBlock - 1) / kBlock;
}

Eigen::Vector4f numbers(const Lens& lens) {
  const auto& p = lens.parameters();
  return Eigen::Vector4d(p.fx, p.fy, p.cx, p.cy).cast<float>();
}

void check(const WarpSource& source) {
  const auto fits = [&](const gl::Texture* texture) {
    return texture && texture->width() == source.lens.width() && texture->height() == source.lens.height();
  };
  if (source.lens.has_distortion() || source.lens.model() == LensModel::equidistant)
    throw std::invalid_argument("a source of warping has a distortion");
  if (!fits(source.picture) || !fits(source.depth))
    throw std::invalid_argument("a source of warping has textures of another size than its lens");
}

}  // namespace

DepthWarp::DepthWarp(const Lens& target)
    : target_(target),
      blocks_(gl::Program::compute(gl::warp_shaders(), "blocks.comp")),
      spread_(gl::Program::compute(gl::warp_shaders(), "spread.comp")),
      warp_(gl::Program::compute(gl::warp_shaders(), "depth_warp.comp")),
      picture_(GL_RGBA8, target.width(), target.height(), 0, 1, "warped picture"),
      holes_(GL_R8, target.width(), target.height(), 0, 1, "holes of the warped picture") {
  if (target.has_distortion() || target.model() == LensModel::equidistant)
    throw std::invalid_argument("a target of warping has a distortion");
}

void DepthWarp::find_reach(const WarpSource& source) {
  const Eigen::Vector2i pixels(source.lens.width(), source.lens.height());
  const Eigen::Vector2i blocks(blocks_in(pixels.x()), blocks_in(pixels.y()));
  if (near_far_.width() != blocks.x() || near_far_.height() != blocks.y()) {
    near_far_ = gl::Texture(GL_RG32F, blocks.x(), blocks.y(), 0, 1, "depths of blocks");
    reach_ = gl::Texture(GL_RG32F, blocks.x(), blocks.y(), 0, 1, "depths around blocks");
  }
  blocks_.use();
  blocks_.set("size", pixels);
  glBindTextureUnit(0, source.depth->name());
  glBindImageTexture(0, near_far_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
  glDispatchCompute(gl::groups(blocks.x(), 8), gl::groups(blocks.y(), 8), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  spread_.use();
  spread_.set("size", blocks);
  glBindTextureUnit(0, near_far_.name());
  glBindImageTexture(0, reach_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
  glDispatchCompute(gl::groups(blocks.x(), 8), gl::groups(blocks.y(), 8), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void DepthWarp::operator()(const WarpSource& source, const Pose& T_world_camera) {
  check(source);
  find_reach(source);
  const Pose T_source_target = source.T_world_camera.inverse() * T_world_camera;
  const Eigen::Matrix<float, 3, 4> rows = T_source_target.matrix().topRows<3>().cast<float>();
  const Eigen::Vector3d back = T_source_target.linear().col(2);  // third row of the inverse
  const Eigen::Vector4d back_row(back.x(), back.y(), back.z(), back.dot(T_source_target.translation()));

  warp_.use();
  warp_.set("source_lens", numbers(source.lens));
  warp_.set("target_lens", numbers(target_));
  warp_.set("source_size", Eigen::Vector2i(source.lens.width(), source.lens.height()));
  warp_.set("target_size", Eigen::Vector2i(target_.width(), target_.height()));
  warp_.set("r0", Eigen::Vector4f(rows.row(0).transpose()));
  warp_.set("r1", Eigen::Vector4f(rows.row(1).transpose()));
  warp_.set("r2", Eigen::Vector4f(rows.row(2).transpose()));
  warp_.set("back", Eigen::Vector4f(back_row.cast<float>()));
  glBindTextureUnit(0, source.depth->name());
  glBindTextureUnit(1, source.picture->name());
  glBindTextureUnit(2, reach_.name());
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glBindImageTexture(1, holes_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R8);
  glDispatchCompute(gl::groups(target_.width(), 8), gl::groups(target_.height(), 8), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

}  // namespace foresight
