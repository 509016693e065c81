#include "texture_gpu/still_pass.hpp"

#include "texture_gpu/image_before.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

constexpr GLuint kStillUnit = kRaysUnit + 1;

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
  bind_with_before(both_, program_, newest, *before);
  program_.set("interval", static_cast<float>(interval));
  glBindTextureUnit(kStillUnit, before->still.name());
  glBindImageTexture(0, newest.still.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  program_.dispatch(width, height);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace foresight
