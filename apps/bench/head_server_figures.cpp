#include "apps/bench/head_server_figures.hpp"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/head_motion_figures.hpp"
#include "apps/bench/image_feed.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "display/view_target.hpp"

namespace foresight {
namespace {

constexpr std::uint64_t kSettled = 3;            // views that are drawn before anything counts
constexpr double kLongestStart = 60;             // s until then
constexpr double kLineDead = 5, kApart = 0.065;  // s, m

Duration seconds_of(double s) {
  return Duration(static_cast<std::int64_t>(s * 1e9));
}

/// Who draws, and how he is asked.
struct Drawing {
  head::DrawnViews& views;
  std::function<std::uint64_t()> drawn;
  std::function<void(RobotTime)> feed_images;
  std::function<void()> between_frames;
  DrawingProcess* process = nullptr;  // where that draws

  /// Throws RuntimeFailure: nothing will come any more, or nothing came for too long.
  void require_views(double waited_s) const {
    const std::string failure = process != nullptr ? process->failure() : "";
    if (failure.empty() && waited_s <= kLongestStart) return;
    const std::string why = process != nullptr ? process->doing() : "other programs may need all processors";
    throw RuntimeFailure("no views are drawn for the head display: " + (failure.empty() ? why : failure),
                         failure.empty() ? "let fewer programs run beside this one" : "look at what it said above");
  }
};

struct Frames {
  std::vector<double> took_ms;
  int late = 0;
  double seconds = 0, cpu_seconds = 0, views = 0, frame_ms = 0;
  head::WarpCounts counts;
};

/// Frames for one trial, as a runtime would pace them.
class FrameLoop {
 public:
  FrameLoop(HeadLab& lab, const HeadServerTrial& trial, Drawing drawing)
      : lab_(lab),
        trial_(trial),
        drawing_(std::move(drawing)),
        warper_(drawing_.views, clock_, trial.second),
        fov_(head::fov_of(bench_eye(lab.camera(), trial.width, trial.height))) {
    for (int eye = 0; eye < 2; ++eye) shown_.emplace_back(GL_RGBA8, trial.width, trial.height, 0, 1, "an eye's frame");
    for (const gl::Texture& texture : shown_) targets_.emplace_back(texture.name(), trial.width, trial.height);
  }

  Frames run() {
    Frames out;
    const double dead = std::min(kLineDead, trial_.seconds / 2);
    const Duration interval = seconds_of(1 / trial_.rate_hz);
    double cpu_before = 0, drawn_before = 0;
    std::optional<RobotTime> counted_from;
    RobotTime last{};
    const RobotTime begin = clock_.now();
    for (RobotTime next = begin;; next = next + interval) {
      warper_.make_way();
      clock_.sleep_until(next);
      const RobotTime now = clock_.now();
      drawing_.require_views(counted_from ? 0 : to_seconds(now - begin));
      if (!counted_from && drawing_.drawn() >= kSettled) {
        counted_from = now;
        cpu_before = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
        drawn_before = static_cast<double>(drawing_.drawn());
      }
      const double t = counted_from ? to_seconds(now - *counted_from) : 0;
      if (t > trial_.seconds) break;
      const bool line_dead = t > (trial_.seconds - dead) / 2 && t < (trial_.seconds + dead) / 2;
      if (!line_dead) drawing_.feed_images(now);
      frame(lab_.T_world_camera() * swayed(to_seconds(now - begin)));
      last = clock_.now();
      if (counted_from) {
        out.took_ms.push_back(1e3 * to_seconds(last - now));
        out.late += last - next > interval;
      }
      drawing_.between_frames();
      while (next + interval < clock_.now()) next = next + interval;  // a runtime leaves such frames out
    }
    out.seconds = to_seconds(last - *counted_from);
    out.cpu_seconds = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_before;
    out.views = static_cast<double>(drawing_.drawn()) - drawn_before;
    out.counts = warper_.counts();
    return out;
  }

  void frame(const Pose& T_world_head) {
    warper_.begin(lab_.state());
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Pose T_world_eye = T_world_head * Eigen::Translation3d((eye == 0 ? -0.5 : 0.5) * kApart, 0, 0);
      if (const gl::Texture* const picture = warper_(eye, {T_world_eye, fov_, trial_.width, trial_.height}))
        copy_(*picture, targets_[eye].whole(), trial_.width);
    }
    warper_.end();
  }

 private:
  HeadLab& lab_;
  HeadServerTrial trial_;
  Drawing drawing_;
  MonotonicClock clock_;
  head::EyeWarper warper_;
  head::EyeFov fov_;
  PictureCopy copy_;
  std::vector<gl::Texture> shown_;
  std::vector<TextureTarget> targets_;
};

Frames run_trial(HeadLab& lab, gl::Context& context, const HeadServerTrial& trial) {
  MonotonicClock clock;
  ImageFeed images(lab);
  const auto feed = [&](RobotTime now) { images.feed(now); };
  if (trial.drawn_by == DrawnBy::process) {
    head::ViewShare& share = trial.process->share();
    head::SharedViews views(share, lab.session().scene());
    FrameLoop loop(lab, trial, {views, [&] { return share.drawn(); }, [](RobotTime) {}, [] {}, trial.process});
    Frames out = loop.run();
    out.frame_ms = gpu_cpu_ms([&] { loop.frame(lab.T_world_camera()); });  // of this process
    return out;
  }
  const bool in_thread = trial.drawn_by == DrawnBy::thread;
  head::SceneDrawer drawer(lab.session(), clock, {.in_bands = in_thread, .others = lab.gate()});
  const auto drawn = [&] { return drawer.drawn(); };
  const auto draw = [&] {
    if (!in_thread) drawer.draw();
  };
  FrameLoop loop(lab, trial, {drawer, drawn, feed, draw});
  Frames out;
  {
    std::optional<head::SceneThread> thread;
    if (in_thread) thread.emplace(context.create_shared(), drawer, clock);
    context.make_current();
    out = loop.run();
  }
  drawer.release();
  out.frame_ms = gpu_cpu_ms([&] { loop.frame(lab.T_world_camera()); });  // with nothing beside it
  return out;
}

}  // namespace

nlohmann::json head_server_figures(HeadLab& lab, gl::Context& context, const HeadServerTrial& trial) {
  const Frames f = run_trial(lab, context, trial);
  const auto frames = static_cast<double>(f.took_ms.size());
  const char* const second = trial.second == head::SecondEyeFrom::own_view ? "own view" : "first eye";
  const char* const by = trial.drawn_by == DrawnBy::thread    ? "thread"
                         : trial.drawn_by == DrawnBy::process ? "process"
                                                              : "showing thread";
  std::printf(
      "%4d x %-4d at %.0f Hz, drawn by a %-14s second eye from %-9s: pose to swap p50 %.1f, p99 %.1f ms; %.1f "
      "frames/s, "
      "%d of %.0f late; scene %.1f/s; %.1f CPU-ms a frame, %.2f cores in this process\n",
      trial.width, trial.height, trial.rate_hz, by, second, median(f.took_ms), quantile(f.took_ms, 0.99),
      frames / f.seconds, f.late, frames, f.views / f.seconds, f.frame_ms, f.cpu_seconds / f.seconds);
  return {{"width", trial.width},
          {"height", trial.height},
          {"asked_hz", trial.rate_hz},
          {"drawn_by", by},
          {"second_eye", second},
          {"pose_to_swap_ms", {{"p50", median(f.took_ms)}, {"p99", quantile(f.took_ms, 0.99)}}},
          {"frames_hz", frames / f.seconds},
          {"late", f.late},
          {"frames", f.took_ms.size()},
          {"scene_hz", f.views / f.seconds},
          {"frame_cpu_ms", f.frame_ms},
          {"cores", f.cpu_seconds / f.seconds},
          {"second_eyes", f.counts.of_first},
          {"second_eyes_torn", f.counts.torn}};
}

}  // namespace foresight
