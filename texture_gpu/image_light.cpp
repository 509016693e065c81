#include "texture_gpu/image_light.hpp"

#include <utility>

namespace foresight {

ImageLight::ImageLight(std::shared_ptr<const SceneModel> scene, std::shared_ptr<const gl::SceneBuffers> buffers,
                       bool awaits)
    : buffers_(std::move(buffers)), finder_(std::move(scene), awaits) {}

bool ImageLight::find_lamp(const FrameOnGpu& frame, double depth_tolerance) {
  const PosedImage& image = frame.images[0];
  if (!finder_.look(image.scene)) return false;
  if (witnesses_ != finder_.number()) witness_pass_.set_witnesses(finder_.witnesses());
  witnesses_ = finder_.number();
  finder_.add(image.scene, image.T_world_camera.translation(),
              witness_pass_.brightness(frame.inputs, image.T_world_camera, depth_tolerance));
  return true;
}

bool ImageLight::take_out_shadows(const FrameOnGpu& frame, bool rehearses, const gl::SamplerReset& reset_samplers) {
  const auto& lamp = finder_.lamp();
  if (!lamp && !rehearses) {
    known_.reset();
    return false;
  }
  if (rehearses)
    known_ = std::make_shared<const SceneLight>(light_from_above(*buffers_, frame.images[0].scene));
  else if (!known_ || known_->lamp != *lamp || known_->moving != finder_.moving())
    known_ =
        std::make_shared<const SceneLight>(SceneLight{*lamp, finder_.moving(), finder_.answer().told_by_what_moves});
  take_out_shadows(frame, *known_, reset_samplers);
  return true;
}

void ImageLight::take_out_shadows(const FrameOnGpu& frame, const SceneLight& light,
                                  const gl::SamplerReset& reset_samplers) {
  if (!map_) map_ = std::make_unique<ShadowMap>(buffers_);
  bool shaded = false;
  for (std::size_t i = 0; i < frame.images.size(); ++i) {
    const PosedImage& image = frame.images[i];
    const CameraInput& camera = *frame.cameras[i];
    if (i == 0 || image.time != frame.time()) shaded = map_->update(light, image.scene);
    if (!shaded) continue;
    if (i >= shadows_.size()) shadows_.emplace_back(camera.lens());
    shadows_[i]({camera.lens(), camera.block(), camera.faces(), camera.rays(), image.T_world_camera}, *map_);
    shadows_[i].take_out_of(camera.image());
    reset_samplers();
  }
}

}  // namespace foresight
