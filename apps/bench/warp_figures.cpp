#include "apps/bench/warp_figures.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>

#include "common/statistics.hpp"
#include "display/head/scene_drawer.hpp"
#include "display/warp/depth_warp.hpp"
#include "display/warp/second_eye.hpp"
#include "gl/read_texture.hpp"

namespace foresight {
namespace {

constexpr double kSideShare = 0.13;     // what the second eye sees beyond the first one's border, 65 mm at 0.5 m
constexpr double kPanelBarrel = -0.16;  // k1 of a panel's lens: a strong magnifier's distortion, undone

struct Figures {
  std::vector<double> db, drawn_ms, warped_ms, holes, beyond;
};

nlohmann::json to_json(const Figures& f) {
  return {{"db", {{"median", median(f.db)}, {"worst", *std::ranges::min_element(f.db)}}},
          {"drawn_cpu_ms", median(f.drawn_ms)},
          {"warped_cpu_ms", median(f.warped_ms)},
          {"holes", {{"median", median(f.holes)}, {"most", *std::ranges::max_element(f.holes)}}},
          {"beyond_border", *std::ranges::max_element(f.beyond)}};
}

void print(const char* what, const Figures& f) {
  std::printf("%-28s %6.2f dB (worst %.2f), holes %.2f %% (most %.2f %%), warped in %.1f CPU-ms, drawn in %.1f\n", what,
              median(f.db), *std::ranges::min_element(f.db), 100 * median(f.holes),
              100 * *std::ranges::max_element(f.holes), median(f.warped_ms), median(f.drawn_ms));
}

/// As many px a radian in its middle as `eye`, whose picture bends as if seen through a magnifier.
Lens panel_lens(const Lens& eye) {
  Lens::Parameters p = eye.parameters();
  p.d[0] = kPanelBarrel;
  return Lens(p);
}

/// What a panel's lens sees and 4 degrees more, without its distortion.
Lens behind_panel(const Lens& panel) {
  const head::EyeFov fov = head::widened(head::fov_of(panel), head::SceneDrawer::kGuard);
  const auto pixels = [&](double focal, double from, double to) {
    return static_cast<int>(focal * (std::tan(to) - std::tan(from)));
  };
  return head::eye_lens(fov, pixels(panel.parameters().fx, fov.left, fov.right),
                        pixels(panel.parameters().fy, fov.down, fov.up));
}

/// A view that others are made from.
class Source {
 public:
  Source(HeadLab& lab, std::shared_ptr<const WarpScene> parts, const Lens& lens)
      : lab_(lab),
        capture_(std::move(parts)),
        view_(lab.session().make_view(lens)),
        layers_(lens),
        behind_(lens, true) {}
  void draw(const Pose& from) {
    view_.draw_part(std::nullopt);
    drawn_ms_.push_back(gpu_cpu_ms([&] { draw(from, layers_); }));
    behind_ms_.push_back(gpu_cpu_ms([&] {
      view_.draw_part(capture_.behind_edges(layers_));
      draw(from, behind_);
    }));
  }
  const WarpLayers& layers() const { return layers_; }
  const WarpLayers& behind() const { return behind_; }
  /// ms: of a view, and of what is behind its edges.
  double drawn_ms() const { return median(drawn_ms_); }
  double behind_ms() const { return median(behind_ms_); }

 private:
  void draw(const Pose& from, WarpLayers& into) {
    lab_.session().draw(view_, from, lab_.state());
    capture_(view_.picture(), view_.faces(), from, lab_.state(), into);
  }

  HeadLab& lab_;
  LayerCapture capture_;
  PredictedView view_;
  WarpLayers layers_, behind_;
  std::vector<double> drawn_ms_, behind_ms_;
};

/// What would have been drawn, beside what is warped.
class Trial {
 public:
  Trial(HeadLab& lab, const Lens& lens) : lab_(lab), truth_(lab.session().make_view(lens)) {}

  template <typename Warp>
  void measure(const Pose& to, const Warp& warp, const gl::Texture& picture, const gl::Texture& holes) {
    figures_.drawn_ms.push_back(gpu_cpu_ms([&] { lab_.session().draw(truth_, to, lab_.state()); }));
    figures_.warped_ms.push_back(gpu_cpu_ms(warp));
    figures_.db.push_back(picture_decibels(gl::read_texture(truth_.picture()), gl::read_texture(picture)));
    const cv::Mat kinds = gl::read_texture(holes);
    const auto share = [&](int value) { return cv::countNonZero(kinds == value) / static_cast<double>(kinds.total()); };
    figures_.holes.push_back(share(128));
    figures_.beyond.push_back(share(255));
  }
  nlohmann::json told(const char* what) const {
    print(what, figures_);
    return to_json(figures_);
  }

 private:
  HeadLab& lab_;
  PredictedView truth_;
  Figures figures_;
};

Pose step(const Eigen::Vector3d& by, const Eigen::AngleAxisd& turn) {
  Pose out = Pose::Identity();
  out.translation() = by;
  out.linear() = turn.toRotationMatrix();
  return out;
}

}  // namespace

nlohmann::json warp_figures(HeadLab& lab, const WarpTrials& trials) {
  const auto with_guard = [&](double share) {
    return bench_eye(lab.camera(), trials.width, trials.height, static_cast<int>(share * trials.width));
  };
  const Lens eye = with_guard(0), first = with_guard(kSideShare), panel = panel_lens(eye);
  const auto parts = std::make_shared<const WarpScene>(lab.session().scene());
  Source source(lab, parts, with_guard(kGuardShare)), first_eye(lab, parts, first),
      panel_source(lab, parts, behind_panel(panel));
  DepthWarp warp(parts, eye), through_panel(parts, panel);
  SecondEye second(first, eye);
  Trial motion(lab, eye), motion_alone(lab, eye), second_eye(lab, eye), second_alone(lab, eye),
      predistorted(lab, panel);

  std::mt19937 random(trials.seed);
  std::normal_distribution some(0.0, 1.0);
  const auto any = [&] {
    const Eigen::Vector3d out(some(random), some(random), some(random));
    return Eigen::Vector3d(out.normalized());
  };
  for (int i = 0; i < trials.views; ++i) {
    const Pose from = lab.T_world_camera() * step(0.05 * any(), Eigen::AngleAxisd(0.1 * some(random), any()));
    const Pose to = from * step(trials.metres * any(), Eigen::AngleAxisd(trials.degrees * EIGEN_PI / 180, any()));
    source.draw(from);
    motion_alone.measure(
        to, [&] { warp(source.layers(), to); }, warp.picture(), warp.holes());
    const auto warp_and_mend = [&] {
      warp(source.layers(), to);
      warp.mend(source.behind(), to);
    };
    motion.measure(to, warp_and_mend, warp.picture(), warp.holes());
    first_eye.draw(from);
    const WarpLayers& one = first_eye.layers();
    const Pose beside = from * Eigen::Translation3d(trials.eyes_apart, 0, 0);
    const auto make_second = [&] { second(one.picture, one.depth, trials.eyes_apart); };
    second_alone.measure(beside, make_second, second.picture(), second.holes());
    const auto make_and_mend = [&] {
      make_second();
      warp.mend(first_eye.behind(), beside, {}, second.picture(), second.holes());
    };
    second_eye.measure(beside, make_and_mend, second.picture(), second.holes());
    panel_source.draw(from);
    predistorted.measure(
        to,
        [&] {
          through_panel(panel_source.layers(), to);
          through_panel.mend(panel_source.behind(), to);
        },
        through_panel.picture(), through_panel.holes());
  }
  std::printf("%d views of %d x %d px\n", trials.views, trials.width, trials.height);
  nlohmann::json out;
  out["motion"] = motion.told("head motion");
  out["motion_of_one_layer"] = motion_alone.told("  without what is behind");
  out["second_eye"] = second_eye.told("second eye, row by row");
  out["second_eye_of_one_layer"] = second_alone.told("  without what is behind");
  out["through_panel_lens"] = predistorted.told("through a panel's lens");
  std::printf("a view with a guard band is drawn in %.1f CPU-ms, what is behind its edges in %.1f\n", source.drawn_ms(),
              source.behind_ms());
  out["view_cpu_ms"] = source.drawn_ms();
  out["behind_cpu_ms"] = source.behind_ms();
  out["views"] = trials.views;
  out["degrees"] = trials.degrees;
  out["metres"] = trials.metres;
  return out;
}

}  // namespace foresight
