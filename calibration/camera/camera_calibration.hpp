// From corners to one calibrated camera or a pair, with what a reader needs to trust it.
#pragma once

#include <map>

#include "calibration/camera/held_out.hpp"
#include "calibration/camera/pair_checks.hpp"
#include "calibration/camera/uncertainty.hpp"
#include "calibration/result/verdict.hpp"

namespace foresight {

struct CameraCalibrationOptions {
  /// None: radtan4, or that of radtan5, rational and equidistant which model_choice.hpp finds better.
  std::optional<Distortion> model;
  bool warp = true;         ///< estimates the board's warp, from `warp_from_views` on
  int warp_from_views = 8;  ///< fewer cannot tell it from the lens
  RigSolverOptions solver;
  int most_views = 100;  ///< of more, so many are taken, evenly; the others only score
  int most_folds = 50;   ///< up to so many views are left out one by one; more in ten groups
};

struct CameraCalibration {
  RigSolution solution;
  RigViews views;  ///< those that were used, repaired
  bool warp = false;
  ViewRepairs repairs;
  std::vector<std::string> notes;  ///< warnings for the reader
  Verdict verdict;

  HeldOutScore held_out;  ///< views left out
  int folds = 0;
  std::optional<HeldOutScore>
      unseen;                   ///< views that were never used: test corners of other names, or more than most_views
  double stereo_over_mono = 1;  ///< noise of the pair over that of its cameras alone
  std::array<double, 2> odd_even_px{};  ///< middle difference between solutions of every second view
  std::array<UncertaintyMap, 2> at_infinity;
  std::array<UncertaintyMap, 2> at_board;  ///< at board_distance_m
  double board_distance_m = 0;             ///< the middle one
  std::map<std::string, double> sigma;     ///< name with unit -> standard deviation

  bool usable() const { return verdict.usable(); }
  std::size_t cameras() const { return static_cast<std::size_t>(views.cameras); }
  std::string brief() const;  ///< one line
  std::string full() const;   ///< a page
};

/// `test`: corners that only score; of views that `train` has too, they score when that view is left
/// out. Its board must be the same. Throws InputError where no calibration can be had: fewer than 5
/// views, pairs that do not belong together (pair_checks.hpp), corners outside the image.
CameraCalibration calibrate_rig(const RigViews& train, const RigViews& test, const CameraCalibrationOptions& options);

/// What the boards would have to do so that everything can be told apart, where it cannot: such as
/// "all boards are parallel to the image ...". Nothing where all is well.
std::optional<Objection> missing_motion(const RigViews& views, const RigSolution& solution,
                                        const RigUncertainty& uncertainty);

/// Middle difference over the image, in px, of where two lenses see one ray, after the turn between
/// them that makes it smallest.
double lens_difference(const CameraModel& a, const CameraModel& b);

}  // namespace foresight
