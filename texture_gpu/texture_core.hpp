// From posed camera images to textures: the order of the passes for one frame.
#pragma once

#include <memory>
#include <vector>

#include "gl/sampler_reset.hpp"
#include "texture_gpu/accumulation_pass.hpp"
#include "texture_gpu/colour_balance.hpp"
#include "texture_gpu/edge_pass.hpp"
#include "texture_gpu/extract_pass.hpp"
#include "texture_gpu/extraction_report.hpp"
#include "texture_gpu/fill_list.hpp"
#include "texture_gpu/generation_pool.hpp"
#include "texture_gpu/image_light.hpp"
#include "texture_gpu/image_places.hpp"
#include "texture_gpu/kept_images.hpp"
#include "texture_gpu/old_shadows.hpp"
#include "texture_gpu/page_ages.hpp"
#include "texture_gpu/still_pass.hpp"
#include "texture_gpu/survey_pass.hpp"
#include "texture_gpu/white_balance.hpp"

namespace foresight {

/// Owns the atlas and all passes. Belongs to one thread and one context, in a share group with
/// the display's.
class TextureCore {
 public:
  /// `scene` and `surface` describe the same model. Throws RuntimeFailure (shaders, memory).
  TextureCore(const std::shared_ptr<const SceneModel>& scene, const std::shared_ptr<const SurfacePatches>& surface,
              const Lens& left, const std::optional<Lens>& right, const TextureOptions& options,
              bool software_renderer);

  /// Extracts one frame and publishes the result to `latest`. Blocks until the GPU is done; waits
  /// up to a few seconds for the display to give back old generations. Throws RuntimeFailure: out
  /// of texture memory at the lowest resolution, context lost.
  ExtractionReport process(const PosedFrame& frame, LatestTextures& latest);

  /// From now on it works in slices, when a display leaves time for them. `gate` outlives this; null: at once.
  void use(FrameGate* gate) { gate_ = gate; }

  /// What comes now is a rehearsal, for programs to be compiled: texels of any size are extracted, and from the fourth
  /// image on, with TextureOptions::shadows, a lamp above the scene is taken to be known.
  void rehearse() {
    rehearses_ = true;
    extract_.prepare();
  }

  /// The same in two steps. The first makes the image ready to be looked up, and publishes that; the textures follow.
  /// False where there are no textures yet, beside which it could be shown: nothing is published then.
  bool look(const PosedFrame& frame, LatestImages& latest);
  /// Of the frame that look() was given. Where views look the newest images up, only what is needed is extracted
  /// (TextureOptions): what no image showed before, and what the image before shows, which is published with this one,
  /// and this one does not. `images`, as look() was given it: the image before is lent no more once the latter is
  /// there.
  ExtractionReport extract(LatestTextures& latest, LatestImages* images = nullptr);

  /// Until nothing that these have begun goes on in another thread, as a search for the lamp does: for those who
  /// measure what an image costs.
  void wait_for_search() const { light_.wait_for_search(); }

 private:
  using Masks = std::vector<std::uint32_t>;  // of tiles, for each page of the last plan (SurveyPass::cull)

  void mark(const char* stage);
  void look(const PosedFrame& frame);
  void publish(LatestImages& latest);
  void accumulate();
  void keep_newest();
  std::shared_ptr<const NewestImages> lend(bool with_before) const;
  void compare_with_textures();
  std::vector<PageRecord> pages_of_exposure() const;
  void estimate_exposure();
  bool is_exposure_known(std::size_t camera) const;
  bool save_what_leaves(LatestTextures& latest);
  SurveyPass::Missed not_shown(const SeenInputs& inputs, const std::vector<AtlasView>& views, const Masks& tiles);
  bool allocate(ChartAtlas::Allocation& out);
  bool place(const Masks& wanted, std::int64_t image, ChartAtlas::Allocation& out);
  Masks needed();
  void note_light();
  void take_out_old_shadows(LatestTextures& latest);
  void write(const FrameOnGpu& frame, ChartAtlas::Allocation allocation, LatestTextures& latest,
             const OldShadows::Pages* in_old_shadows = nullptr);
  void fill_and_finish(const ChartAtlas::Allocation& allocation, PublishedTextures& next);
  void count(const ChartAtlas::Allocation& allocation);
  ExtractionReport report();

  std::shared_ptr<const SurfacePatches> surface_;
  TextureOptions options_;
  ChartAtlas atlas_;
  AtlasStore store_;
  ImagePlaces places_;
  KeptImages kept_images_;
  std::unique_ptr<StillPass> still_pass_;                // where images are kept
  std::unique_ptr<AccumulationPass> accumulation_pass_;  // where they are accumulated
  std::vector<ExposureEstimator> exposures_;
  WhiteBalance white_balance_;  // of the left camera
  ColourBalance balance_;
  cv::Mat left_, right_;  // the newest images as they came
  SharpnessEstimator sharpness_;
  std::shared_ptr<const gl::SceneBuffers> buffers_;
  gl::RasterPass raster_;
  EdgePass edges_;
  SurveyPass survey_;
  ExtractPass extract_;
  FillPass fill_;
  FillList fill_list_;
  ImageLight light_;
  OldShadows old_shadows_;
  bool lit_ = false;                 // with the image in work
  std::int64_t light_changed_ = -1;  // the image from which on textures are in this light
  RobotTime in_light_since_;         // when it was taken
  bool rehearses_ = false;
  StageClock clock_;
  gl::SamplerReset reset_samplers_;
  FrameGate* gate_ = nullptr;

  FrameOnGpu newest_, before_;
  SeenInputs both_;              // the left images of the two
  bool looked_up_ = false;       // views know the newest image itself
  bool right_is_alike_ = false;  // the newest frame's right image can be shown beside the left one
  bool owed_ = false;            // not all of the newest image is in the textures
  std::span<const PageRecord> records_;
  Masks seen_;                // what the newest image shows of them
  ExtractionReport done_;     // for the frame in work, so far
  gl::BufferTexture charts_;  // planned resolutions, before they are part of a generation
  std::vector<Eigen::Vector4f> chart_rows_, geometry_;
  std::vector<std::uint32_t> table_;
  PageAges ages_;

  GenerationPool generations_;
  GenerationPool::Generation current_;
  std::int64_t image_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace foresight
