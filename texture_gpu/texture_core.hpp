// From posed camera images to textures: the order of the passes for one frame.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "gl/sampler_reset.hpp"
#include "texture_gpu/accumulation_pass.hpp"
#include "texture_gpu/edge_pass.hpp"
#include "texture_gpu/extract_pass.hpp"
#include "texture_gpu/extraction_report.hpp"
#include "texture_gpu/fill_pass.hpp"
#include "texture_gpu/generation_pool.hpp"
#include "texture_gpu/image_places.hpp"
#include "texture_gpu/kept_images.hpp"
#include "texture_gpu/lamp/lamp_finder.hpp"
#include "texture_gpu/shadow_pass.hpp"
#include "texture_gpu/still_pass.hpp"
#include "texture_gpu/survey_pass.hpp"
#include "texture_gpu/witness_pass.hpp"

namespace foresight {

/// Owns the atlas and all passes. Belongs to one thread and one context, in a share group with
/// the display's.
class TextureCore {
 public:
  /// `scene` and `surface` describe the same model. Throws RuntimeFailure (shaders, memory).
  TextureCore(std::shared_ptr<const SceneModel> scene, const std::shared_ptr<const SurfacePatches>& surface,
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
  void wait_for_search() const { lamp_finder_.wait_for_search(); }

 private:
  using Masks = std::vector<std::uint32_t>;  // of tiles, for each page of the last plan (SurveyPass::cull)

  void mark(const char* stage);
  void look(const PosedFrame& frame);
  void find_lamp();
  void take_out_shadows();
  void take_out_shadows(const SceneLight& light);
  void publish(LatestImages& latest);
  void accumulate();
  void keep_newest();
  std::shared_ptr<const NewestImages> lend(bool with_before) const;
  void compare_with_textures();
  void estimate_exposure(int first, int stride);
  bool save_what_leaves(LatestTextures& latest);
  SurveyPass::Missed not_shown(const SeenInputs& inputs, const std::vector<AtlasView>& views, const Masks& tiles);
  bool allocate(ChartAtlas::Allocation& out);
  bool place(const Masks& wanted, std::int64_t image, ChartAtlas::Allocation& out);
  Masks needed();
  void write(const FrameOnGpu& frame, ChartAtlas::Allocation allocation, LatestTextures& latest);
  void list_ages(RobotTime now);
  void list_fill_work(const ChartAtlas::Allocation& allocation);
  void fill_and_finish(const ChartAtlas::Allocation& allocation, PublishedTextures& next);
  void count(const ChartAtlas::Allocation& allocation);
  ExtractionReport report();

  std::shared_ptr<const SceneModel> scene_;
  std::shared_ptr<const SurfacePatches> surface_;
  TextureOptions options_;
  ChartAtlas atlas_;
  AtlasStore store_;
  ImagePlaces places_;
  KeptImages kept_images_;
  std::unique_ptr<StillPass> still_pass_;                // where images are kept
  std::unique_ptr<AccumulationPass> accumulation_pass_;  // where they are accumulated
  std::vector<ExposureEstimator> exposures_;
  SharpnessEstimator sharpness_;
  std::shared_ptr<const gl::SceneBuffers> buffers_;
  gl::RasterPass raster_;
  EdgePass edges_;
  SurveyPass survey_;
  ExtractPass extract_;
  FillPass fill_;
  LampFinder lamp_finder_;
  WitnessPass witness_pass_;
  int witnesses_ = 0;                        // LampFinder::number() of those that the pass has
  std::shared_ptr<const SceneLight> light_;  // null as long as it is not known
  RobotTime light_since_;
  bool lit_ = false;                 // with the image in work
  std::int64_t light_changed_ = -1;  // the image from which on it is, or is no more
  bool rehearses_ = false;
  std::unique_ptr<ShadowMap> shadow_map_;  // from then on, or since they were prepared
  std::vector<ShadowPass> shadows_;        // one for each camera
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
  std::vector<std::uint32_t> table_, dirty_, chart_of_page_;
  std::vector<std::array<int, 3>> kept_;
  std::vector<int> first_page_before_;  // of the published generation
  std::deque<RobotTime> image_times_;   // of the last images
  std::vector<float> ages_;

  GenerationPool generations_;
  GenerationPool::Generation current_;
  std::int64_t image_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace foresight
