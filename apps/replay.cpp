#include "apps/replay.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>

#include "apps/replay_refinement.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "apps/view_measures.hpp"
#include "common/error.hpp"
#include "common/partial_path.hpp"
#include "common/stop_signal.hpp"
#include "display/recorded_source.hpp"
#include "display/view_window.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr double kLastPicture = 3;  // seconds for which the window shows the last instant
constexpr int kReplayWindowWidth = 1440;

/// Throws InputError for a delay that no image outlives.
std::vector<std::size_t> arrivals(const RunFolder& run, const ReplayOptions& options) {
  const auto& frames = run.frames();
  auto arrived = options.delay_frames ? arrivals_after(run, static_cast<std::size_t>(*options.delay_frames))
                                      : arrivals_after(run, seconds(options.delay_ms.value_or(0) * 1e-3));
  if (arrived.back() > 0) return arrived;
  if (frames.size() == 1)
    throw InputError(options.delay_frames ? "--delay-frames" : "--delay-ms", "the run has one image, and no later one",
                     "give 0, or a run of more images");
  const double length_ms = to_seconds(frames.back().left.time - frames.front().left.time) * 1e3;
  throw InputError(options.delay_frames ? "--delay-frames" : "--delay-ms", "the delay is longer than the run",
                   options.delay_frames ? "give at most " + std::to_string(frames.size() - 1) + " images"
                                        : "give at most " + std::to_string(length_ms) + " ms");
}

/// Nothing where the core is to do it. The thesis' own resolution is the default there.
std::optional<thesis::Options> thesis_options(const ReplayOptions& options) {
  if (options.pipeline == ReplayPipeline::core) return std::nullopt;
  thesis::Options out;
  if (options.textures.texels_per_metre > 0) out.texels_per_metre = options.textures.texels_per_metre;
  if (options.textures.max_texture > 0) out.max_texture = options.textures.max_texture;
  return out;
}

std::string name_of(const fs::path& run) {
  return without_end_slash(fs::absolute(run).lexically_normal()).filename().string();
}

RunRecord described(const ViewSession& session, const ViewSetup& setup, const RunFolder& run,
                    const ReplayOptions& options) {
  RunRecord record = describe(session, setup);
  record.run = name_of(options.run);
  if (options.delay_frames)
    record.options.push_back({"delay_frames", std::int64_t{*options.delay_frames}});
  else
    record.options.push_back({"delay_ms", options.delay_ms.value_or(0)});
  add_texture_options(record, options.textures);
  record.options.push_back({"real_time", options.real_time});
  record.options.push_back({"refine", options.refine});
  if (options.scene) record.options.push_back({"scene", options.scene->string()});
  if (run.unpaired_right())
    record.notes.push_back(std::to_string(run.unpaired_right()) + " right images have no left one and were left out.");
  return record;
}

/// On stderr.
class Progress final : public ViewObserver {
 public:
  Progress(const RecordedSource& source, std::size_t images)
      : source_(source), bar_("replay", "images", images, SteadyClock::now(), ProgressBar::for_stderr()) {}
  void stepped(const ViewStep& step, FrameSource& /*source*/, ViewSession& /*session*/) override {
    if (step.drawn) std::cerr << bar_.update(source_.index() + 1, SteadyClock::now()) << std::flush;
  }
  void finish(std::size_t images) { std::cerr << bar_.finish(images, SteadyClock::now()); }

 private:
  using SteadyClock = std::chrono::steady_clock;
  const RecordedSource& source_;
  ProgressBar bar_;
};

std::unique_ptr<gl::Window> open_replay_window(const Lens& lens) {
  const int height = kReplayWindowWidth * lens.height() / (3 * lens.width());
  try {
    return std::make_unique<gl::Window>(kReplayWindowWidth, std::max(height, 120), "Foresight replay");
  } catch (const gl::NoWindow& error) {
    throw RuntimeFailure(error.what(), "or leave out --window");
  }
}

std::string window_title(const RunRecord& record) {
  if (record.frames.empty()) return "Foresight replay";
  const FrameRecord& frame = record.frames.back();
  return fmt::format("Foresight replay: {:.0f} ms delayed {:.1f} dB | predicted {:.1f} dB | actual",
                     frame.delay_s * 1e3, frame.delayed.psnr_db.value_or(0), frame.predicted.psnr_db.value_or(0));
}

int play(const RunFolder& run, const ReplayOptions& options, std::vector<std::size_t> arrived) {
  const auto window = options.window ? open_replay_window(run.lens_left()) : nullptr;
  const auto headless = window ? nullptr : gl::create_headless_context();
  gl::Context& context = window ? static_cast<gl::Context&>(*window) : *headless;
  ViewSetup setup = view_setup(run, options.textures, thesis_options(options));
  setup.newest_image = options.projection;
  setup.silhouettes = options.silhouettes;
  setup.levels = level_settings(options.detail);
  ViewSession session(context, setup);

  RecordedSource recorded(run, std::move(arrived), options.textures.margin_px, options.real_time);
  std::optional<ReplayRefinement> refinement;
  if (options.refine) refinement.emplace(run, recorded, session, options.textures.margin_px);
  FrameSource& source = refinement ? static_cast<FrameSource&>(*refinement) : recorded;

  ViewMeasures measures(described(session, setup, run, options), options.outputs, options.textures);
  Progress progress(recorded, run.frames().size());
  std::vector<ViewObserver*> observers{&measures, &progress};
  std::optional<ViewWindow> shown;
  if (window)
    shown.emplace(*window, ViewWindowOptions{.actual = true, .title = [&](const ViewStep&) {
                                               return window_title(measures.record());
                                             }});
  if (shown) observers.push_back(&*shown);

  ViewLoop(session, source, observers, stop_requested).run();
  measures.record().complete = !stop_requested() && !(shown && !shown->wants_more());
  if (shown && !stop_requested()) shown->linger(kLastPicture);
  progress.finish(measures.record().frames.size());
  if (refinement) refinement->report(measures.record());
  measures.finish(source, session, "Foresight replay of " + measures.record().run);
  print_summary(measures.record());
  return stop_requested() ? kStopped : 0;
}

}  // namespace

int replay(const ReplayOptions& given) {
  if (given.delay_frames && given.delay_ms)
    throw InputError("--delay-ms", "stands beside --delay-frames", "give one of the two");
  if (given.pipeline == ReplayPipeline::thesis && given.refine)
    throw InputError("--refine", "the thesis' pipeline has no view to align images to",
                     "leave --refine away, or use --pipeline core");
  if (given.pipeline == ReplayPipeline::thesis && given.real_time)
    throw InputError("--real-time", "the thesis' pipeline draws and extracts in one thread",
                     "leave --real-time away, or use --pipeline core");
  if (given.pipeline == ReplayPipeline::thesis && level_settings(given.detail))
    throw InputError("--detail", "the thesis' pipeline draws polygon by polygon",
                     "leave --detail away, or use --pipeline core");
  ReplayOptions options = given;
  options.textures.awaits_lamp = !options.real_time;
  const RunFolder run = open_run(options);
  const std::vector<std::size_t> arrived = arrivals(run, options);
  check_images(run);
  poll_stop_signals();
  return play(run, options, arrived);
}

}  // namespace foresight
