#include "texture_gpu/still_pass.hpp"

#include <array>

#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

constexpr GLuint kRaysUnit = 7, kStillUnit = 8;  // after those of SeenInputs

Eigen::Vector3f even_tone(const PublishedImage& image) {
  return {image.tone.x() / image.gain, image.tone.y(), image.tone.z()};
}

}  // namespace

StillPass::StillPass(const Lens& lens)
    : program_(gl::Program::compute(gl::texture_gpu_shaders(), "still.comp", gl::camera_defines({&lens, 1}))) {}

void StillPass::operator()(PublishedImage& newest, const PublishedImage* before) {
  const Lens& lens = newest.camera->lens();
  const int width = (lens.width() + 1) / 2, height = (lens.height() + 1) / 2;
  if (!newest.still) newest.still = gl::Texture(GL_R32F, width, height, 0, 1, "for how long surfaces look so");
  const double interval = before ? to_seconds(newest.image.time - before->image.time) : 0;
  if (interval <= 0 || !before->still) {
    glClearTexImage(newest.still.name(), 0, GL_RED, GL_FLOAT, nullptr);
    return;
  }
  const std::array<const CameraInput*, 2> cameras{newest.camera.get(), before->camera.get()};
  const std::array<const PosedImage*, 2> images{&newest.image, &before->image};
  both_.update(cameras, images, std::array{even_tone(newest), even_tone(*before)});
  both_.bind(program_, newest.depth_tolerance);
  const Pose T_before_newest = before->image.T_world_camera.inverse() * newest.image.T_world_camera;
  program_.set("T_before_newest", Eigen::Matrix4f(T_before_newest.matrix().cast<float>()));
  program_.set("interval", static_cast<float>(interval));
  glBindTextureUnit(kRaysUnit, newest.camera->rays().name());
  glBindTextureUnit(kStillUnit, before->still.name());
  glBindImageTexture(0, newest.still.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  glDispatchCompute(gl::groups(width, 8), gl::groups(height, 8), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace foresight
