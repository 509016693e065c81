// Writes new colours: heights of new pages, re-levelled pages, and the extraction itself.
#pragma once

#include <array>
#include <span>

#include "texture_gpu/atlas_store.hpp"
#include "texture_gpu/published_textures.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

class FrameGate;

/// One context. Leaves the colours visible to texture fetches and image loads that follow.
class ExtractPass {
 public:
  /// `lenses`: of all cameras.
  explicit ExtractPass(std::span<const Lens> lenses);

  /// Sends the heights of pages that were just given a slot (heights.comp).
  void upload_heights(const ChartAtlas& atlas, std::span<const std::pair<std::uint32_t, int>> pages,
                      const AtlasStore& store);

  /// Fills pages of charts whose resolution changed from `published` (relevel.comp).
  void relevel(std::span<const PageJob> jobs, const gl::BufferTexture& charts, const PublishedTextures& published,
               const AtlasStore& store);

  struct Work {
    std::span<const PageJob> jobs;
    std::span<const std::uint8_t> masks;        ///< of each job (ChartAtlas::Allocation)
    std::span<const Eigen::Vector4f> geometry;  ///< ChartAtlas::write_job_geometry()
    /// Texels of more pixels than this along a side take the mean of what they cover: up to eight
    /// times as many from the image, beyond from its coarser levels.
    double minify_above = 1.5;
    std::int64_t image = 0;  ///< its number: old colours age with every eighth, in turns
  };
  /// The next extract() compiles what later ones need.
  void prepare() { prepares_ = true; }

  /// Extracts the images of `inputs` into all jobs (extract.comp); tiles that no camera sees are
  /// carried over (copy.comp).
  /// `gate`: in slices; may be null.
  void extract(const Work& work, const SeenInputs& inputs, const AtlasStore& store, double depth_tolerance,
               FrameGate* gate = nullptr);

  /// Of the last extract(): its jobs, and for each tile of each what holes.glsl notes.
  const gl::BufferTexture& jobs() const { return jobs_; }
  const gl::BufferTexture& holes() const { return holes_; }
  std::vector<std::uint32_t> read_holes(std::size_t jobs) const;  ///< waits for the GPU
  std::size_t tiles() const { return tile_count_; }               ///< of the last extract() that a camera may see
  std::size_t copied() const { return unseen_tiles_.size(); }     ///< the other tiles of its pages

 private:
  gl::Program heights_, relevel_, copy_;
  static constexpr std::size_t kSizes = 5;       // of texels in pixels, as TEXELS in extract.comp
  std::array<gl::Program, 2 * kSizes> extract_;  // kSizes * (cameras - 1) + size
  void sort_tiles(const Work& work, const SeenInputs& inputs);
  void run(std::size_t size, std::int64_t image, const SeenInputs& inputs, double depth_tolerance, FrameGate* gate);

  gl::BufferTexture jobs_, geometry_, relevel_jobs_, tiles_[kSizes], copy_tiles_, holes_, staged_, slots_;
  std::array<std::vector<std::uint32_t>, kSizes> seen_tiles_;  // by size; job << 4 | tile << 2 | cameras
  std::vector<std::uint32_t> unseen_tiles_;
  std::size_t tile_count_ = 0;
  gl::Sampler by_levels_;  // of images
  bool prepares_ = false;  // with the next extract()
};

/// Runs a one-dimensional dispatch of any length: the API allows 65,535 groups at once. The
/// program's uniform `first_group` tells where each part begins.
void dispatch_groups(const gl::Program& program, std::size_t count);
/// The same in slices of `kind`, whose units are groups.
void dispatch_slices(const gl::Program& program, std::size_t count, FrameGate* gate, const char* kind);

}  // namespace foresight
