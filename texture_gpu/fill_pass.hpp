// Fills holes: texels that no camera has seen take colours from around them, per chart.
#pragma once

#include "texture_gpu/extract_pass.hpp"

namespace foresight {

/// Push-pull over each chart's pyramid (after Gortler et al. 1996; thesis, 5.2.2): means go up
/// through the pages' levels and the charts' page grids, and come down again where nothing was
/// seen. Filled texels are marked, so that seen ones replace them. One context.
class FillPass {
 public:
  explicit FillPass(const SurfacePatches& surface);

  /// For the jobs of the last extraction. `dirty`: per chart, 1 where a page changed. Writes the
  /// coarse colours and chart means of `next`, starting from those of `previous`.
  void operator()(const ExtractPass& extracted, std::size_t job_count, std::span<const std::uint32_t> dirty,
                  const AtlasStore& store, const PublishedTextures& previous, PublishedTextures& next);

 private:
  void push(std::size_t job_count, const AtlasStore& store) const;
  void means(std::span<const std::uint32_t> dirty, const AtlasStore& store, const PublishedTextures& previous,
             PublishedTextures& next);
  void pull(std::size_t job_count, const gl::BufferTexture& holes, const AtlasStore& store,
            const PublishedTextures& next) const;

  gl::Program push_, push_rest_, coarse_, spread_;
  std::array<gl::Program, 4> pull_;  // by the level written
  gl::BufferTexture neighbour_start_, neighbours_, dirty_, spare_means_;
  int chart_count_;
};

}  // namespace foresight
