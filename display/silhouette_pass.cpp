#include "display/silhouette_pass.hpp"

#include "display/shaders.hpp"
#include "gl/camera_block.hpp"

namespace foresight {
namespace {

constexpr int kTile = 4;  // px a side, as in the shaders
constexpr unsigned kPixelsOfTile = kTile * kTile;
constexpr GLuint kPlacesUnit = 5, kStepsUnit = 8, kMeans = 2;  // as in silhouettes.comp
/// Metres: surfaces that lie closer together count as one in images too (TextureOptions::depth_tolerance).
constexpr float kStep = 0.02f;

int tiles_of(int px) {
  return (px + kTile - 1) / kTile;
}

gl::Program silhouette_program(const Lens& lens, int step) {
  auto defines = gl::camera_defines({&lens, 1});
  defines.push_back("STEP " + std::to_string(step));
  return gl::Program::compute(display_and_lookup_shaders(), "silhouettes.comp", defines);
}

}  // namespace

SilhouettePass::SilhouettePass(const Lens& lens)
    : steps_of_faces_(gl::Program::compute(display_and_lookup_shaders(), "face_steps.comp")),
      find_tiles_(silhouette_program(lens, 0)),
      find_pixels_(silhouette_program(lens, 1)),
      mix_(silhouette_program(lens, 2)),
      put_(silhouette_program(lens, 3)),
      tiles_("tiles that may hold silhouettes"),
      pixels_("pixels of silhouettes"),
      means_(GL_R32UI, 4096, "means at silhouettes") {}

void SilhouettePass::start(const gl::Program& program, const View& view) {
  program.set("face_size", Eigen::Vector2i(view.faces.faces.width, view.faces.faces.height));
  program.set("depth_tolerance", kStep);
}

void SilhouettePass::find_steps(const View& view) {
  const gl::Faces& faces = view.faces.faces;
  const int across = tiles_of(faces.width), down = tiles_of(faces.height);
  if (steps_.width() != across || steps_.height() != down || steps_.layers() != faces.count)
    steps_ = gl::Texture(GL_R8, across, down, faces.count, 1, "steps of faces");
  start(steps_of_faces_, view);
  glBindImageTexture(1, steps_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R8);
  steps_of_faces_.dispatch(across, down, faces.count);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  glBindTextureUnit(kStepsUnit, steps_.name());
}

void SilhouettePass::find_pixels(const View& view) {
  const int across = tiles_of(view.lens.width()), down = tiles_of(view.lens.height());
  const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  tiles_.start(tiles);
  start(find_tiles_, view);
  find_tiles_.dispatch(across, down);
  tiles_.finish(find_pixels_, kPlacesUnit, kPixelsOfTile);
  pixels_.start(tiles * kPixelsOfTile);
  start(find_pixels_, view);
  tiles_.dispatch(find_pixels_);
  pixels_.finish(mix_, kPlacesUnit);
  means_.reserve(tiles * kPixelsOfTile * sizeof(GLuint));
}

void SilhouettePass::operator()(const View& view) {
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, view.camera.name());
  glBindTextureUnit(0, view.faces.depth.name());
  glBindTextureUnit(4, view.rays.name());
  find_steps(view);
  find_pixels(view);
  glBindImageTexture(0, view.picture.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kMeans, means_.buffer().name());
  start(mix_, view);
  pixels_.dispatch(mix_);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  pixels_.dispatch(put_);
}

}  // namespace foresight
