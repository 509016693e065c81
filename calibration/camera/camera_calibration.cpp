#include "calibration/camera/camera_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "calibration/camera/input_checks.hpp"
#include "calibration/camera/model_choice.hpp"
#include "calibration/camera/rig_start.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr int kFewViews = 10;  // fewer are warned about
constexpr int kEnoughViews = 15;
// Of the image's width, between lenses from every second view. All views together know the lens two to four times as
// well: to a pixel or so, which is where ghosts begin.
constexpr double kVagueHalves = 0.005;
constexpr double kUnsynchronised = 1.4;
constexpr int kGroups = 10;         // of views left out together where there are many
constexpr double kMovedByWarp = 2;  // the lens by more than so many times the error: not believed

class Calibrator {
 public:
  Calibrator(const RigViews& train, const RigViews& test, const CameraCalibrationOptions& options)
      : options_(options), test_(test) {
    result_.views = train;
  }

  CameraCalibration run() {
    check_views(result_.views, result_.notes);
    check_orientation(result_.views, result_.repairs);
    choose_views();
    solver_ = options_.solver;
    const ModelScreening models =
        options_.model ? ModelScreening{*options_.model, {}} : screen_models(result_.views, solver_);
    solve(models.simplest);
    if (auto better = better_model(result_.views, result_.solution, models.richer, solver_))
      result_.solution = std::move(*better);
    doubt_warp();
    measure_uncertainty();
    measure_held_out();
    judge();
    return std::move(result_);
  }

 private:
  std::size_t cameras() const { return static_cast<std::size_t>(result_.views.cameras); }

  // Evenly; the others go to the unseen ones.
  void choose_views() {
    const std::size_t n = result_.views.views.size(), most = static_cast<std::size_t>(options_.most_views);
    if (n <= most) return;
    std::vector<std::size_t> taken, others;
    for (std::size_t v = 0; v < n; ++v) ((v + 1) * most / n > v * most / n ? taken : others).push_back(v);
    unseen_ = subset(result_.views, others);
    result_.views = subset(result_.views, taken);
    result_.notes.push_back(std::to_string(most) + " of " + std::to_string(n) +
                            " views were taken, evenly; the others only score");
  }

  void solve(Distortion distortion) {
    result_.warp = options_.warp && useful_views(result_.views) >= options_.warp_from_views;
    solver_.warp = result_.warp;
    RigSolution left = solve_alone(result_.views, 0, distortion, solver_);
    if (cameras() == 1) {
      result_.solution = solve_rig(result_.views, left, solver_);
      return;
    }
    RigSolution right = solve_alone(result_.views, 1, distortion, solver_);
    const std::size_t before = result_.repairs.turned.size() + result_.repairs.dropped.size();
    check_pairs(result_.views, left, right, result_.repairs);
    if (result_.repairs.turned.size() + result_.repairs.dropped.size() > before) {
      if (useful_views(result_.views) < kFewestViews)
        throw InputError("pairs",
                         "only " + std::to_string(useful_views(result_.views)) + " belong together; " +
                             result_.repairs.dropped.front(),
                         "take pairs of images at the same instants");
      left = solve_alone(result_.views, 0, distortion, solver_);
      right = solve_alone(result_.views, 1, distortion, solver_);
    }
    const double alone = std::sqrt(0.5 * (left.noise_px * left.noise_px + right.noise_px * right.noise_px));
    result_.solution = solve_rig(result_.views, start_pair(result_.views, left, right), solver_);
    result_.stereo_over_mono = result_.solution.noise_px / std::max(alone, 1e-9);
  }

  int folds() const {
    const int n = static_cast<int>(result_.views.views.size());
    return n <= options_.most_folds ? n : std::min(n, kGroups);
  }

  // A bent board and another focal length look alike where boards are little tilted. The warp mends a small part of
  // the error; where it also moves the lens by more than all of it, the views cannot tell which of the two it is.
  void doubt_warp() {
    if (!result_.warp) return;
    RigSolverOptions flat = solver_;
    flat.warp = false;
    RigSolution start = result_.solution;
    start.rig.warp = {};
    RigSolution solution = solve_rig(result_.views, start, flat);
    double moved_px = 0;
    for (std::size_t c = 0; c < cameras(); ++c)
      moved_px = std::max(moved_px, lens_difference(solution.rig.cameras[c], result_.solution.rig.cameras[c]));
    if (moved_px <= kMovedByWarp * solution.rms_px) return;
    result_.notes.push_back(
        "the board is taken as flat: its warp moves the lens by " + readable(moved_px, 1) +
        " px, so that the views cannot tell one from the other; take some with the board tilted more");
    result_.solution = std::move(solution);
    result_.warp = false;
    solver_ = flat;
  }

  void measure_uncertainty() {
    const RigUncertainty uncertainty(result_.views, result_.solution, result_.warp);
    std::vector<double> distances;
    for (const Pose& T : result_.solution.T_left_board) distances.push_back(T.translation().norm());
    result_.board_distance_m = median(std::move(distances));
    for (std::size_t c = 0; c < cameras(); ++c) {
      result_.at_infinity[c] = uncertainty.map(static_cast<int>(c), std::nullopt);
      result_.at_board[c] = uncertainty.map(static_cast<int>(c), result_.board_distance_m);
    }
    store_sigmas(uncertainty);
    if (const auto missing = missing_motion(result_.views, result_.solution, uncertainty))
      result_.verdict.against.push_back(*missing);
  }

  void store_sigmas(const RigUncertainty& uncertainty) {
    for (std::size_t c = 0; c < cameras(); ++c) {
      static constexpr std::array<const char*, 4> kNames{"fx", "fy", "cx", "cy"};
      const LensParameters sigma = uncertainty.lens_sigma(static_cast<int>(c));
      const std::string side = cameras() == 2 ? "_" + camera_name(static_cast<int>(c), 2) : "";
      for (std::size_t i = 0; i < kNames.size(); ++i) result_.sigma[kNames[i] + side + "_px"] = sigma[i];
    }
    if (cameras() == 2) {
      result_.sigma["baseline_m"] = uncertainty.baseline_sigma_m();
      result_.sigma["rotation_deg"] = uncertainty.rotation_sigma_rad() * 180 / M_PI;
    }
    if (result_.warp) {
      result_.sigma["warp_x_m"] = uncertainty.warp_sigma_m().x();
      result_.sigma["warp_y_m"] = uncertainty.warp_sigma_m().y();
    }
  }

  void measure_held_out() {
    const RigViews& scoring = test_.views.empty() ? result_.views : test_;
    std::set<std::string> names;
    for (const RigView& view : result_.views.views) names.insert(view.name);
    for (const RigView& view : test_.views)
      if (!names.count(view.name)) {
        if (unseen_.views.empty()) unseen_ = subset(test_, {});
        unseen_.views.push_back(view);
      }
    const LeaveOut left_out = leave_out(result_.views, scoring, result_.solution, solver_, folds());
    result_.held_out = left_out.score;
    result_.folds = left_out.folds;
    if (!unseen_.views.empty()) result_.unseen = score_views(result_.solution.rig, unseen_);
    odd_even();
  }

  void odd_even() {
    std::array<RigSolution, 2> halves;
    for (std::size_t half = 0; half < 2; ++half) {
      std::vector<std::size_t> kept;
      RigSolution start = result_.solution;
      start.T_left_board.clear();
      start.rejected.clear();
      for (std::size_t v = half; v < result_.views.views.size(); v += 2) {
        kept.push_back(v);
        start.T_left_board.push_back(result_.solution.T_left_board[v]);
      }
      halves[half] = solve_rig(subset(result_.views, kept), start, solver_);
    }
    for (std::size_t c = 0; c < cameras(); ++c)
      result_.odd_even_px[c] = lens_difference(halves[0].rig.cameras[c], halves[1].rig.cameras[c]);
  }

  void judge() {
    const int count = useful_views(result_.views);
    if (count < kFewViews)
      result_.notes.push_back("only " + counted(count, cameras() == 2 ? "pair" : "view") +
                              "; take 15 or more for figures that can be trusted");
    if (result_.stereo_over_mono > kUnsynchronised)
      result_.verdict.object("the pairs are not synchronised, or the cameras moved against each other: the error is " +
                                 readable(result_.stereo_over_mono, 2) +
                                 " times that of the cameras alone (1.4 is the limit)",
                             "trigger both at once, or hold the board still");
    if (count < kEnoughViews) judge_halves(count);
    if (cameras() == 2) judge_baseline();
    const auto rejected = static_cast<double>(result_.solution.rejected.size());
    if (rejected > 0.1 * (result_.solution.points + rejected))
      result_.notes.push_back("over a tenth of the corners do not fit; look for blurred or wrong views");
    if (const std::vector<std::string> names = strange_views(); !names.empty())
      result_.notes.push_back("most corners of " + joined(names) +
                              " do not fit the other views: take them out if they are another camera's, or blurred");
    if (!result_.solution.converged)
      result_.verdict.object("the solver did not converge",
                             "take other views, and check that --board is what was shown");
  }

  /// Most of whose corners are rejected.
  std::vector<std::string> strange_views() const {
    std::vector<std::size_t> rejected(result_.views.views.size());
    for (const RejectedCorner& corner : result_.solution.rejected) ++rejected[corner.view];
    std::vector<std::string> out;
    for (std::size_t v = 0; v < rejected.size(); ++v) {
      const RigView& view = result_.views.views[v];
      if (2 * rejected[v] > view.corners[0].size() + view.corners[1].size()) out.push_back("view " + view.name);
    }
    return out;
  }

  /// Few views look more certain than they are: what the board or the corners have in common, each view has anew.
  void judge_halves(int count) {
    for (std::size_t c = 0; c < cameras(); ++c) {
      const double px = result_.odd_even_px[c];
      if (px <= kVagueHalves * result_.views.width[c]) continue;
      const std::string whose = cameras() == 2 ? " of the " + camera_name(static_cast<int>(c), 2) + " camera" : "";
      result_.verdict.object(
          counted(count, cameras() == 2 ? "pair" : "view") + " are too few: every second one gives a lens" + whose +
              " that " +
              (std::isfinite(px) ? "differs from the others' by " + readable(px, 1, " px") : "the others contradict") +
              " (0.5 % of the image's width is the limit)",
          "take 15 and more, with the board tilted to all sides and in all corners of the image");
      return;
    }
  }

  void judge_baseline() {
    const Eigen::Vector3d t = result_.solution.rig.T_left_right.translation();
    if (t.norm() < 5 * result_.sigma["baseline_m"])
      result_.verdict.object("both cameras stand at one place", "give the images of two cameras, not one's twice");
    else if (-t.x() > 0.5 * t.norm())
      result_.verdict.object(
          "the right camera stands " + readable(-1000 * t.x(), 1) + " mm to the left of the left one",
          "exchange left and right, in the folders and in the rig; where both cameras hang upside "
          "down, the one on the other side is their left one");
  }

  const CameraCalibrationOptions& options_;
  const RigViews& test_;
  RigSolverOptions solver_;
  RigViews unseen_;
  CameraCalibration result_;
};

}  // namespace

CameraCalibration calibrate_rig(const RigViews& train, const RigViews& test, const CameraCalibrationOptions& options) {
  return Calibrator(train, test, options).run();
}

}  // namespace foresight
