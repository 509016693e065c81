#include "apps/bench/shadow_bench.hpp"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "common/stop_signal.hpp"
#include "display/recorded_source.hpp"
#include "display/view_loop.hpp"
#include "gl/context.hpp"
#include "pictures/view_alpha.hpp"
#include "scene/ground_truth.hpp"
#include "sim/lamp.hpp"
#include "texture_gpu/lamp/shadow_rays.hpp"

namespace foresight {
namespace {

using nlohmann::json;
using SteadyClock = std::chrono::steady_clock;

constexpr int kPixelStep = 3;    // pixels, along rows and columns
constexpr int kLampPoints = 12;  // of the lab's lamp
constexpr double kShaded = 0.1;  // share of them that is hidden

std::vector<bool> moving_nodes(const RunFolder& run) {
  const auto& frames = run.frames();
  const std::size_t count = run.scene()->nodes().size();
  std::vector<bool> moving(count);
  const std::vector<Pose> first = load_posed_frame(run, 0).left.scene.T_world_node;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, frames.size() / 8)) {
    const std::vector<Pose> now = load_posed_frame(run, i).left.scene.T_world_node;
    for (std::size_t k = 0; k < count; ++k) moving[k] = moving[k] || !now[k].isApprox(first[k], 1e-4);
  }
  return moving;
}

/// What a replay of a run has shown.
struct Shown {
  std::vector<double> squared_error;  // of each view, over the pixels that count; grey levels
  std::size_t pixels = 0;
  LampAnswer lamp;
  std::optional<std::size_t> known_from;  // view
};

/// Where shadows of what moves are, and how wrong views are there.
class ShadowMeter final : public ViewObserver {
 public:
  ShadowMeter(const RunFolder& run, const RecordedSource& source, const GroundTruth& truth)
      : truth_(truth), source_(source), rays_(*run.scene()), moving_(moving_nodes(run)) {}

  void arrived(const PosedFrame& frame) override { newest_ = frame.left.scene.T_world_node; }
  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override {
    for (const ExtractionReport& report : step.reports) shown_.lamp = report.lamp;
    if (!step.drawn) return;
    if (shown_.lamp.lamp && !shown_.known_from) shown_.known_from = shown_.squared_error.size();
    const std::vector<Pose> T_world_node = source.place().scene.T_world_node;
    const ShadowRays::Posed then = rays_.pose(newest_, moving_), now = rays_.pose(T_world_node, moving_);
    const GroundTruth::Surface surface = truth_.read(source_.index(), false);
    const cv::Mat view = session.read(), actual = source.actual();
    double sum = 0;
    for (int y = 0; y < view.rows; y += kPixelStep)
      for (int x = 0; x < view.cols; x += kPixelStep) {
        const auto point = surface.at(x, y);
        if (!point || moving_[static_cast<std::size_t>(point->node)] ||
            view.at<cv::Vec4b>(y, x)[3] != view_alpha::kFromImage)
          continue;
        const Eigen::Vector3d p = T_world_node[static_cast<std::size_t>(point->node)] * point->p_node;
        if (!shaded(p, then) && !shaded(p, now)) continue;
        for (int c = 0; c < 3; ++c) {
          const double error = view.at<cv::Vec4b>(y, x)[c] - actual.at<cv::Vec3b>(y, x)[c];
          sum += error * error;
        }
        ++shown_.pixels;
      }
    shown_.squared_error.push_back(sum);
  }
  const Shown& shown() const { return shown_; }

 private:
  static bool shaded(const Eigen::Vector3d& p, const ShadowRays::Posed& posed) {
    int hidden = 0;
    for (int i = 0; i < kLampPoints; ++i)
      hidden += posed.blocked(
          p, sim::lamp::points()[static_cast<std::size_t>(i * sim::lamp::kPoints / kLampPoints)].cast<double>());
    return hidden > kShaded * kLampPoints;
  }

  const GroundTruth& truth_;
  const RecordedSource& source_;
  ShadowRays rays_;
  std::vector<bool> moving_;
  std::vector<Pose> newest_;
  Shown shown_;
};

Shown replay_with(const RunFolder& run, const GroundTruth& truth, double delay_ms, bool shadows) {
  TextureOptions textures;
  textures.depth_tolerance = run.scene()->accuracy().value_or(textures.depth_tolerance);
  textures.shadows = shadows;
  const auto context = gl::create_headless_context();
  ViewSession session(*context, view_setup(run, textures));
  RecordedSource source(run, arrivals_after(run, seconds(delay_ms * 1e-3)), textures.margin_px, false);
  ShadowMeter meter(run, source, truth);
  ViewLoop(session, source, {&meter}, stop_requested).run();
  return meter.shown();
}

}  // namespace

int bench_shadow(const ShadowBenchOptions& options) {
  json rows = json::array();
  for (const std::filesystem::path& folder : options.runs) {
    const RunFolder run = RunFolder::open(folder, {});
    if (!GroundTruth::exists(run)) throw InputError(folder.string(), "has no truth", "take runs of `foresight synth`");
    const GroundTruth truth = GroundTruth::open(run);
    ProgressBar bar("shadow", "replays", 2, SteadyClock::now(), ProgressBar::for_stderr());
    const Shown without = replay_with(run, truth, options.delay_ms, false);
    std::cerr << bar.update(1, SteadyClock::now()) << std::flush;
    const Shown with = replay_with(run, truth, options.delay_ms, true);
    std::cerr << bar.finish(2, SteadyClock::now());
    // Before the lamp is known both are the same; what is compared is what comes then.
    const std::size_t from = with.known_from.value_or(with.squared_error.size());
    double before = 0, after = 0;
    std::size_t worse = 0;
    for (std::size_t i = from; i < with.squared_error.size(); ++i) {
      before += without.squared_error[i], after += with.squared_error[i];
      worse += with.squared_error[i] > 1.02 * without.squared_error[i];
    }
    const std::size_t views = with.squared_error.size() - from;
    json row{{"run", folder.string()},
             {"views", with.squared_error.size()},
             {"views_with_lamp", views},
             {"pixels", with.pixels},
             {"views_worse", worse}};
    row["error_gone"] = before > 0 ? json(1 - after / before) : json(nullptr);
    if (with.lamp.lamp) {
      const Eigen::Vector3d& p = with.lamp.lamp->position;
      row["lamp"] = {{"position_m", {p.x(), p.y(), p.z()}},
                     {"off_m", (p - sim::lamp::centre().cast<double>()).norm()},
                     {"explained", with.lamp.explained}};
      std::printf(
          "%s: of the squared error where shadows of what moves are, %.1f %% are gone in %zu views since the lamp is "
          "known (of %zu); worse in %zu. Lamp at (%.2f, %.2f, %.2f) m, explains %.0f %%\n",
          folder.c_str(), 100 * (before > 0 ? 1 - after / before : 0), views, with.squared_error.size(), worse, p.x(),
          p.y(), p.z(), 100 * with.lamp.explained);
    } else {
      std::printf("%s: the lamp could not be told\n", folder.c_str());
    }
    rows.push_back(row);
    if (stop_requested()) return kStopped;
  }
  write_numbers(options.json, json{{"delay_ms", options.delay_ms}, {"runs", rows}}.dump(2));
  return 0;
}

}  // namespace foresight
