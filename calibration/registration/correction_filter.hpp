// What refined poses of past images tell about poses that are not refined yet.
//
//   given pose   G_i            of every image, with an error of its own
//   refined pose A_i = G_i D_i  of the images that have arrived; D_i: the correction
//
// Nobody knows beforehand whether corrections persist (a joint offset), jump from image to image
// (a noisy tracker) or whether the camera moves smoothly enough to bridge the delay. So several
// predictions of D run side by side, and each is trusted by how it did so far: weights that sum to one
// and would have given the least mean squared displacement over past images (Bates and Granger,
// "The combination of forecasts", 1969), starting from the given poses.
//
// Gauge: refined poses agree with each other, not with the world. Each gives up a small share of the
// mean correction, so that the whole neither drifts away nor keeps the first image's error.
//
// Doubt: where the model is wrong, an alignment follows its errors, which change from view to view. A camera
// moves smoothly; so refined poses are used only while they do not make its motion rougher (third
// differences, root mean square in px) than the given ones do.
#pragma once

#include <deque>
#include <map>

#include "calibration/registration/twist.hpp"
#include "common/time.hpp"

namespace foresight {

struct CorrectionFilterOptions {
  double to_given = 0.05;     ///< share of the mean correction that each refined pose gives up; 0 .. 1
  double mean_share = 0.1;    ///< of the newest correction in the mean one; 0 .. 1
  double forgetting = 0.95;   ///< weight of past predictions, per image; 0 .. 1
  double given_px = 2;        ///< expected error of given poses before anything is known
  double other_px = 2;        ///< the same of the other predictions
  double prior_images = 0.5;  ///< for how many images the two expectations count
  double rougher = 1.05;      ///< refined poses are used while they are rougher by no more than this factor
  std::size_t memory = 32;    ///< images that are kept before the newest refined one
};

/// One thread. Images in ascending order of time.
class CorrectionFilter {
 public:
  struct Prediction {
    Pose T_world_camera = Pose::Identity();
    double sigma_px = 0;  ///< predicted root mean square displacement of it against the refined poses
  };

  explicit CorrectionFilter(const CorrectionFilterOptions& options) : options_(options) {}

  /// The given pose of the next image is known.
  void add_given(RobotTime time, const Pose& T_world_camera);

  /// The image of `time`, which must have been given, was refined to `T_world_camera`. `px_metric`
  /// as in RefinementSummary. Returns the pose to use, drawn to the given one.
  Pose add_refined(RobotTime time, const Pose& T_world_camera, const Matrix6d& px_metric);

  /// The pose of the image of `time`, which must have been given, from the given poses up to it and
  /// the refined poses before it.
  Prediction predict(RobotTime time);

  /// Do the refined poses not make the motion rougher? True as long as there are too few of them.
  bool helps() const { return roughness_given_ == 0 || roughness_found_ < square(options_.rougher) * roughness_given_; }

  /// Uncertainty of the gauge: how far all refined poses together may be off, px.
  double gauge_px() const;

 private:
  static constexpr int kCandidates = 7;
  using Candidates = Eigen::Matrix<double, 6, kCandidates>;  // a correction each
  using Products = Eigen::Matrix<double, kCandidates, kCandidates>;
  struct Entry {
    RobotTime time;
    Pose given;
    std::optional<Pose> refined = {};
    std::optional<Pose> found = {};            // refined, before its share was given up
    std::map<int, Candidates> predicted = {};  // by lag: images since the newest refined one
  };

  static double square(double x) { return x * x; }
  void compare_roughness(std::size_t at, const Matrix6d& px_metric);
  std::size_t index_of(RobotTime time) const;
  std::optional<std::size_t> newest_refined(std::size_t before) const;
  Candidates candidates(std::size_t at, std::size_t newest) const;
  Vector6d smooth_motion(std::size_t at, std::size_t newest, int degree, std::size_t images, double given_weight) const;
  Products prior() const;

  CorrectionFilterOptions options_;
  std::deque<Entry> entries_;
  std::map<int, Products> products_;  // by lag: sums of the candidates' errors times each other, px^2
  std::map<int, double> weights_;
  Vector6d mean_correction_ = Vector6d::Zero();
  double mean_square_px_ = 0, mean_weight_ = 0;
  double refined_ = 0;
  double roughness_given_ = 0, roughness_found_ = 0;  // sums, px^2
};

}  // namespace foresight
