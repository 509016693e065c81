#include "apps/bench/calibration_bench.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "apps/calibrate/camera_input.hpp"
#include "calibration/camera/camera_calibration.hpp"
#include "calibration/camera/rig_start.hpp"
#include "calibration/target/find_corners.hpp"
#include "calibration/target/image_input.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

constexpr int kMostViews = 50;
constexpr double kSimulatedNoise = 0.15;  // px

CameraModel camera_of(const cv::Mat& K, const cv::Mat& d, int width, int height) {
  CameraModel camera{width, height, Distortion::radtan4, {}};
  camera.lens = {K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2)};
  for (int i = 0; i < 4; ++i) camera.lens[static_cast<std::size_t>(4 + i)] = d.at<double>(i);
  return camera;
}

// The way of OpenCV's own sample: each camera, then both; k3 held at zero as in radtan4.
CameraRig solve_with_opencv(const RigViews& views) {
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
      {{camera_of(K[0], d[0], views.width[0], views.height[0]), camera_of(K[1], d[1], views.width[1], views.height[1])},
       T_right_left.inverse()},
      {}};
}

CameraRig solve_with_ours(const RigViews& views) {
  return solve_from_nothing(views, Distortion::radtan4, {}).rig;
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
  HeldOutScore score;
  score.joint_px = std::sqrt(joint / n), score.cross_px = std::sqrt(cross / n), score.epipolar_px = epipolar / n;
  score.views = static_cast<int>(n);
  return score;
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

double cpu_of(const std::function<void()>& work) {
  const double begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  work();
  return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - begin;
}

// The board's places of `solution` with another turn each, as its cameras would see them.
RigViews simulated_pairs(const RigViews& seen, const RigSolution& solution, int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> turn(-0.2, 0.2);
  std::normal_distribution<double> noise(0, kSimulatedNoise);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : seen.p_board) middle += p / static_cast<double>(seen.p_board.size());
  RigViews views = subset(seen, {});
  for (int tries = 0; static_cast<int>(views.views.size()) < count && tries < 100 * count; ++tries) {
    Pose T = solution.T_left_board[static_cast<std::size_t>(tries) % solution.T_left_board.size()];
    const Eigen::Vector3d by(turn(random), turn(random), turn(random));
    T = T * Eigen::Translation3d(middle) * Eigen::AngleAxisd(by.norm(), by.normalized()) *
        Eigen::Translation3d(-middle);
    RigView view{std::to_string(views.views.size()), {}};
    for (std::size_t i = 0; i < 2 * seen.p_board.size(); ++i) {
      const std::size_t c = i % 2, index = i / 2;
      const Eigen::Vector3d p = to_camera(solution.rig, static_cast<int>(c), T * seen.p_board[index]);
      const auto pixel = project(solution.rig.cameras[c], p);
      if (!pixel || pixel->minCoeff() < 1 || pixel->x() > seen.width[c] - 2 || pixel->y() > seen.height[c] - 2) break;
      view.corners[c].push_back({static_cast<int>(index), *pixel + Eigen::Vector2d(noise(random), noise(random)), 1});
    }
    if (view.corners[1].size() == seen.p_board.size()) views.views.push_back(std::move(view));
  }
  return views;
}

double baseline_error_mm(const CameraRig& found, const CameraRig& truth) {
  return 1000 * (found.T_left_right.translation() - truth.T_left_right.translation()).norm();
}

nlohmann::ordered_json bench_simulated(const RigViews& seen) {
  const RigSolution truth = solve_from_nothing(seen, Distortion::radtan4, {});
  const RigViews views = simulated_pairs(seen, truth, kMostViews);
  CameraRig ours, theirs;
  const double our_time = cpu_of([&] { ours = solve_with_ours(views); });
  const double their_time = cpu_of([&] { theirs = solve_with_opencv(views); });
  const double our_error = baseline_error_mm(ours, truth.rig), their_error = baseline_error_mm(theirs, truth.rig);
  std::printf("%zu simulated pairs            CPU time    error of the right camera's place\n", views.views.size());
  std::printf("%-28s %7.3f s  %7.4f mm\n", "foresight", our_time, our_error);
  std::printf("%-28s %7.3f s  %7.4f mm\n", "cv::stereoCalibrate", their_time, their_error);
  return {{"views", views.views.size()},
          {"foresight", {{"cpu_s", our_time}, {"error_mm", our_error}}},
          {"opencv", {{"cpu_s", their_time}, {"error_mm", their_error}}}};
}

bool find_with_opencv(const cv::Mat& grey, const Board& board) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(grey, {board.cols, board.rows}, corners)) return false;
  cv::cornerSubPix(grey, corners, {11, 11}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  return true;
}

nlohmann::ordered_json bench_detection(const std::filesystem::path& images, const Board& board) {
  if (board.kind != BoardKind::chessboard)
    throw InputError("--images", "are compared with OpenCV on chessboards only",
                     "give --board chessboard:COLSxROWS:SIZE_M");
  BoardFinder finder(board);
  std::array<double, 2> time{};
  std::array<int, 2> found{};
  const auto files = list_images(images);
  for (const auto& file : files) {
    const cv::Mat grey = read_picture(file, PictureColours::grey);
    time[0] += cpu_of([&] { found[0] += finder.find(grey).has_value(); });
    time[1] += cpu_of([&] { found[1] += find_with_opencv(grey, board); });
  }
  const auto n = static_cast<double>(files.size());
  std::printf("%zu images                     CPU time an image    boards found\n", files.size());
  std::printf("%-28s %7.3f s  %4d\n", "foresight", time[0] / n, found[0]);
  std::printf("%-28s %7.3f s  %4d\n", "cv::findChessboardCorners", time[1] / n, found[1]);
  return {{"images", files.size()},
          {"foresight", {{"cpu_s", time[0] / n}, {"found", found[0]}}},
          {"opencv", {{"cpu_s", time[1] / n}, {"found", found[1]}}}};
}

}  // namespace

int bench_calibration(const CalibrationBenchOptions& options) {
  CornerInput input;
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
  const auto simulated = bench_simulated(views);
  nlohmann::ordered_json detection;
  if (options.images) detection = bench_detection(*options.images, parse_board(options.board));
  if (options.json) {
    const auto json = [](double seconds, const HeldOutScore& s) {
      return nlohmann::ordered_json{{"cpu_s", seconds},
                                    {"loo_joint_px", s.joint_px},
                                    {"loo_cross_px", s.cross_px},
                                    {"loo_epipolar_px", s.epipolar_px}};
    };
    nlohmann::ordered_json all{{"views", views.views.size()},
                               {"foresight", json(median(ours), a)},
                               {"opencv", json(median(theirs), b)},
                               {"time_ratio", ratio},
                               {"simulated", simulated}};
    if (options.images) all["detection"] = detection;
    write_numbers(options.json, all.dump(2));
  }
  return a.joint_px <= b.joint_px ? 0 : 1;
}

}  // namespace foresight
