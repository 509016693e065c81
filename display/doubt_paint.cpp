#include "display/doubt_paint.hpp"

#include "display/shaders.hpp"

namespace foresight {
namespace {

constexpr std::size_t kInOne = 16;  // classes of two bits in a word, as in doubt.comp
using ClassWords = std::array<GLuint, 256 / kInOne>;

ClassWords packed_classes(const KindRisks& risks) {
  ClassWords out{};
  for (std::size_t doubt = 0; doubt < out.size() * kInOne; ++doubt)
    out[doubt / kInOne] |= class_of(doubt, risks) << (2 * (doubt % kInOne));
  return out;
}

}  // namespace

unsigned class_of(std::size_t doubt, const KindRisks& risks) {
  if (doubt >= risks.size()) return 3;
  return risks[doubt] <= kRarelyWrong ? 0 : risks[doubt] <= kOftenWrong ? 1 : 2;
}

DoubtPaint::DoubtPaint() : program_(gl::Program::compute(display_and_lookup_shaders(), "doubt.comp")) {}

const gl::Texture& DoubtPaint::operator()(const gl::Texture& shown, const gl::Texture& doubt, const KindRisks& risks) {
  const int width = shown.width(), height = shown.height();
  if (!picture_ || picture_.width() != width || picture_.height() != height)
    picture_ = gl::Texture(GL_RGBA8, width, height, 0, 1, "painted by doubt");
  const ClassWords classes = packed_classes(risks);
  glProgramUniform1uiv(program_.name(), glGetUniformLocation(program_.name(), "classes"),
                       static_cast<GLsizei>(classes.size()), classes.data());
  glBindTextureUnit(0, shown.name());
  glBindTextureUnit(1, doubt.name());
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  program_.dispatch(width, height);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  return picture_;
}

}  // namespace foresight
