// Asks the GPU, for every page that might be in view: who may see it, and how bright is it there?
#pragma once

#include <span>
#include <vector>

#include "texture_gpu/atlas_store.hpp"
#include "texture_gpu/exposure.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

/// The only passes whose answers come back to the CPU: pages are allocated there. One context.
class SurveyPass {
 public:
  SurveyPass();

  /// Uploads the pages to be asked about.
  void set_pages(std::span<const PageRecord> pages);

  /// One mask per page: bit 2 * tile + camera (cull.comp). Waits for the GPU.
  std::vector<std::uint32_t> cull(const SeenInputs& inputs, const gl::BufferTexture& charts, double depth_tolerance);

  /// One sample per page as `camera` sees it now (exposure.comp). Waits for the GPU.
  std::vector<ExposureSample> brightness(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                         const AtlasStore& store, int camera, double depth_tolerance);

 private:
  gl::Program cull_, exposure_;
  gl::BufferTexture pages_;
  gl::Buffer masks_, samples_;
  int page_count_ = 0;
};

}  // namespace foresight
