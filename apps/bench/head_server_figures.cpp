#include "apps/bench/head_server_figures.hpp"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/cpu_time.hpp"
#include "common/statistics.hpp"
#include "display/view_target.hpp"

namespace foresight {
namespace {

constexpr Duration kImageEvery = std::chrono::milliseconds(200);
constexpr std::uint64_t kSettled = 3;               // views that are drawn before anything counts
constexpr double kLineDead = 5, kApart = 0.065;     // s, m
constexpr double kSway = 0.04, kTurn = 0.12;        // m and rad of a head's sway
constexpr double kSwayRate = 0.4, kTurnRate = 0.3;  // Hz

Duration seconds_of(double s) {
  return Duration(static_cast<std::int64_t>(s * 1e9));
}

Pose swayed(double t) {
  constexpr double kRound = 2 * EIGEN_PI;
  Pose out = Pose::Identity();
  out.translation() = kSway * Eigen::Vector3d(std::sin(kRound * kSwayRate * t), 0.3 * std::sin(kRound * 0.7 * t), 0);
  out.linear() = (Eigen::AngleAxisd(kTurn * std::sin(kRound * kTurnRate * t), Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(0.4 * kTurn * std::sin(kRound * 0.5 * t), Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  return out;
}

/// Of a symmetrical lens without distortion.
head::EyeFov fov_of(const Lens& lens) {
  const auto& p = lens.parameters();
  const double side = std::atan(p.width / (2 * p.fx)), up = std::atan(p.height / (2 * p.fy));
  return {-side, side, up, -up};
}

/// Gives the run's images to the texture thread as if they came over a line.
class Images {
 public:
  explicit Images(HeadLab& lab) : lab_(lab) {}
  void feed(RobotTime now) {
    while (lab_.session().take_report()) ++extracted;
    if (next_ && now < *next_) return;
    next_ = now + kImageEvery;
    lab_.session().submit(lab_.frames()[sent_++ % lab_.frames().size()]);
  }
  std::uint64_t extracted = 0;

 private:
  HeadLab& lab_;
  std::optional<RobotTime> next_;
  std::size_t sent_ = 0;
};

}  // namespace

nlohmann::json head_server_figures(HeadLab& lab, gl::Context& context, const HeadServerTrial& trial) {
  MonotonicClock clock;
  head::SceneDrawer drawer(lab.session(), clock);
  head::EyeWarper warper(drawer, clock, trial.second);
  const head::EyeFov fov = fov_of(bench_eye(lab.camera(), trial.width, trial.height));
  const PictureCopy copy;
  std::vector<gl::Texture> shown;
  std::vector<TextureTarget> targets;
  for (int eye = 0; eye < 2; ++eye) shown.emplace_back(GL_RGBA8, trial.width, trial.height, 0, 1, "an eye's frame");
  for (const gl::Texture& texture : shown) targets.emplace_back(texture.name(), trial.width, trial.height);

  const double dead = std::min(kLineDead, trial.seconds / 2);
  const Duration interval = seconds_of(1 / trial.rate_hz);
  std::vector<double> took_ms;
  int late = 0;
  Images images(lab);
  double cpu_before = 0, drawn_before = 0;
  std::optional<RobotTime> counted_from;
  RobotTime last{};
  {
    const head::SceneThread drawing(context.create_shared(), drawer, clock);
    context.make_current();
    const RobotTime begin = clock.now();
    for (RobotTime next = begin;; next = next + interval) {
      clock.sleep_until(next);
      const RobotTime now = clock.now();
      if (!counted_from && drawer.drawn() >= kSettled) {
        counted_from = now;
        cpu_before = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
        drawn_before = static_cast<double>(drawer.drawn());
      }
      const double t = counted_from ? std::chrono::duration<double>(now - *counted_from).count() : 0;
      if (t > trial.seconds) break;
      const bool line_dead = t > (trial.seconds - dead) / 2 && t < (trial.seconds + dead) / 2;
      if (!line_dead) images.feed(now);
      const Pose T_world_head = lab.T_world_camera() * swayed(std::chrono::duration<double>(now - begin).count());
      lab.gate().frame_begins();
      warper.begin(lab.state());
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const Pose T_world_eye = T_world_head * Eigen::Translation3d((eye == 0 ? -0.5 : 0.5) * kApart, 0, 0);
        if (const gl::Texture* const picture = warper(eye, {T_world_eye, fov, trial.width, trial.height}))
          copy(*picture, targets[eye].whole(), trial.width);
      }
      warper.end();
      last = clock.now();
      lab.gate().frame_ends(next + interval);
      if (!counted_from) continue;
      took_ms.push_back(std::chrono::duration<double, std::milli>(last - now).count());
      late += last - next > interval;
      while (next + interval < last) next = next + interval;  // a runtime leaves such frames out
    }
  }
  const double seconds = std::chrono::duration<double>(last - *counted_from).count();
  const auto frames = static_cast<double>(took_ms.size());
  const double scene_hz = (static_cast<double>(drawer.drawn()) - drawn_before) / seconds;
  const double cpu = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_before;

  // What a frame takes of that, with nothing beside it.
  const double frame_ms = gpu_cpu_ms([&] {
    warper.begin(lab.state());
    for (std::size_t eye = 0; eye < 2; ++eye)
      warper(eye, {lab.T_world_camera() * Eigen::Translation3d((eye == 0 ? -0.5 : 0.5) * kApart, 0, 0), fov,
                   trial.width, trial.height});
    warper.end();
  });
  const head::WarpCounts& counts = warper.counts();
  const char* const second = trial.second == head::SecondEyeFrom::own_view ? "own view" : "first eye";
  std::printf(
      "%4d x %-4d at %.0f Hz, second eye from %-9s: pose to swap p50 %.1f, p99 %.1f ms; %.1f frames/s, %d of %.0f "
      "late; scene "
      "%.1f/s; %.1f CPU-ms a frame, %.2f cores in all\n",
      trial.width, trial.height, trial.rate_hz, second, median(took_ms), quantile(took_ms, 0.99), frames / seconds,
      late, frames, scene_hz, frame_ms, cpu / seconds);
  return {{"width", trial.width},
          {"height", trial.height},
          {"asked_hz", trial.rate_hz},
          {"second_eye", second},
          {"pose_to_swap_ms", {{"p50", median(took_ms)}, {"p99", quantile(took_ms, 0.99)}}},
          {"frames_hz", frames / seconds},
          {"late", late},
          {"frames", took_ms.size()},
          {"scene_hz", scene_hz},
          {"images", images.extracted},
          {"frame_cpu_ms", frame_ms},
          {"cores", cpu / seconds},
          {"second_eyes", counts.of_first},
          {"second_eyes_torn", counts.torn}};
}

}  // namespace foresight
