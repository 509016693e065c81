#include "texture_gpu/seen_inputs.hpp"

namespace foresight {
namespace {

constexpr GLuint kImages = 3;  // after the poses and two depths

}  // namespace

SeenInputs::SeenInputs()
    : uniform_(2 * sizeof(gl::CameraBlock), "cameras"), node_poses_(GL_RGBA32F, 2 * 3 * 16, "node poses") {}

void SeenInputs::update(std::span<const CameraInput* const> cameras, std::span<const PosedImage* const> images,
                        std::span<const Eigen::Vector3f> tones) {
  cameras_.assign(cameras.begin(), cameras.end());
  std::vector<gl::CameraBlock> blocks;
  std::vector<Eigen::Vector4f> rows;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    blocks.push_back(gl::make_camera_block(cameras[i]->lens(), cameras[i]->faces().faces));
    blocks.back().tone.head<3>() = tones[i];
    gl::append_node_rows(images[i]->T_world_camera, images[i]->scene, rows);
  }
  node_count_ = static_cast<int>(images[0]->scene.T_world_node.size());
  uniform_.write(std::span<const gl::CameraBlock>(blocks));
  node_poses_.assign(std::span<const Eigen::Vector4f>(rows));
}

void SeenInputs::bind(const gl::Program& program, double depth_tolerance, GLuint block, GLuint unit) const {
  program.set("node_count", node_count_);
  program.set("depth_tolerance", static_cast<float>(depth_tolerance));
  glBindBufferBase(GL_UNIFORM_BUFFER, block, uniform_.name());
  glBindTextureUnit(unit, node_poses_.texture());
  for (int i = 0; i < 2; ++i) {
    // A single camera is bound twice: every sampler must have a complete texture.
    const CameraInput& input = camera(std::min(i, camera_count() - 1));
    const GLuint first = unit + static_cast<GLuint>(i);
    glBindTextureUnit(first + 1, input.marked_depth().name());
    glBindTextureUnit(first + kImages, input.image().name());
  }
}

void SeenInputs::bind_pixels(GLuint image) const {
  glBindImageTexture(image, camera(0).image().name(), 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
}

void SeenInputs::sample_images_by(GLuint sampler) {
  for (GLuint i = 0; i < 2; ++i) glBindSampler(kImages + i, sampler);
}

}  // namespace foresight
