#include "texture_gpu/thesis/pyramid_filling.hpp"

#include <algorithm>

namespace foresight::thesis {

PyramidFilling::PyramidFilling(int max_texture)
    : reduce_(texel_program("reduce.frag")), expand_(texel_program("expand.frag")) {
  for (int size = max_texture / 2; size > 0; size /= 2)
    levels_.push_back(smooth_texture(GL_RGBA8, size, size, "hole filling pyramid"));
}

void PyramidFilling::operator()(const gl::Texture& texture, int s, int t, const TexelDrawing& drawing) const {
  std::vector<Eigen::Vector2i> sizes{{s, t}};
  while (sizes.back().maxCoeff() > 1) sizes.push_back((sizes.back() / 2).cwiseMax(1));
  const auto level = [&](std::size_t i) -> const gl::Texture& { return i == 0 ? texture : levels_[i - 1]; };

  reduce_.use();
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    reduce_.set("taps", (sizes[i - 1].array() / sizes[i].array()).matrix().eval());
    drawing.onto(level(i), sizes[i].x(), sizes[i].y());
    glBindTextureUnit(0, level(i - 1).name());
    drawing.rectangle();
  }

  // Collapsing (section 5.2.4): valid texels stay, the others get the enlarged level below. Valid
  // means alpha 1 and invalid 0, so blending by the target's alpha is that choice, in place.
  expand_.use();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_DST_ALPHA);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  for (std::size_t i = sizes.size() - 1; i > 0; --i) {
    expand_.set("source", sizes[i]);
    expand_.set("scale", sizes[i].cast<float>().cwiseQuotient(sizes[i - 1].cast<float>()).eval());
    drawing.onto(level(i - 1), sizes[i - 1].x(), sizes[i - 1].y());
    glBindTextureUnit(0, level(i).name());
    drawing.rectangle();
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_BLEND);
}

}  // namespace foresight::thesis
