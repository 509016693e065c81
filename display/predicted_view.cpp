#include "display/predicted_view.hpp"

#include "display/lens_rays.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight::gl {
const ShaderSources& display_shaders();
}  // namespace foresight::gl

namespace foresight {
namespace {

/// The display's own shaders and those of the texture lookup.
const gl::ShaderSources& sources() {
  static const gl::ShaderSources all = [] {
    gl::ShaderSources s = gl::display_shaders();
    s.insert(gl::texture_gpu_shaders().begin(), gl::texture_gpu_shaders().end());
    return s;
  }();
  return all;
}

}  // namespace

PredictedView::PredictedView(std::shared_ptr<const gl::SceneBuffers> scene,
                             std::shared_ptr<const SurfaceRecords> surface, const Lens& lens)
    : lens_(lens),
      surface_(std::move(surface)),
      faces_(gl::faces_for(lens, 2), true),
      raster_(std::move(scene), true),
      program_(gl::Program::compute(sources(), "view.comp")),
      camera_(sizeof(gl::CameraBlock), "view camera"),
      node_poses_(GL_RGBA32F, 16, "view node poses"),
      rays_(make_lens_rays(lens)),
      picture_(GL_RGBA8, lens.width(), lens.height(), 0, 1, "predicted view") {}

void PredictedView::draw(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures) {
  raster_(T_world_camera, state, faces_);

  const gl::CameraBlock block = gl::make_camera_block(lens_, faces_.faces);
  camera_.write(std::span(&block, 1));
  std::vector<Eigen::Vector4f> rows;
  for (const Pose& T_world_node : state.T_world_node) {
    const Eigen::Matrix4f m = (T_world_node.inverse() * T_world_camera).matrix().cast<float>();
    for (int row = 0; row < 3; ++row) rows.push_back(m.row(row).transpose());
  }
  node_poses_.assign(std::span<const Eigen::Vector4f>(rows));

  program_.use();
  program_.set("gain", textures.display_gain);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera_.name());
  glBindTextureUnit(0, node_poses_.texture());
  glBindTextureUnit(1, faces_.surface.name());
  glBindTextureUnit(2, surface_->triangles());
  glBindTextureUnit(3, surface_->patches());
  glBindTextureUnit(4, rays_.name());
  textures.bind();
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glDispatchCompute(gl::groups(lens_.width(), 8), gl::groups(lens_.height(), 8), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

cv::Mat PredictedView::read() const {
  cv::Mat picture(lens_.height(), lens_.width(), CV_8UC4);
  glGetTextureImage(picture_.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(picture.total() * 4),
                    picture.data);
  return picture;
}

}  // namespace foresight
