// Fills holes: texels that no camera has seen take colours from around them, per chart.
#pragma once

#include "texture_gpu/extract_pass.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight {

/// Push-pull over each chart's pyramid (after Gortler et al. 1996; thesis, 5.2.2): means go up
/// through the pages' levels and the charts' page grids, and come down again where nothing was
/// seen. Filled texels are marked, so that seen ones replace them. One context.
class FillPass {
 public:
  explicit FillPass(const SurfacePatches& surface);

  struct Work {
    std::size_t job_count = 0;                     ///< of the last extraction
    std::span<const std::uint32_t> dirty;          ///< charts of which a page changed
    std::span<const std::uint32_t> chart_of_page;  ///< for the whole page table of `next`
    std::span<const std::array<int, 3>> kept;      ///< runs of pages to keep: first before, first now, count
  };
  /// Writes the pyramids of the jobs, and the coarse colours and chart means of `next`, starting
  /// from those of `previous`. `gate`: in slices; may be null.
  void operator()(const ExtractPass& extracted, const Work& work, const AtlasStore& store,
                  const PublishedTextures& previous, PublishedTextures& next, FrameGate* gate = nullptr);

 private:
  void push(std::size_t job_count, const AtlasStore& store) const;
  void means(const Work& work, const AtlasStore& store, const PublishedTextures& previous, PublishedTextures& next);
  void spread(const PublishedTextures& next) const;
  void pull(std::size_t job_count, const gl::BufferTexture& holes, const AtlasStore& store,
            const PublishedTextures& next);
  void list_holes(const gl::Program& program, std::size_t job_count, std::size_t most, const gl::BufferTexture& holes,
                  const AtlasStore& store);

  int turn_ = 0;
  gl::Program push_, push_rest_, coarse_, coarse_fill_, spread_, hole_jobs_, hole_tiles_;
  std::array<gl::Program, 4> pull_;  // by the level written
  gl::BufferTexture neighbour_start_, neighbours_, dirty_, chart_of_page_, spare_means_;
  WorkList with_holes_, empty_pages_;
  int chart_count_;
};

}  // namespace foresight
