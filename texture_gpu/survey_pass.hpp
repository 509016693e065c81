// Asks the GPU, for every page that might be in view: who may see it, how bright is it there, and how well does it
// agree?
#pragma once

#include <span>
#include <vector>

#include "texture_gpu/atlas_store.hpp"
#include "texture_gpu/exposure.hpp"
#include "texture_gpu/published_textures.hpp"
#include "texture_gpu/seen_inputs.hpp"
#include "texture_gpu/sharpness.hpp"

namespace foresight {

class FrameGate;

/// The only passes whose answers come back to the CPU: pages are allocated there. One context.
class SurveyPass {
 public:
  /// `lenses`: of all cameras.
  explicit SurveyPass(std::span<const Lens> lenses);

  /// Uploads the pages that cull() asks about.
  void set_pages(std::span<const PageRecord> pages);

  /// One mask per page: bit 2 * tile + camera (cull.comp). Waits for the GPU. `gate`: in slices; may be null.
  std::vector<std::uint32_t> cull(const SeenInputs& inputs, const gl::BufferTexture& charts, double depth_tolerance,
                                  FrameGate* gate = nullptr);

  /// Which tiles hold points that camera 1 of `inputs` saw and camera 0 does not show, or less well (missed.comp).
  struct Missed {
    std::vector<std::uint32_t> masks;   ///< one a page: of `seen`, the bits of such tiles
    std::vector<std::uint32_t> hidden;  ///< likewise, of tiles of which camera 0 shows nothing, as far as was asked
    std::vector<std::size_t> coarser;   ///< pages that camera 0 shows, but below `worse` of camera 1's resolution
  };
  /// Of the tiles in `seen`, which has a mask for each page as cull() gives them; their heights are there. `geometry`:
  /// ChartAtlas::write_page_geometry() for them and both cameras. Waits for the GPU. `gate`: as above.
  Missed missed(const SeenInputs& inputs, std::span<const Eigen::Vector4f> geometry, const AtlasStore& store,
                std::span<const std::uint32_t> seen, double depth_tolerance, double worse, FrameGate* gate = nullptr);

  /// Samples of `pages` as `camera` sees them now (exposure.comp). Waits for the GPU.
  std::vector<ExposureSample> brightness(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                         const AtlasStore& store, std::span<const PageRecord> pages, int camera,
                                         double depth_tolerance);

  /// How well the first camera's image agrees with `textures` on `pages` (agreement.comp). Waits for the GPU.
  std::vector<AgreementSample> agreement(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                         const AtlasStore& store, std::span<const PageRecord> pages,
                                         const PublishedTextures& textures, double depth_tolerance);

 private:
  std::vector<std::uint32_t> ask_tiles(const gl::Program& program, std::span<const std::uint32_t> tiles,
                                       FrameGate* gate, const char* kind);

  void bind_pages(const gl::Program& program, const gl::BufferTexture& charts, const AtlasStore& store,
                  std::span<const PageRecord> pages);

  gl::Program cull_, exposure_, agreement_, perhaps_missed_, missed_;
  gl::BufferTexture pages_, asked_pages_, tiles_, geometry_;
  gl::Buffer masks_, samples_, answers_;
  int page_count_ = 0;
};

}  // namespace foresight
