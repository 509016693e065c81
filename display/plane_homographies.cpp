#include "display/plane_homographies.hpp"

#include "display/shaders.hpp"

namespace foresight {
namespace {

constexpr GLuint kHomographies = 3;  // as in homographies.comp
constexpr std::size_t kBytes = 3 * 4 * sizeof(float);

}  // namespace

PlaneHomographies::PlaneHomographies()
    : program_(gl::Program::compute(display_and_lookup_shaders(), "homographies.comp")),
      records_(GL_RGBA32F, 4096, "homographies of triangles") {}

void PlaneHomographies::update(std::size_t triangles, GLuint unit) {
  records_.reserve(triangles * kBytes);
  program_.set("triangle_count", static_cast<int>(triangles));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kHomographies, records_.buffer().name());
  program_.dispatch(static_cast<int>(triangles));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  glBindTextureUnit(unit, records_.texture());
}

}  // namespace foresight
