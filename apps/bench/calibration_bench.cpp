#include "apps/bench/calibration_bench.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>

#include "apps/calibrate/camera_input.hpp"
#include "calibration/camera/camera_calibration.hpp"
#include "calibration/camera/rig_start.hpp"
#include "common/atomic_file.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr int kMostViews = 50;

CameraModel camera_of(const cv::Mat& K, const cv::Mat& d, int width, int height) {
  CameraModel camera{width, height, Distortion::radtan4, {}};
  camera.lens = {K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2)};
  for (int i = 0; i < 4; ++i) camera.lens[static_cast<std::size_t>(4 + i)] = d.at<double>(i);
  return camera;
}

// The way of OpenCV's own sample: each camera, then both; k3 held at zero as in radtan4.
Rig solve_with_opencv(const RigViews& views) {
  std::vector<std::vector<cv::Point3f>> object;
  std::array<std::vector<std::vector<cv::Point2f>>, 2> image;
  for (const RigView& view : views.views) {
    object.emplace_back();
    for (auto& of_camera : image) of_camera.emplace_back();
    for (std::size_t i = 0; i < view.corners[0].size(); ++i) {
      const Eigen::Vector3d& p = views.p_board[static_cast<std::size_t>(view.corners[0][i].index)];
      object.back().emplace_back(float(p.x()), float(p.y()), float(p.z()));
      for (std::size_t c = 0; c < 2; ++c) {
        const Eigen::Vector2d& pixel = view.corners[c][i].pixel;
        image[c].back().emplace_back(float(pixel.x()), float(pixel.y()));
      }
    }
  }
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9);
  std::array<cv::Mat, 2> K, d;
  std::vector<cv::Mat> turns, shifts;
  cv::Size size;
  for (std::size_t c = 0; c < 2; ++c) {
    size = {views.width[c], views.height[c]};
    cv::calibrateCamera(object, image[c], size, K[c], d[c], turns, shifts, cv::CALIB_FIX_K3, stop);
  }
  cv::Mat R, t, E, F;
  cv::stereoCalibrate(object, image[0], image[1], K[0], d[0], K[1], d[1], size, R, t, E, F,
                      cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_K3, stop);
  Pose T_right_left = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) T_right_left.linear()(row, col) = R.at<double>(row, col);
    T_right_left.translation()[row] = t.at<double>(row);
  }
  return {
      {camera_of(K[0], d[0], views.width[0], views.height[0]), camera_of(K[1], d[1], views.width[1], views.height[1])},
      T_right_left.inverse(),
      {}};
}

Rig solve_with_ours(const RigViews& views) {
  RigSolverOptions alone;
  alone.warp = false;
  std::array<RigSolution, 2> cameras;
  for (int c = 0; c < 2; ++c) {
    const CameraViews one = views_of(views, c);
    cameras[static_cast<std::size_t>(c)] = solve_rig(one.views, start_camera(one.views, Distortion::radtan4), alone);
  }
  return solve_rig(views, start_pair(views, cameras[0], cameras[1]), {}).rig;
}

template <typename Solve>
HeldOutScore left_out(const RigViews& views, const Solve& solve) {
  double joint = 0, cross = 0, epipolar = 0;
  for (std::size_t out = 0; out < views.views.size(); ++out) {
    std::vector<std::size_t> kept;
    for (std::size_t v = 0; v < views.views.size(); ++v)
      if (v != out) kept.push_back(v);
    const HeldOutScore score = score_views(solve(subset(views, kept)), subset(views, {out}));
    joint += score.joint_px * score.joint_px, cross += score.cross_px * score.cross_px, epipolar += score.epipolar_px;
  }
  const auto n = static_cast<double>(views.views.size());
  return {std::sqrt(joint / n), std::sqrt(cross / n), epipolar / n, static_cast<int>(n)};
}

// Views that both cameras saw whole: what OpenCV's call takes.
RigViews whole_pairs(const RigViews& all) {
  std::vector<std::size_t> kept;
  for (std::size_t v = 0; v < all.views.size() && kept.size() < kMostViews; ++v)
    if (all.views[v].corners[0].size() == all.p_board.size() && all.views[v].corners[1].size() == all.p_board.size())
      kept.push_back(v);
  if (kept.size() < 5)
    throw InputError("corners", "fewer than 5 pairs show the whole board", "give corners of a board seen whole");
  return subset(all, kept);
}

}  // namespace

int bench_calibration(const CalibrationBenchOptions& options) {
  CameraInput input;
  input.corners = options.corners;
  input.board = options.board;
  input.size = options.size;
  const RigViews views = whole_pairs(read_camera_input(input, true).train);
  std::vector<double> ours, theirs;
  for (int run = 0; run < options.runs; ++run) {
    const double t0 = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    solve_with_ours(views);
    const double t1 = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    solve_with_opencv(views);
    ours.push_back(t1 - t0);
    theirs.push_back(cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - t1);
  }
  const HeldOutScore a = left_out(views, solve_with_ours), b = left_out(views, solve_with_opencv);
  const double ratio = median(theirs) / median(ours);
  std::printf("%zu pairs, %zu points        CPU time    joint    cross    epipolar, left out, px\n", views.views.size(),
              views.p_board.size());
  const auto row = [](const char* name, double seconds, const HeldOutScore& s) {
    std::printf("%-28s %7.3f s  %7.4f  %7.4f  %7.4f\n", name, seconds, s.joint_px, s.cross_px, s.epipolar_px);
  };
  row("foresight", median(ours), a);
  row("cv::stereoCalibrate", median(theirs), b);
  std::printf("OpenCV takes %.1f times as long\n", ratio);
  if (options.json) {
    const auto json = [](double seconds, const HeldOutScore& s) {
      return nlohmann::ordered_json{{"cpu_s", seconds},
                                    {"loo_joint_px", s.joint_px},
                                    {"loo_cross_px", s.cross_px},
                                    {"loo_epipolar_px", s.epipolar_px}};
    };
    const nlohmann::ordered_json all{{"views", views.views.size()},
                                     {"foresight", json(median(ours), a)},
                                     {"opencv", json(median(theirs), b)},
                                     {"time_ratio", ratio}};
    write_file_atomically(*options.json, all.dump(2) + "\n");
  }
  return a.joint_px <= b.joint_px ? 0 : 1;
}

}  // namespace foresight
