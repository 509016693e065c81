// The lamp that lights the images: found by the shadows of what moves, which are then taken out of them.
#pragma once

#include <memory>
#include <vector>

#include "gl/sampler_reset.hpp"
#include "texture_gpu/image_places.hpp"
#include "texture_gpu/lamp/lamp_finder.hpp"
#include "texture_gpu/shadow_pass.hpp"
#include "texture_gpu/witness_pass.hpp"

namespace foresight {

/// One context.
class ImageLight {
 public:
  /// `awaits`: as of LampFinder.
  ImageLight(std::shared_ptr<const SceneModel> scene, std::shared_ptr<const gl::SceneBuffers> buffers, bool awaits);

  /// What the frame's left image tells of the lamp; before its shadows are taken out. False: it had nothing to tell.
  bool find_lamp(const FrameOnGpu& frame, double depth_tolerance);

  /// Takes the shadows out of the frame's images, which are in the light then. False where no lamp is known.
  /// `rehearses`: one above the scene is taken to be known. `reset_samplers` runs after each image.
  bool take_out_shadows(const FrameOnGpu& frame, bool rehearses, const gl::SamplerReset& reset_samplers);

  /// Of the last frame; null where no lamp was known.
  const std::shared_ptr<const SceneLight>& known() const { return known_; }
  const LampAnswer& answer() const { return finder_.answer(); }
  /// Until no search is under way.
  void wait_for_search() const { finder_.wait_for_search(); }

 private:
  void take_out_shadows(const FrameOnGpu& frame, const SceneLight& light, const gl::SamplerReset& reset_samplers);

  std::shared_ptr<const gl::SceneBuffers> buffers_;
  LampFinder finder_;
  WitnessPass witness_pass_;
  int witnesses_ = 0;  // LampFinder::number() of those that the pass has
  std::shared_ptr<const SceneLight> known_;
  std::unique_ptr<ShadowMap> map_;   // from the first lamp on
  std::vector<ShadowPass> shadows_;  // one for each camera
};

}  // namespace foresight
