#include "apps/bench/head_bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <random>

#include "apps/bench/stereogram_figures.hpp"
#include "common/cpu_time.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "display/recorded_source.hpp"
#include "display/view_session.hpp"
#include "display/warp/depth_warp.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostImages = 12;
constexpr double kGuardShare = 0.08;  // of the width: 2 degrees at a field of view of 60

Lens eye_of(const Lens& camera, const HeadBenchOptions& options, int guard) {
  Lens::Parameters p;
  p.width = options.width + 2 * guard;
  p.height = options.height + 2 * guard;
  p.fx = p.fy = camera.parameters().fx * options.width / camera.width();
  p.cx = (p.width - 1) / 2.0;
  p.cy = (p.height - 1) / 2.0;
  return Lens(p);
}

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

cv::Mat pixels(const gl::Texture& texture, GLenum format, int type) {
  cv::Mat out(texture.height(), texture.width(), type);
  glGetTextureImage(texture.name(), 0, format, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * out.elemSize()),
                    out.data);
  return out;
}

double decibels(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  difference.convertTo(difference, CV_64F);
  const cv::Scalar squares = cv::sum(difference.mul(difference));
  const double mean = (squares[0] + squares[1] + squares[2]) / (3.0 * static_cast<double>(a.total()));
  return mean > 0 ? 10 * std::log10(255 * 255 / mean) : 100;
}

template <typename Work>
double gpu_cpu_ms(Work work) {
  glFinish();
  const double before = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  work();
  glFinish();
  return 1e3 * (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - before);
}

/// A view of the run's scene, with a guard band, and what is warped from it.
class HeadLab {
 public:
  HeadLab(const RunFolder& run, const HeadBenchOptions& options, gl::Context& context)
      : setup_(setup_of(run)),
        session_(context, setup_),
        wide_(eye_of(setup_.left, options, static_cast<int>(kGuardShare * options.width))),
        narrow_(eye_of(setup_.left, options, 0)),
        source_(session_.make_view(wide_)),
        truth_(session_.make_view(narrow_)),
        warp_(narrow_) {
    const std::size_t images = std::min(kMostImages, run.frames().size());
    for (std::size_t i = 0; i < images; ++i) {
      PosedFrame frame = load_posed_frame(run, i);
      T_world_camera_ = frame.left.T_world_camera;
      state_ = frame.left.scene;
      session_.process(std::move(frame));
    }
  }

  const Pose& T_world_camera() const { return T_world_camera_; }
  void draw_source(const Pose& from) {
    from_ = from;
    session_.draw(source_, from, state_);
  }
  void measure(const Pose& to, WarpFigures& out) {
    out.drawn_ms.push_back(gpu_cpu_ms([&] { session_.draw(truth_, to, state_); }));
    out.warped_ms.push_back(gpu_cpu_ms([&] { warp_({&source_.picture(), &source_.faces().depth, wide_, from_}, to); }));
    out.db.push_back(decibels(pixels(truth_.picture(), GL_RGBA, CV_8UC4), pixels(warp_.picture(), GL_RGBA, CV_8UC4)));
    const cv::Mat holes = pixels(warp_.holes(), GL_RED, CV_8UC1);
    const auto share = [&](int value) { return cv::countNonZero(holes == value) / static_cast<double>(holes.total()); };
    out.holes.push_back(share(128));
    out.beyond.push_back(share(255));
  }

 private:
  static ViewSetup setup_of(const RunFolder& run) {
    ViewSetup out;
    out.scene = run.scene();
    out.left = run.lens_left();
    out.right = run.lens_right();
    out.surface = surface_for(run);
    return out;
  }
  ViewSetup setup_;
  ViewSession session_;
  Lens wide_, narrow_;
  PredictedView source_, truth_;
  DepthWarp warp_;
  Pose T_world_camera_ = Pose::Identity(), from_ = Pose::Identity();
  SceneState state_;
};

}  // namespace

int bench_head(const HeadBenchOptions& options) {
  const RunFolder run = RunFolder::open(options.run, {});
  const auto context = gl::create_headless_context();
  const gl::DriverInfo driver = gl::query_driver();
  gl::set_up_context();
  HeadLab lab(run, options, *context);

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
    lab.draw_source(from);
    lab.measure(from * step(options.metres * any(), Eigen::AngleAxisd(options.degrees * EIGEN_PI / 180, any())),
                motion);
    lab.measure(from * step({options.eyes_apart, 0, 0}, Eigen::AngleAxisd::Identity()), second);
  }
  std::printf("%d views of %d x %d px; %s\n", options.views, options.width, options.height, driver.renderer.c_str());
  print("head motion", motion);
  print("second eye", second);
  nlohmann::json all;
  all["warped_motion"] = to_json(motion);
  all["warped_second_eye"] = to_json(second);
  all["size_px"] = {options.width, options.height};
  all["degrees"] = options.degrees;
  all["metres"] = options.metres;
  all["renderer"] = driver.renderer + ", OpenGL " + driver.version;
  all["stereograms"] = stereogram_figures(run);
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
