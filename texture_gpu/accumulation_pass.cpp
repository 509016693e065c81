#include "texture_gpu/accumulation_pass.hpp"

#include <vector>

#include "texture_gpu/image_before.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

constexpr GLuint kMovedUnit = kRaysUnit + 1;
constexpr double kRest = 1e-3;    // m, of a box's corner
constexpr double kAround = 0.01;  // m: what lies so near a box may be of it

/// Rows of what takes points of the camera's frame into [-1, 1]^3 where they lie in `box`.
void append_box(const Eigen::AlignedBox3d& box, const Pose& T_node_camera, std::vector<Eigen::Vector4f>& rows) {
  const Eigen::Vector3d half = box.sizes() / 2 + Eigen::Vector3d::Constant(kAround);
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector4d row = T_node_camera.matrix().row(i);
    row.w() -= box.center()(i);
    rows.push_back((row / half(i)).cast<float>());
  }
}

bool has_moved(const Eigen::AlignedBox3d& box, const Pose& T_now, const Pose& T_then) {
  for (const auto corner :
       {Eigen::AlignedBox3d::BottomLeftFloor, Eigen::AlignedBox3d::TopRightCeil, Eigen::AlignedBox3d::TopLeftFloor})
    if ((T_now * box.corner(corner) - T_then * box.corner(corner)).norm() > kRest) return true;
  return false;
}

}  // namespace

AccumulationPass::AccumulationPass(const Lens& lens, std::shared_ptr<const gl::SceneBuffers> scene)
    : scene_(std::move(scene)),
      program_(gl::Program::compute(gl::texture_gpu_shaders(), "accumulate.comp", gl::camera_defines({&lens, 1}))),
      moved_(GL_RGBA32F, 3 * sizeof(Eigen::Vector4f), "boxes that have moved"),
      mean_(GL_RGBA8, lens.width(), lens.height(), 0, 1, "mean over time") {}

void AccumulationPass::operator()(PublishedImage& newest, const PublishedImage& before) {
  if (newest.image.time <= before.image.time || (newest.light == nullptr) != (before.light == nullptr)) return;
  const auto& boxes = scene_->boxes().box;
  std::vector<Eigen::Vector4f> rows;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Pose& T_world_node = newest.image.scene.T_world_node[i];
    if (!boxes[i].isEmpty() && has_moved(boxes[i], T_world_node, before.image.scene.T_world_node[i]))
      append_box(boxes[i], T_world_node.inverse() * newest.image.T_world_camera, rows);
  }
  moved_.assign(std::span<const Eigen::Vector4f>(rows));
  bind_with_before(both_, program_, newest, before);
  program_.set("boxes_moved", static_cast<int>(rows.size() / 3));
  glBindTextureUnit(kMovedUnit, moved_.texture());
  glBindImageTexture(0, mean_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  program_.dispatch(mean_.width(), mean_.height());
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glCopyImageSubData(mean_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, newest.camera->image().name(), GL_TEXTURE_2D, 0, 0, 0, 0,
                     mean_.width(), mean_.height(), 1);
}

}  // namespace foresight
