#include "apps/bench/head_motion_figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/statistics.hpp"
#include "display/warp/cube_views.hpp"
#include "gl/read_texture.hpp"

namespace foresight {
namespace {

constexpr Duration kAge = std::chrono::milliseconds(50), kEvery = std::chrono::milliseconds(500);
constexpr int kMostInstants = 100, kStep = 8;           // px between the pixels that are looked at
constexpr double kSway = 0.04, kTurn = 0.12;            // m and rad of a head's sway
constexpr double kSwayRate = 0.4, kTurnRate = 0.3;      // Hz
constexpr double kSwaySeconds = 20, kSwaySamples = 60;  // a second

Eigen::Vector2d place(const Lens& lens, const Eigen::Vector3d& p) {
  const auto& k = lens.parameters();
  return {k.fx * p.x() / p.z() + k.cx, k.fy * p.y() / p.z() + k.cy};
}

/// How a cube of views is used.
struct CubeTrial {
  const char *key, *words;
  bool moves;                   // else the head turns on the spot
  bool with_images;             // as many come as frames by kImageEvery
  std::vector<double> borders;  // of shells
};

nlohmann::json cube_row(HeadLab& lab, const PoseTrack& head, const Lens& eye, const CubeTrial& trial, int most_frames) {
  constexpr Duration kFrame = std::chrono::milliseconds(100);
  constexpr int kImageEvery = 2;
  const auto parts = std::make_shared<const WarpScene>(lab.session().scene());
  LayerCapture capture(parts);
  PredictedView truth = lab.session().make_view(eye);
  CubeViews cube(parts, eye, trial.borders);
  PredictedView face_view = lab.session().make_view(cube.face_lens());
  std::vector<double> frame_ms, drawn_ms, db;
  double faces_ms = 0;
  std::vector<int> faces(cube.shells(), 0);
  int served = 0;
  std::optional<Pose> first;
  const auto draw = [&](const CubeViews::Face& face, const Pose& from) {
    const Pose T_world_face = CubeViews::T_world_face(face.side, from);
    face_view.draw_part(cube.shells() > 1 ? std::optional(cube.part(face.shell)) : std::nullopt);
    lab.session().draw(face_view, T_world_face, lab.state());
    capture(face_view.picture(), face_view.faces(), T_world_face, lab.state(), cube.layers(face));
  };
  for (RobotTime now = head.samples().front().time;
       now < head.samples().back().time && static_cast<int>(db.size()) < most_frames; now = now + kFrame) {
    const auto at = head.at(now);
    if (at.status == StateStatus::invalid) continue;
    if (!first) first = at.pose;
    Pose motion = in_camera_axes(first->inverse() * at.pose);
    if (!trial.moves) motion.translation().setZero();
    const Pose from = lab.T_world_camera() * motion;
    if (trial.with_images && db.size() % kImageEvery == 0) cube.changed();
    served += !cube.missing(from);
    while (const auto face = cube.missing(from)) {
      faces_ms += gpu_cpu_ms([&] { draw(*face, from); });
      ++faces[face->shell];
    }
    frame_ms.push_back(gpu_cpu_ms([&] { cube(from); }));
    drawn_ms.push_back(gpu_cpu_ms([&] { lab.session().draw(truth, from, lab.state()); }));
    db.push_back(picture_decibels(gl::read_texture(truth.picture()), gl::read_texture(cube(from))));
  }
  if (db.empty()) return nullptr;
  const auto frames = static_cast<double>(db.size());
  const double mean_ms = median(frame_ms) + faces_ms / frames;
  std::string drawn;
  for (const int count : faces) drawn += (drawn.empty() ? "" : " + ") + std::to_string(count);
  std::printf(
      "a cube of views, %-44s %5.1f %% of %.0f frames need no new face (%s drawn); a frame %5.1f CPU-ms, with its "
      "share "
      "of faces %5.1f; drawn %.1f; %.1f dB, worst %.1f\n",
      trial.words, 100 * served / frames, frames, drawn.c_str(), median(frame_ms), mean_ms, median(drawn_ms),
      median(db), *std::ranges::min_element(db));
  return {{"frames", db.size()},
          {"without_new_face", served / frames},
          {"faces_drawn", faces},
          {"faces_cpu_ms", faces_ms},
          {"frame_cpu_ms", median(frame_ms)},
          {"frame_with_faces_cpu_ms", mean_ms},
          {"drawn_cpu_ms", median(drawn_ms)},
          {"db", {{"median", median(db)}, {"worst", *std::ranges::min_element(db)}}}};
}

}  // namespace

Pose swayed(double t) {
  constexpr double kRound = 2 * EIGEN_PI;
  Pose out = Pose::Identity();
  out.translation() = kSway * Eigen::Vector3d(std::sin(kRound * kSwayRate * t), 0.3 * std::sin(kRound * 0.7 * t), 0);
  out.linear() = (Eigen::AngleAxisd(kTurn * std::sin(kRound * kTurnRate * t), Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(0.4 * kTurn * std::sin(kRound * 0.5 * t), Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  return out;
}

PoseTrack swaying_head() {
  std::vector<PoseTrack::Sample> samples;
  for (int i = 0; i < kSwaySeconds * kSwaySamples; ++i) {
    const double t = i / kSwaySamples;
    samples.push_back({RobotTime{static_cast<std::int64_t>(1e9 * t)}, swayed(t)});
  }
  return PoseTrack(std::move(samples));
}

nlohmann::json head_motion_figures(HeadLab& lab, const PoseTrack& head, int width, int height) {
  const int guard = static_cast<int>(kGuardShare * width);
  const Lens eye = bench_eye(lab.camera(), width, height), wide = bench_eye(lab.camera(), width, height, guard);
  const auto parts = std::make_shared<const WarpScene>(lab.session().scene());
  LayerCapture capture(parts);
  PredictedView source = lab.session().make_view(wide), truth = lab.session().make_view(eye);
  WarpLayers layers(wide), true_layers(eye);
  DepthWarp warp(parts, eye);
  std::vector<double> unwarped, turned, warped;
  if (head.samples().size() < 2) return {};
  const Pose& to = lab.T_world_camera();
  const RobotTime begin = head.samples().front().time + kAge, end = head.samples().back().time;
  int views = 0;
  for (RobotTime now = begin; now < end && views < kMostInstants; now = now + kEvery, ++views) {
    const auto before = head.at(now - kAge), then = head.at(now);
    if (before.status == StateStatus::invalid || then.status == StateStatus::invalid) continue;
    const Pose T_before_now = in_camera_axes(before.pose.inverse() * then.pose);
    const Pose from = to * T_before_now.inverse();
    lab.session().draw(source, from, lab.state());
    capture(source.picture(), source.faces(), from, lab.state(), layers);
    lab.session().draw(truth, to, lab.state());
    capture(truth.picture(), truth.faces(), to, lab.state(), true_layers);
    warp(layers, to);
    const cv::Mat q_true = gl::read_texture(true_layers.depth), q_warped = gl::read_texture(warp.depth());
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

nlohmann::json cube_figures(HeadLab& lab, const PoseTrack& head, int width, int height, int frames) {
  if (head.samples().size() < 2) return nullptr;
  const std::vector<double> shells{1.0};  // m: the arm and what it works at, and what is around
  const Lens eye = bench_eye(lab.camera(), width, height);
  nlohmann::json out;
  for (const CubeTrial& trial :
       {CubeTrial{"turning", "head turning:", false, false, {}}, CubeTrial{"moving", "head moving:", true, false, {}},
        CubeTrial{"moving_in_shells", "head moving, in shells:", true, false, shells},
        CubeTrial{"turning_with_images", "head turning, 5 images/s:", false, true, {}},
        CubeTrial{"turning_with_images_in_shells", "head turning, 5 images/s, in shells:", false, true, shells}})
    out[trial.key] = cube_row(lab, head, eye, trial, frames);
  return out;
}

}  // namespace foresight
