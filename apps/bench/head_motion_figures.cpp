#include "apps/bench/head_motion_figures.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/statistics.hpp"
#include "display/warp/cube_views.hpp"

namespace foresight {
namespace {

constexpr Duration kAge = std::chrono::milliseconds(50), kEvery = std::chrono::milliseconds(500);
constexpr int kMostViews = 100, kStep = 8;  // px between the pixels that are looked at

/// Of axes x right, y up to those of a camera, y down: mirrored on both sides, a motion stays one.
Pose in_camera_axes(const Pose& head) {
  const Eigen::Vector3d mirror(1, -1, 1);
  Pose out = Pose::Identity();
  out.translation() = mirror.cwiseProduct(head.translation());
  out.linear() = mirror.asDiagonal() * head.linear() * mirror.asDiagonal();
  return out;
}

Eigen::Vector2d place(const Lens& lens, const Eigen::Vector3d& p) {
  const auto& k = lens.parameters();
  return {k.fx * p.x() / p.z() + k.cx, k.fy * p.y() / p.z() + k.cy};
}

}  // namespace

nlohmann::json head_motion_figures(HeadLab& lab, const PoseTrack& head, int width, int height) {
  const int guard = static_cast<int>(kGuardShare * width);
  const Lens eye = bench_eye(lab.camera(), width, height), wide = bench_eye(lab.camera(), width, height, guard);
  const auto parts = std::make_shared<const WarpScene>(lab.session().scene());
  const LayerCapture capture(parts);
  PredictedView source = lab.session().make_view(wide), truth = lab.session().make_view(eye);
  WarpLayers layers(wide), true_layers(eye);
  DepthWarp warp(parts, eye);
  std::vector<double> unwarped, turned, warped;
  if (head.samples().size() < 2) return {};
  const Pose& to = lab.T_world_camera();
  const RobotTime begin = head.samples().front().time + kAge, end = head.samples().back().time;
  int views = 0;
  for (RobotTime now = begin; now < end && views < kMostViews; now = now + kEvery, ++views) {
    const auto before = head.at(now - kAge), then = head.at(now);
    if (before.status == StateStatus::invalid || then.status == StateStatus::invalid) continue;
    const Pose T_before_now = in_camera_axes(before.pose.inverse() * then.pose);
    const Pose from = to * T_before_now.inverse();
    lab.session().draw(source, from, lab.state());
    capture(source.picture(), source.faces(), from, lab.state(), layers);
    lab.session().draw(truth, to, lab.state());
    capture(truth.picture(), truth.faces(), to, lab.state(), true_layers);
    warp(layers, to);
    const cv::Mat q_true = read_numbers(true_layers.depth), q_warped = read_numbers(warp.depth());
    for (int y = kStep / 2; y < height; y += kStep)
      for (int x = kStep / 2; x < width; x += kStep) {
        const Eigen::Vector3d ray = *eye.unproject({x, y});
        const auto in_source = [&](double q) {
          return place(wide, T_before_now.linear() * (ray / ray.z()) + q * T_before_now.translation());
        };
        const Eigen::Vector2d right = in_source(q_true.at<float>(y, x));
        unwarped.push_back((right - Eigen::Vector2d(x + guard, y + guard)).norm());
        turned.push_back((right - in_source(0)).norm());
        warped.push_back((right - in_source(q_warped.at<float>(y, x))).norm());
      }
  }
  nlohmann::json out;
  out["views"] = views;
  std::printf("recorded head, 50 ms old: off by    p50         p95 (px, %d x %d, %d views)\n", width, height, views);
  const auto row = [&](const char* key, const char* what, const std::vector<double>& errors) {
    if (errors.empty()) return;
    out[key] = {{"p50_px", median(errors)}, {"p95_px", quantile(errors, 0.95)}};
    std::printf("  %-28s %9.3f   %9.3f\n", what, median(errors), quantile(errors, 0.95));
  };
  row("unwarped", "shown as it was drawn", unwarped);
  row("turned", "turned as the head turned", turned);
  row("warped", "warped by depth", warped);
  return out;
}

nlohmann::json cube_figures(HeadLab& lab, const PoseTrack& head, int width, int height) {
  constexpr Duration kFrame = std::chrono::milliseconds(100);
  constexpr int kMostFrames = 200;
  nlohmann::json out;
  if (head.samples().size() < 2) return out;
  const Lens eye = bench_eye(lab.camera(), width, height);
  const auto parts = std::make_shared<const WarpScene>(lab.session().scene());
  const LayerCapture capture(parts);
  PredictedView truth = lab.session().make_view(eye);
  const RobotTime begin = head.samples().front().time, end = head.samples().back().time;
  for (const bool moves : {false, true}) {
    CubeViews cube(parts, eye);
    PredictedView face_view = lab.session().make_view(cube.face_lens());
    std::vector<double> frame_ms, face_ms, drawn_ms, db;
    int served = 0;
    std::optional<Pose> first;
    for (RobotTime now = begin; now < end && static_cast<int>(db.size()) < kMostFrames; now = now + kFrame) {
      const auto at = head.at(now);
      if (at.status == StateStatus::invalid) continue;
      if (!first) first = at.pose;
      Pose motion = in_camera_axes(first->inverse() * at.pose);
      if (!moves) motion.translation().setZero();
      const Pose from = lab.T_world_camera() * motion;
      served += !cube.missing(from);
      while (const auto face = cube.missing(from)) {
        const Pose T_world_face = CubeViews::T_world_face(*face, from);
        face_ms.push_back(gpu_cpu_ms([&] {
          lab.session().draw(face_view, T_world_face, lab.state());
          capture(face_view.picture(), face_view.faces(), T_world_face, lab.state(), cube.layers(*face));
        }));
      }
      frame_ms.push_back(gpu_cpu_ms([&] { cube(from); }));
      drawn_ms.push_back(gpu_cpu_ms([&] { lab.session().draw(truth, from, lab.state()); }));
      db.push_back(
          picture_decibels(read_pixels(truth.picture(), GL_RGBA, CV_8UC4), read_pixels(cube(from), GL_RGBA, CV_8UC4)));
    }
    if (db.empty()) continue;
    const double share = served / static_cast<double>(db.size());
    const double mean_ms =
        median(frame_ms) + median(face_ms) * static_cast<double>(face_ms.size()) / static_cast<double>(db.size());
    std::printf(
        "a cube of views, head %-8s %5.1f %% of %zu frames need no new face (%zu drawn); a frame %.1f CPU-ms, with its "
        "share of "
        "faces of %.0f CPU-ms %.1f; drawn %.1f; %.1f dB\n",
        moves ? "moving:" : "turning:", 100 * share, db.size(), face_ms.size(), median(frame_ms), median(face_ms),
        mean_ms, median(drawn_ms), median(db));
    out[moves ? "moving" : "turning"] = {{"frames", db.size()},
                                         {"without_new_face", share},
                                         {"faces_drawn", face_ms.size()},
                                         {"face_cpu_ms", median(face_ms)},
                                         {"frame_cpu_ms", median(frame_ms)},
                                         {"frame_with_faces_cpu_ms", mean_ms},
                                         {"drawn_cpu_ms", median(drawn_ms)},
                                         {"db", median(db)}};
  }
  return out;
}

}  // namespace foresight
