#include "apps/replay_session.hpp"

#include <algorithm>
#include <chrono>
#include <opencv2/imgproc.hpp>

#include "apps/posed_frames.hpp"

namespace foresight {
namespace {

constexpr int kWindowWidth = 1440;
constexpr double kDrawTimeout = 20;  // seconds

}  // namespace

ReplaySession::ReplaySession(const RunFolder& run, const TextureOptions& options,
                             const std::optional<thesis::Options>& thesis, bool window)
    : run_(run), margin_px_(options.margin_px) {
  const Lens& lens = run.lens_left();
  if (window) {
    const int height = kWindowWidth * lens.height() / (3 * lens.width());
    auto opened = std::make_unique<gl::Window>(kWindowWidth, std::max(height, 120), "Foresight replay");
    window_ = opened.get();
    context_ = std::move(opened);
  } else {
    context_ = gl::create_headless_context();
  }
  driver_ = gl::query_driver();
  gl::set_up_context();
  if (window_) comparison_ = std::make_unique<ComparisonWindow>();
  if (thesis) {
    thesis_ = std::make_unique<thesis::Pipeline>(run.scene(), lens, run.lens_right(), *thesis, driver_.is_software);
    thesis_view_ = std::make_unique<ThesisView>(*thesis_, lens);
    return;
  }
  surface_ = surface_for(run);
  thread_ = std::make_unique<TextureThread>(
      context_->create_shared(), TextureThread::Setup{run.scene(), surface_, lens, run.lens_right(), options});
  context_->make_current();
  view_ = std::make_unique<PredictedView>(std::make_shared<const gl::SceneBuffers>(*run.scene()),
                                          std::make_shared<const SurfaceRecords>(*surface_), lens);
}

std::size_t ReplaySession::surface_count() const {
  if (thesis_) return thesis_->textures().polygons().size();
  return static_cast<std::size_t>(std::count_if(surface_->charts.begin(), surface_->charts.end(),
                                                [](const Chart& chart) { return chart.radius > 0; }));
}

ExtractionReport ReplaySession::process(PosedFrame frame) {
  return thesis_ ? thesis_->process(frame) : thread_->process(std::move(frame));
}

PosedFrame ReplaySession::load(std::size_t index) const {
  PosedFrame frame = load_posed_frame(run_, index);
  if (const auto px = run_.frames()[index].left.predicted_px) {
    frame.left.margin_px = margin_for(margin_px_, *px);
    if (frame.right) frame.right->margin_px = frame.left.margin_px;
  }
  return frame;
}

cv::Mat ReplaySession::predict(std::size_t index) {
  const RunImage& at = run_.frames()[index].left;
  return predict(at.T_world_camera, run_.state_at(at.time));
}

cv::Mat ReplaySession::predict(const Pose& T_world_camera, const SceneState& state) {
  if (thesis_) {
    thesis_view_->draw(T_world_camera, state);
    return thesis_view_->read();
  }
  // Reading the picture waits for the GPU, so the lease may end with this function.
  const TextureLease textures = thread_->textures().acquire();
  if (!textures) return {};
  view_->draw(T_world_camera, state, *textures);
  cv::Mat picture = view_->read();
  gl::Fence::insert().wait(kDrawTimeout);
  gl::check_errors("the predicted view");
  return picture;
}

std::optional<RenderedView> ReplaySession::render(const Pose& T_world_camera, const SceneState& state) {
  RenderedView view{T_world_camera, predict(T_world_camera, state), {}};
  if (view.colour.empty()) return std::nullopt;
  if (!range_) range_.emplace(run_.lens_left(), view_->faces().faces);
  view.range = range_->read(view_->faces());
  return view;
}

bool ReplaySession::show(const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual,
                         const std::string& title) {
  if (!window_) return true;
  comparison_->draw(*window_, delayed, predicted, actual);
  window_->set_title(title);
  window_->present();
  return !window_->should_close();
}

void ReplaySession::linger(double seconds) {
  if (!window_) return;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end && !window_->should_close()) {
    window_->wait_events(0.05);
  }
}

}  // namespace foresight
