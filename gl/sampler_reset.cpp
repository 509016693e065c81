#include "gl/sampler_reset.hpp"

#include <array>

#include "gl/context.hpp"

namespace foresight::gl {
namespace {

constexpr GLint kUnit = 31;  // no pass uses it
constexpr std::size_t kPlaces = 16;

}  // namespace

SamplerReset::SamplerReset() {
  if (!query_driver().is_software) return;
  program_ = Program::compute(gl_shaders(), "sampler_reset.comp");
  std::array<GLint, kPlaces> units{};
  units.fill(kUnit);
  glProgramUniform1iv(program_.name(), glGetUniformLocation(program_.name(), "places"), kPlaces, units.data());
  texture_ = Texture(GL_R8, 3, 3, 0, 1, "no sampler");
  (*this)();
}

void SamplerReset::operator()() const {
  if (!program_) return;
  glBindTextureUnit(kUnit, texture_.name());
  program_.dispatch(1);
}

}  // namespace foresight::gl
