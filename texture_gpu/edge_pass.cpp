#include "texture_gpu/edge_pass.hpp"

#include "texture_gpu/frame_gate.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {
EdgePass::EdgePass()
    : blocks_(gl::Program::compute(gl::texture_gpu_shaders(), "blocks.comp")),
      edge_tiles_(gl::Program::compute(gl::texture_gpu_shaders(), "edge_tiles.comp")),
      near_edges_(gl::Program::compute(gl::texture_gpu_shaders(), "near_edges.comp")),
      uncertain_(gl::Program::compute(gl::texture_gpu_shaders(), "uncertain.comp")),
      tiles_("edge tiles"),
      pixels_("pixels at edges") {}

void EdgePass::operator()(const CameraInput& camera, double margin_px, double depth_tolerance, FrameGate* gate) {
  const gl::Faces& faces = camera.faces().faces;
  const Eigen::Vector2i size(faces.width, faces.height);
  glBindTextureUnit(0, camera.faces().depth.name());

  blocks_.set("face_size", size);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera.block().name());
  glBindImageTexture(0, camera.blocks().name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RG32F);
  blocks_.dispatch(camera.blocks().width(), camera.blocks().height(), faces.count);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);

  if (margin_px <= 0) return;
  next_slice(gate, "near edges");
  const auto tolerance = static_cast<float>(depth_tolerance);
  const int tiles_x = (faces.width + 7) / 8, tiles_y = (faces.height + 7) / 8;
  const auto layers = static_cast<std::size_t>(faces.count);
  edge_tiles_.set("face_size", size);
  edge_tiles_.set("depth_tolerance", tolerance);
  glBindTextureUnit(1, camera.blocks().name());
  tiles_.start(static_cast<std::size_t>(tiles_x) * static_cast<std::size_t>(tiles_y) * layers);
  edge_tiles_.dispatch(tiles_x, tiles_y, faces.count);
  tiles_.finish_for_groups();

  near_edges_.set("face_size", size);
  near_edges_.set("depth_tolerance", tolerance);
  pixels_.start(static_cast<std::size_t>(faces.width) * static_cast<std::size_t>(faces.height) * layers);
  tiles_.dispatch(near_edges_);
  pixels_.finish(uncertain_);
  next_slice(gate, "uncertain pixels");

  uncertain_.set("face_size", size);
  uncertain_.set("margin", static_cast<float>(margin_px));
  uncertain_.set("depth_tolerance", tolerance);
  glBindImageTexture(0, camera.marked_depth().name(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
  pixels_.dispatch(uncertain_);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace foresight
