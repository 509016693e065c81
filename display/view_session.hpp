// What a view needs between its images: the texture thread, its published textures, and what draws them.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>

#include "display/predicted_view.hpp"
#include "display/thesis_view.hpp"
#include "display/trust_pass.hpp"
#include "display/view_range.hpp"
#include "display/view_target.hpp"
#include "gl/context.hpp"
#include "gl/kept_programs.hpp"
#include "texture_gpu/chart_extent.hpp"
#include "texture_gpu/texture_thread.hpp"

namespace foresight {

struct ViewSetup {
  std::shared_ptr<const SceneModel> scene;
  std::shared_ptr<const SurfacePatches> surface;  ///< of that scene; not needed with `thesis`
  Lens left;                                      ///< the view is drawn through it, too
  std::optional<Lens> right;
  TextureOptions textures;
  std::optional<thesis::Options> thesis;      ///< that pipeline replaces the texture core
  bool newest_image = true;                   ///< views look the newest image up directly; not with `thesis`
  bool silhouettes = true;                    ///< of the view are mixed (SilhouettePass); not with `thesis`
  std::shared_ptr<FrameGate> gate = nullptr;  ///< TextureThread::Setup::gate; not with `thesis`
  std::optional<LevelSettings> levels{};      ///< of detail, of all views; nothing: in full. Not with `thesis`
  /// All that is done with images is done before the first one comes, with some of its own (rehearsal_frames()), and
  /// what came of it forgotten: for real time, as drivers compile programs at their first use. Not with `thesis`.
  bool rehearses = false;
  /// Is told, before each of these images, how many have been seen and of how many. False: that is enough.
  std::function<bool(std::size_t seen, std::size_t of)> goes_on = {};
};

/// The model's surface, cut into charts of a size that suits such views.
std::shared_ptr<const SurfacePatches> surface_for(const SceneModel& scene, const Lens& lens,
                                                  std::span<const ExpectedView> views);

/// One thread, on which its context is current all the time; the texture core has a thread of its own.
class ViewSession {
 public:
  /// `context`: a window's, or one without; current, and outlives this. Blocks until the core is built. Throws
  /// InputError (a lens that the thesis cannot do), RuntimeFailure. With ViewSetup::rehearses it takes as long as
  /// compilers do: 16 s on two cores where a software renderer has nothing in store.
  ViewSession(gl::Context& context, const ViewSetup& setup);

  const gl::DriverInfo& driver() const { return driver_; }
  /// Surfaces with a texture of their own: the core's charts, the thesis' polygons.
  std::size_t surface_count() const;
  const std::shared_ptr<const SurfacePatches>& surface() const { return surface_; }
  const SceneModel& scene() const { return *scene_; }

  /// Extracts one frame and returns when its textures are there.
  ExtractionReport process(PosedFrame frame);

  /// The same in two steps, so that a view can be drawn in between: the frame is in it, from its image alone; its
  /// textures follow. Without ViewSetup::newest_image the first does it all. TextureThread::show and follow; not with
  /// `thesis`.
  void show(PosedFrame frame);
  std::optional<ExtractionReport> follow();

  /// TextureThread::submit, take_report and replaced: for real time. Not with `thesis`.
  void submit(PosedFrame frame);
  std::optional<ExtractionReport> take_report();
  std::uint64_t replaced() const { return thread_ ? thread_->replaced() : 0; }

  /// The newest textures, or an empty lease before the first. Not with `thesis`.
  TextureLease textures() const { return thread_->textures().acquire(); }
  /// The newest images that views look up, or an empty lease; to be acquired before textures(). Not with `thesis`.
  ImagesLease images() const { return thread_->images().acquire(); }

  /// Draws the view from `T_world_camera` into picture(), with the newest textures. Does not wait for the GPU. False:
  /// the core has not published anything yet.
  bool draw(const Pose& T_world_camera, const SceneState& state);
  /// RGBA8, straight alpha as PredictedView has it, row 0 at the top.
  const gl::Texture& picture() const { return thesis_ ? thesis_view_->picture() : view_->picture(); }

  /// What the last draw() put the model into: for who draws over it. Not with `thesis`.
  const gl::FaceImages& faces() const { return view_->faces(); }

  /// Another view of the same textures, such as that of an eye through its own lens. Not with `thesis`.
  PredictedView make_view(const Lens& lens) const { return {buffers_, records_, lens, ViewPrograms::two, levels_}; }
  /// What cannot be drawn with fewer triangles, and why: sentences for people. None without ViewSetup::levels.
  std::vector<std::string> level_remarks() const;
  /// Draws the model's depth alone. Not with `thesis`.
  gl::RasterPass make_depth_pass() const { return {buffers_, false}; }
  /// The same for such a view.
  bool draw(PredictedView& view, const Pose& T_world_camera, const SceneState& state);
  /// What says how far pixels of the view that was drawn last can be trusted, and that view. Not with `thesis`.
  TrustPass make_trust_pass();
  const PredictedView& view() const { return *view_; }
  /// From the next draw() on, its own view is as large as this lens says (PredictedView::set_lens); what is compared
  /// with images stays so until then. Not with `thesis`.
  void set_lens(const Lens& lens) { next_lens_ = lens; }

  /// Waits until all that was drawn is there.
  void finish();

  /// For whoever measures. Both wait for the GPU. picture() as CV_8UC4 (BGRA); ViewRange::read() of the last draw(),
  /// not with `thesis`.
  cv::Mat read();
  cv::Mat read_range();

  /// Gives back textures that the GPU has finished drawing with. To be called while nothing else is: the texture core
  /// waits for them.
  void give_back();

 private:
  void make_own_view(const ViewSetup& setup);
  void rehearse(const ViewSetup& setup);
  struct Drawing {
    TextureLease textures;
    ImagesLease images;
    gl::Fence end;
  };
  void finish_drawings();

  gl::DriverInfo driver_;
  gl::KeptPrograms programs_;  // of the rehearsal
  Lens lens_;
  std::shared_ptr<const SceneModel> scene_;
  std::shared_ptr<const SurfacePatches> surface_;
  std::shared_ptr<const gl::SceneBuffers> buffers_;
  std::shared_ptr<const SurfaceRecords> records_;
  std::optional<ViewLevels> levels_;
  std::unique_ptr<TextureThread> thread_;
  std::unique_ptr<PredictedView> view_;
  std::optional<Lens> next_lens_;  // of that view
  std::optional<ViewRange> range_;
  std::deque<Drawing> drawings_;  // that the GPU may not have finished
  std::unique_ptr<thesis::Pipeline> thesis_;
  std::unique_ptr<ThesisView> thesis_view_;
  bool newest_image_;
  std::optional<ExtractionReport> shown_;  // of a frame that show() has processed as a whole
};

}  // namespace foresight
