#include "apps/bench/head_bench.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>

#include "apps/bench/head_lab.hpp"
#include "apps/bench/head_motion_figures.hpp"
#include "apps/bench/head_server_figures.hpp"
#include "apps/bench/portal_figures.hpp"
#include "apps/bench/pose_table.hpp"
#include "apps/bench/sorting_figures.hpp"
#include "apps/bench/stereogram_figures.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "display/warp/depth_warp.hpp"
#include "display/warp/second_eye.hpp"

namespace foresight {
namespace {

constexpr double kSideShare = 0.13;  // what the second eye sees beyond the first one's border, 65 mm at 0.5 m

struct WarpFigures {
  std::vector<double> db, drawn_ms, warped_ms, holes, beyond;
};

nlohmann::json to_json(const WarpFigures& f) {
  return {{"db", {{"median", median(f.db)}, {"worst", *std::ranges::min_element(f.db)}}},
          {"drawn_cpu_ms", median(f.drawn_ms)},
          {"warped_cpu_ms", median(f.warped_ms)},
          {"holes", {{"median", median(f.holes)}, {"most", *std::ranges::max_element(f.holes)}}},
          {"beyond_border", *std::ranges::max_element(f.beyond)}};
}

void print(const char* what, const WarpFigures& f) {
  std::printf("%-28s %6.2f dB (worst %.2f), holes %.2f %% (most %.2f %%), warped in %.1f CPU-ms, drawn in %.1f\n", what,
              median(f.db), *std::ranges::min_element(f.db), 100 * median(f.holes),
              100 * *std::ranges::max_element(f.holes), median(f.warped_ms), median(f.drawn_ms));
}

/// A view of the run's scene, with a guard band, and what is warped from it.
class WarpTrial {
 public:
  WarpTrial(HeadLab& lab, const HeadBenchOptions& options)
      : lab_(lab),
        wide_(bench_eye(lab.camera(), options.width, options.height, static_cast<int>(kGuardShare * options.width))),
        narrow_(bench_eye(lab.camera(), options.width, options.height)),
        first_(bench_eye(lab.camera(), options.width, options.height, static_cast<int>(kSideShare * options.width))),
        parts_(std::make_shared<const WarpScene>(lab.session().scene())),
        capture_(parts_),
        source_(lab.session().make_view(wide_)),
        side_source_(lab.session().make_view(first_)),
        truth_(lab.session().make_view(narrow_)),
        layers_(wide_),
        side_layers_(first_),
        warp_(parts_, narrow_),
        second_(first_, narrow_) {}

  void draw_source(const Pose& from) {
    from_ = from;
    lab_.session().draw(source_, from, lab_.state());
    capture_(source_.picture(), source_.faces(), from, lab_.state(), layers_);
    lab_.session().draw(side_source_, from, lab_.state());
    capture_(side_source_.picture(), side_source_.faces(), from, lab_.state(), side_layers_);
  }
  void measure(const Pose& to, WarpFigures& out) {
    draw_truth(to, out);
    out.warped_ms.push_back(gpu_cpu_ms([&] { warp_(layers_, to); }));
    compare(warp_.picture(), warp_.holes(), out);
  }
  void measure_second(double apart, WarpFigures& out) {
    draw_truth(from_ * Eigen::Translation3d(apart, 0, 0), out);
    out.warped_ms.push_back(gpu_cpu_ms([&] { second_(side_layers_.picture, side_layers_.depth, apart); }));
    compare(second_.picture(), second_.holes(), out);
  }

 private:
  void draw_truth(const Pose& at, WarpFigures& out) {
    out.drawn_ms.push_back(gpu_cpu_ms([&] { lab_.session().draw(truth_, at, lab_.state()); }));
  }
  void compare(const gl::Texture& picture, const gl::Texture& hole_picture, WarpFigures& out) const {
    out.db.push_back(
        picture_decibels(read_pixels(truth_.picture(), GL_RGBA, CV_8UC4), read_pixels(picture, GL_RGBA, CV_8UC4)));
    const cv::Mat holes = read_pixels(hole_picture, GL_RED, CV_8UC1);
    const auto share = [&](int value) { return cv::countNonZero(holes == value) / static_cast<double>(holes.total()); };
    out.holes.push_back(share(128));
    out.beyond.push_back(share(255));
  }

  HeadLab& lab_;
  Lens wide_, narrow_, first_;
  std::shared_ptr<const WarpScene> parts_;
  LayerCapture capture_;
  PredictedView source_, side_source_, truth_;
  WarpLayers layers_, side_layers_;
  DepthWarp warp_;
  SecondEye second_;
  Pose from_ = Pose::Identity();
};

nlohmann::json server_figures(HeadLab& lab, gl::Context& context, const HeadBenchOptions& options) {
  std::printf("frames in real time, extraction and drawing beside them, the line dead for %.1f s:\n",
              std::min(5.0, options.seconds / 2));
  nlohmann::json rows = nlohmann::json::array();
  for (const auto second : {head::SecondEyeFrom::own_view, head::SecondEyeFrom::first_eye}) {
    HeadServerTrial large{options.width, options.height, options.rate_hz, options.seconds, second};
    rows.push_back(head_server_figures(lab, context, large));
    HeadServerTrial small{options.width / 2, options.height / 2, 2.25 * options.rate_hz, options.seconds, second};
    rows.push_back(head_server_figures(lab, context, small));
  }
  return rows;
}

}  // namespace

int bench_head(const HeadBenchOptions& options) {
  const RunFolder run = RunFolder::open(options.run, {});
  std::optional<PoseTrack> head;
  if (options.path) head = head_track(read_pose_table(*options.path));
  const auto context = gl::create_headless_context();
  const gl::DriverInfo driver = gl::query_driver();
  gl::set_up_context();
  MonotonicClock clock;
  HeadLab lab(run, *context, clock);
  WarpTrial trial(lab, options);

  std::mt19937 random(options.seed);
  std::normal_distribution some(0.0, 1.0);
  const auto any = [&] {
    const Eigen::Vector3d out(some(random), some(random), some(random));
    return Eigen::Vector3d(out.normalized());
  };
  const auto step = [](const Eigen::Vector3d& by, const Eigen::AngleAxisd& turn) {
    Pose out = Pose::Identity();
    out.translation() = by;
    out.linear() = turn.toRotationMatrix();
    return out;
  };
  WarpFigures motion, second;
  for (int i = 0; i < options.views; ++i) {
    const Pose from = lab.T_world_camera() * step(0.05 * any(), Eigen::AngleAxisd(0.1 * some(random), any()));
    trial.draw_source(from);
    trial.measure(from * step(options.metres * any(), Eigen::AngleAxisd(options.degrees * EIGEN_PI / 180, any())),
                  motion);
    trial.measure_second(options.eyes_apart, second);
  }
  std::printf("%d views of %d x %d px; %s\n", options.views, options.width, options.height, driver.renderer.c_str());
  print("head motion", motion);
  print("second eye, row by row", second);
  nlohmann::json all;
  all["warped_motion"] = to_json(motion);
  all["warped_second_eye"] = to_json(second);
  all["size_px"] = {options.width, options.height};
  all["degrees"] = options.degrees;
  all["metres"] = options.metres;
  all["renderer"] = driver.renderer + ", OpenGL " + driver.version;
  if (head) {
    all["recorded_head"] = head_motion_figures(lab, *head, options.width, options.height);
    all["cube"] = cube_figures(lab, *head, options.width, options.height);
  }
  if (options.seconds > 0) all["server"] = server_figures(lab, *context, options);
  all["portals"] = portal_figures({options.building, options.views, options.seed});
  all["sorting"] = sorting_figures(options.seed);
  all["stereograms"] = stereogram_figures(run);
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
