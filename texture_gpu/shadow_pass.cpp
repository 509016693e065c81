#include "texture_gpu/shadow_pass.hpp"

#include <array>

#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

// As in the shaders.
constexpr unsigned kPixelsOfBlock = 16;
constexpr std::size_t kWordsOfBlock = 2;  // where it is, and its blocker
constexpr GLuint kShadowUnit = 3, kWorkUnit = 15;

gl::Program shadow_program(const Lens& lens, int step) {
  auto defines = gl::camera_defines({&lens, 1});
  defines.push_back("STEP " + std::to_string(step));
  return gl::Program::compute(gl::texture_gpu_shaders(), "shadow.comp", defines);
}

}  // namespace

ShadowPass::ShadowPass(const Lens& lens)
    : reached_(shadow_program(lens, 0)),
      shaded_(shadow_program(lens, 1)),
      shade_(shadow_program(lens, 2)),
      unshade_(gl::Program::compute(gl::texture_gpu_shaders(), "unshade.comp")),
      near_("blocks that a shadow may reach"),
      blocks_("blocks that may be in a shadow", kWordsOfBlock),
      uneven_("blocks that a shadow ends in", kWordsOfBlock) {}

void ShadowPass::operator()(const Camera& camera, const ShadowMap& map) {
  const int width = camera.lens.width(), height = camera.lens.height();
  if (light_.width() != width || light_.height() != height)
    light_ = gl::Texture(GL_RGBA8, width, height, 0, 1, "shadows");
  const std::array<GLubyte, 4> lit{255, 255, 255, 255};
  glClearTexImage(light_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, lit.data());

  const Eigen::Matrix4f T_lamp_camera = (map.T_world_lamp().inverse() * camera.T_world_camera).matrix().cast<float>();
  const auto start = [&](const gl::Program& program) {
    program.set("T_lamp_camera", T_lamp_camera);
    map.bind(program, kShadowUnit);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera.block.name());
    glBindTextureUnit(1, camera.faces.depth.name());
    glBindTextureUnit(2, camera.rays.name());
  };
  const int across = (width + 3) / 4, down = (height + 3) / 4;
  const auto most = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  near_.start(most);
  start(reached_);
  reached_.dispatch(across, down);
  near_.finish(shaded_, kWorkUnit);
  blocks_.start(most);
  start(shaded_);
  near_.dispatch(shaded_);
  blocks_.finish(shade_, kWorkUnit);
  uneven_.start(most);
  start(shade_);
  shade_.set("each", false);
  glBindImageTexture(0, light_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  blocks_.dispatch(shade_);
  uneven_.finish(shade_, kWorkUnit);
  shade_.set("each", true);
  uneven_.dispatch(shade_);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void ShadowPass::take_out_of(const gl::Texture& image) const {
  blocks_.finish(unshade_, kWorkUnit, kPixelsOfBlock);
  glBindTextureUnit(0, light_.name());
  glBindImageTexture(0, image.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  blocks_.dispatch(unshade_);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

}  // namespace foresight
