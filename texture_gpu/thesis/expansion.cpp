#include "texture_gpu/thesis/expansion.hpp"

#include <utility>

namespace foresight::thesis {

ExpansionPass::ExpansionPass(const gl::Faces& plane)
    : masks_{smooth_texture(GL_R8, plane.width, plane.height, "alpha mask 0"),
             smooth_texture(GL_R8, plane.width, plane.height, "alpha mask 1")},
      dilate_(texel_program("dilate.frag")),
      halve_(texel_program("scale_mask.frag", {"STEP 2.0", "LIMIT 0.75"})),     // eq. 5.1
      double_(texel_program("scale_mask.frag", {"STEP 0.5", "LIMIT 0.9375"})),  // eq. 5.2
      copy_(texel_program("copy_mask.frag")) {
  // The masks are read like the alpha of a colour texture.
  for (const gl::Texture& mask : masks_) glTextureParameteri(mask.name(), GL_TEXTURE_SWIZZLE_A, GL_RED);
}

void ExpansionPass::operator()(const PerspectiveTexture& texture, const BoundingBox& box, Expansion method,
                               int iterations, const TexelDrawing& drawing) const {
  if (method == Expansion::none || iterations <= 0 || std::min(box.width, box.height) < kSmallest) return;
  if (method == Expansion::shader)
    dilate(texture, box, iterations, drawing);
  else
    scale(texture, box, method == Expansion::progressive, iterations, drawing);
}

/// The mask becomes the alpha channel of the perspective texture.
void ExpansionPass::write_back(const gl::Texture& mask, const PerspectiveTexture& texture, const BoundingBox& box,
                               const TexelDrawing& drawing) const {
  copy_.use();
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
  drawing.onto(texture.texture(), box.width, box.height);
  glBindTextureUnit(0, mask.name());
  drawing.rectangle();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void ExpansionPass::dilate(const PerspectiveTexture& texture, const BoundingBox& box, int iterations,
                           const TexelDrawing& drawing) const {
  dilate_.use();
  dilate_.set("size", Eigen::Vector2i(box.width, box.height));
  const gl::Texture* from = &texture.texture();
  for (int i = 0; i < iterations; ++i) {
    drawing.onto(masks_[i % 2], box.width, box.height);
    glBindTextureUnit(0, from->name());
    drawing.rectangle();
    from = &masks_[i % 2];
  }
  write_back(*from, texture, box, drawing);
}

void ExpansionPass::scale(const PerspectiveTexture& texture, const BoundingBox& box, bool progressive, int iterations,
                          const TexelDrawing& drawing) const {
  // Sizes on the way down; on the way up the same, so that an odd size comes back.
  const auto half = [](const Eigen::Vector2i& size) { return Eigen::Vector2i((size + Eigen::Vector2i(1, 1)) / 2); };
  std::vector<Eigen::Vector2i> sizes{{box.width, box.height}};
  for (int i = 0; i < (progressive ? iterations : 1); ++i) sizes.push_back(half(sizes.back()));
  const gl::Texture* from = &texture.texture();
  int next = 0;
  const auto draw = [&](const gl::Program& program, const Eigen::Vector2i& source, const Eigen::Vector2i& target) {
    program.use();
    program.set("source", source);
    drawing.onto(masks_[next], target.x(), target.y());
    glBindTextureUnit(0, from->name());
    drawing.rectangle();
    from = &masks_[next];
    next = 1 - next;
  };
  for (int round = 0; round < (progressive ? 1 : iterations); ++round) {
    for (std::size_t i = 0; i + 1 < sizes.size(); ++i) draw(halve_, sizes[i], sizes[i + 1]);
    for (std::size_t i = sizes.size() - 1; i > 0; --i) draw(double_, sizes[i], sizes[i - 1]);
  }
  write_back(*from, texture, box, drawing);
}

}  // namespace foresight::thesis
