#include "display/kept_pass.hpp"

#include <array>

#include "display/shaders.hpp"
#include "gl/camera_block.hpp"

namespace foresight {
namespace {

constexpr GLuint kImagesBlock = 1, kImagesUnit = 16, kStillUnit = 23;  // as in view.glsl and kept.glsl
constexpr double kOutOfSight = 1e6;                                    // m

/// Its pose and nodes, but what stood elsewhere than in `newest` where no camera sees it.
PosedImage at_rest(const PosedImage& image, const PosedImage& newest) {
  PosedImage out = image;
  for (std::size_t i = 0; i < out.scene.T_world_node.size(); ++i)
    if (!is_at_rest(newest.scene.T_world_node[i], image.scene.T_world_node[i]))
      out.scene.T_world_node[i].translation().setConstant(kOutOfSight);
  return out;
}

Eigen::Vector3f tone_beside(const PublishedImage& image, const PublishedImage& newest) {
  return {image.tone.x() * newest.gain / image.gain, image.tone.y(), image.tone.z()};
}

}  // namespace

void KeptPass::compile(const NewestImages& images, const Lens& view) {
  std::vector<Lens> lenses{view, images.newest->camera->lens()};
  for (const auto& other : images.others) lenses.push_back(other->camera->lens());
  auto defines = gl::camera_defines(lenses);
  for (const char* define : {"CASES 0", "LISTED 0", "BLENDED 0", "BEFORE 0", "HOMOGRAPHIES 0", "KEPT 1"})
    defines.emplace_back(define);
  defines.push_back("LEVELS " + std::to_string(levels_));
  if (program_ && defines == defines_) return;
  program_ = gl::Program::compute(display_and_lookup_shaders(), "view.comp", defines);
  defines_ = std::move(defines);
}

void KeptPass::choose(const NewestImages& images, const Lens& view, const Pose& T_world_eye) {
  const std::vector<ChosenImage> chosen = choose_images(images, T_world_eye);
  count_ = chosen.size();
  if (count_ == 0) return;
  compile(images, view);
  const PublishedImage& newest = *images.newest;
  still_ = newest.still.name();
  sharp_ = newest.sharp;
  white_balance_ = newest.white_balance_of_textures;
  if (places_.size() < count_) places_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    const PublishedImage& image = *chosen[i].image;
    const PosedImage shown = at_rest(image.image, newest.image);
    places_[i].image = chosen[i];
    places_[i].inputs.update(std::array<const CameraInput*, 2>{image.camera.get(), newest.camera.get()},
                             std::array<const PosedImage*, 2>{&shown, &newest.image},
                             std::array{tone_beside(image, newest), newest.tone});
  }
}

void KeptPass::operator()(GLuint pixels_image, const std::function<void(const gl::Program&)>& draw) const {
  for (std::size_t i = 0; i < count_; ++i) {
    const Chosen& one = places_[i];
    one.inputs.bind(program_, one.image.image->depth_tolerance, kImagesBlock, kImagesUnit);
    one.inputs.bind_pixels(pixels_image);
    glBindTextureUnit(kStillUnit, still_);
    program_.set("sharp", sharp_);
    program_.set("white_balance", white_balance_);
    program_.set("age", static_cast<float>(one.image.age));
    program_.set("claim", one.image.claim);
    draw(program_);
  }
}

}  // namespace foresight
