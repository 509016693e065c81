#include "display/view_session.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "display/rehearsal.hpp"

namespace foresight {
namespace {

constexpr double kDrawTimeout = 20;       // seconds
constexpr std::size_t kMostDrawings = 2;  // in work at once: more would only make the picture older

}  // namespace

std::shared_ptr<const SurfacePatches> surface_for(const SceneModel& scene, const Lens& lens,
                                                  std::span<const ExpectedView> views) {
  PatchOptions patches;
  patches.chart_extent = chart_extent_for(scene, lens, views);
  return std::make_shared<const SurfacePatches>(find_surface_patches(scene, patches));
}

ViewSession::ViewSession(gl::Context& context, const ViewSetup& setup)
    : driver_(gl::query_driver()),
      lens_(setup.left),
      scene_(setup.scene),
      surface_(setup.surface),
      newest_image_(setup.newest_image && setup.textures.images > 0 && !setup.thesis) {
  gl::set_up_context();
  if (setup.thesis) {
    thesis_ =
        std::make_unique<thesis::Pipeline>(setup.scene, setup.left, setup.right, *setup.thesis, driver_.is_software);
    thesis_view_ = std::make_unique<ThesisView>(*thesis_, setup.left);
    return;
  }
  thread_ = std::make_unique<TextureThread>(
      context.create_shared(), TextureThread::Setup{setup.scene, setup.surface, setup.left, setup.right, setup.textures,
                                                    newest_image_, setup.gate, setup.rehearses});
  context.make_current();
  buffers_ = std::make_shared<const gl::SceneBuffers>(*setup.scene);
  records_ = std::make_shared<const SurfaceRecords>(*setup.surface);
  if (setup.levels) {
    auto levels = std::make_shared<const SceneLevels>(*setup.scene, setup.surface->patch_of_triangle);
    levels_ = {std::make_shared<const gl::LevelBuffers>(*setup.scene, std::move(levels)), *setup.levels};
  }
  if (setup.rehearses) rehearse(setup);
  const gl::KeptPrograms::Use use(programs_);
  make_own_view(setup);
}

void ViewSession::make_own_view(const ViewSetup& setup) {
  view_ = std::make_unique<PredictedView>(make_view(setup.left));
  view_->mix_silhouettes(setup.silhouettes);
  view_->show_vignetting(true);
}

void ViewSession::rehearse(const ViewSetup& setup) {
  const gl::KeptPrograms::Use use(programs_);
  make_own_view(setup);
  std::optional<TrustPass> trust(make_trust_pass());
  const std::vector<PosedFrame> frames = rehearsal_frames(*setup.scene, setup.left, setup.right);
  std::size_t seen = 0;
  for (const PosedFrame& frame : frames) {
    if (setup.goes_on && !setup.goes_on(seen++, frames.size())) break;
    const PosedImage& image = frame.left;
    const auto look = [&] {
      if (!draw(image.T_world_camera, image.scene)) return;
      const std::vector<double> no_doubt(image.scene.T_world_node.size(), 0.0);
      (*trust)(*view_, image.T_world_camera, image.scene, no_doubt, {});
    };
    trust->saw(image);
    show(frame);
    look();
    follow();
    look();
  }
  finish();
  trust.reset();
  view_.reset();
  thread_->begin_anew();
}

TrustPass ViewSession::make_trust_pass() {
  const gl::KeptPrograms::Use use(programs_);
  return {buffers_, records_, lens_, *view_};
}

std::vector<std::string> ViewSession::level_remarks() const {
  return levels_ ? levels_->buffers->levels()->remarks() : std::vector<std::string>{};
}

std::size_t ViewSession::surface_count() const {
  if (thesis_) return thesis_->textures().polygons().size();
  return static_cast<std::size_t>(
      std::ranges::count_if(surface_->charts, [](const Chart& chart) { return chart.radius > 0; }));
}

ExtractionReport ViewSession::process(PosedFrame frame) {
  if (thesis_) return thesis_->process(frame);
  finish_drawings();
  return thread_->process(std::move(frame));
}

void ViewSession::show(PosedFrame frame) {
  if (!newest_image_) {
    shown_ = process(std::move(frame));
    return;
  }
  finish_drawings();
  thread_->show(std::move(frame));
}

std::optional<ExtractionReport> ViewSession::follow() {
  if (!newest_image_) return std::exchange(shown_, std::nullopt);
  finish_drawings();
  return thread_->follow();
}

void ViewSession::submit(PosedFrame frame) {
  thread_->submit(std::move(frame));
}

std::optional<ExtractionReport> ViewSession::take_report() {
  give_back();
  return thread_->take_report();
}

bool ViewSession::draw(const Pose& T_world_camera, const SceneState& state) {
  if (thesis_) {
    thesis_view_->draw(T_world_camera, state);
    return true;
  }
  if (next_lens_) view_->set_lens(*std::exchange(next_lens_, std::nullopt));
  return draw(*view_, T_world_camera, state);
}

bool ViewSession::draw(PredictedView& view, const Pose& T_world_camera, const SceneState& state) {
  const gl::KeptPrograms::Use use(programs_);  // views make some when these are needed first
  give_back();
  if (drawings_.size() >= kMostDrawings) finish_drawings();
  ImagesLease newest = images();  // before the textures
  TextureLease textures = thread_->textures().acquire();
  if (!textures) return false;
  view.draw(T_world_camera, state, textures, newest);
  drawings_.push_back({std::move(textures), std::move(newest), gl::Fence::insert()});
  gl::check_errors("the predicted view");
  return true;
}

cv::Mat ViewSession::read() {
  if (thesis_) return thesis_view_->read();
  cv::Mat picture = view_->read();
  finish_drawings();
  return picture;
}

cv::Mat ViewSession::read_range() {
  if (!range_) range_.emplace(lens_, view_->faces().faces);
  return range_->read(view_->faces());
}

void ViewSession::finish() {
  glFinish();
  finish_drawings();
}

void ViewSession::give_back() {
  while (!drawings_.empty() && drawings_.front().end.signalled()) drawings_.pop_front();
}

void ViewSession::finish_drawings() {
  for (const Drawing& drawing : drawings_) drawing.end.wait(kDrawTimeout);
  drawings_.clear();
}

}  // namespace foresight
