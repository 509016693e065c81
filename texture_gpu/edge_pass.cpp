#include "texture_gpu/edge_pass.hpp"

#include "texture_gpu/shaders.hpp"

namespace foresight {

EdgePass::EdgePass()
    : blocks_(gl::Program::compute(gl::texture_gpu_shaders(), "blocks.comp")),
      uncertain_(gl::Program::compute(gl::texture_gpu_shaders(), "uncertain.comp")) {}

void EdgePass::operator()(const CameraInput& camera, double margin_px, double depth_tolerance) const {
  const gl::Faces& faces = camera.faces().faces;
  const Eigen::Vector2i size(faces.width, faces.height);
  const auto layers = static_cast<GLuint>(faces.count);
  glBindTextureUnit(0, camera.faces().depth.name());

  blocks_.use();
  blocks_.set("face_size", size);
  glBindImageTexture(0, camera.blocks().name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RG32F);
  glDispatchCompute(gl::groups(faces.width, 32), gl::groups(faces.height, 32), layers);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);

  uncertain_.use();
  uncertain_.set("face_size", size);
  uncertain_.set("margin", static_cast<float>(margin_px));
  uncertain_.set("depth_tolerance", static_cast<float>(depth_tolerance));
  glBindTextureUnit(1, camera.blocks().name());
  glBindImageTexture(0, camera.uncertain().name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R8);
  glDispatchCompute(gl::groups(faces.width, 8), gl::groups(faces.height, 8), layers);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace foresight
