#include "texture_gpu/thesis/shader_filling.hpp"

#include <algorithm>

namespace foresight::thesis {
namespace {

void copy(const gl::Texture& from, const gl::Texture& to, int s, int t) {
  glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, 0, 0, 0, to.name(), GL_TEXTURE_2D, 0, 0, 0, 0, s, t, 1);
}

}  // namespace

ShaderFilling::ShaderFilling(int max_texture)
    : frame_(GL_RGBA8, max_texture, max_texture, 0, 1, "hole filling"),
      previous_(GL_RGBA8, max_texture, max_texture, 0, 1, "hole filling, previous pass"),
      one_stage_(texel_program("fill.frag", {"TWO_STAGES 0"})),
      two_stages_(texel_program("fill.frag", {"TWO_STAGES 1"})),
      restore_(texel_program("copy_colour.frag")) {
  for (gl::Query& query : queries_) {
    GLuint name = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &name);
    query = gl::Query(name);
  }
}

int ShaderFilling::operator()(const gl::Texture& texture, int s, int t, Method method, const TexelDrawing& drawing) {
  copy(texture, frame_, s, t);
  const gl::Program& program = method.two_stages ? two_stages_ : one_stage_;
  const int most = std::max(s - 1, t - 1);  // eq. 5.30
  int passes = 0;
  for (; passes < most; ++passes) {
    const gl::Query& query = queries_[passes % 2];
    if (method.query && passes >= 2) {
      GLuint changed = 0;  // by the pass before the last
      glGetQueryObjectuiv(query.name(), GL_QUERY_RESULT, &changed);
      if (changed == 0) break;
    }
    copy(frame_, previous_, s, t);
    program.use();
    program.set("size", Eigen::Vector2i(s, t));
    drawing.onto(frame_, s, t);
    glBindTextureUnit(0, previous_.name());
    if (method.query) glBeginQuery(GL_SAMPLES_PASSED, query.name());
    drawing.rectangle();
    if (method.query) glEndQuery(GL_SAMPLES_PASSED);
  }
  restore_.use();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  drawing.onto(texture, s, t);
  glBindTextureUnit(0, frame_.name());
  drawing.rectangle();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  return passes;
}

}  // namespace foresight::thesis
