#include "display/silhouette_pass.hpp"

#include "display/shaders.hpp"
#include "gl/camera_block.hpp"

namespace foresight {
namespace {

constexpr unsigned kGroup = 64;
constexpr GLuint kListUnit = 5, kMeans = 2;  // as in silhouettes.comp
/// Metres: surfaces that lie closer together count as one in images too (TextureOptions::depth_tolerance).
constexpr float kStep = 0.02f;

gl::Program silhouette_program(const Lens& lens, int step) {
  auto defines = gl::camera_defines({&lens, 1});
  defines.push_back("STEP " + std::to_string(step));
  return gl::Program::compute(display_and_lookup_shaders(), "silhouettes.comp", defines);
}

}  // namespace

SilhouettePass::SilhouettePass(const Lens& lens)
    : find_(silhouette_program(lens, 0)),
      mix_(silhouette_program(lens, 1)),
      put_(silhouette_program(lens, 2)),
      pixels_("pixels of silhouettes", kGroup),
      means_(GL_R32UI, 4096, "means at silhouettes") {}

void SilhouettePass::operator()(const View& view) {
  const int width = view.lens.width(), height = view.lens.height();
  const auto most = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  means_.reserve(most * sizeof(GLuint));
  const gl::Faces& faces = view.faces.faces;
  const auto start = [&](const gl::Program& program) {
    program.use();
    program.set("face_size", Eigen::Vector2i(faces.width, faces.height));
    program.set("depth_tolerance", kStep);
  };
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, view.camera.name());
  glBindTextureUnit(0, view.faces.depth.name());
  glBindTextureUnit(4, view.rays.name());
  glBindImageTexture(0, view.picture.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  pixels_.start(most);
  start(find_);
  glDispatchCompute(gl::groups(width, 8), gl::groups(height, 8), 1);
  pixels_.finish(kListUnit);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kMeans, means_.buffer().name());
  start(mix_);
  pixels_.dispatch();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  put_.use();
  pixels_.dispatch();
}

}  // namespace foresight
