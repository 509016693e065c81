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
// differences, root mean square in px) than the given ones do. A change of mind moves all textures, so that
// the way back needs a clear difference.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>

#include "calibration/camera/twist.hpp"
#include "calibration/registration/motion_model.hpp"
#include "common/time.hpp"

namespace foresight {

struct CorrectionFilterOptions {
  double to_given = 0.05;      ///< share of the mean correction that each refined pose gives up; 0 .. 1
  double mean_share = 0.1;     ///< of the newest correction in the mean one; 0 .. 1
  double alignment_px = 0.15;  ///< by which exact poses are corrected, as textures follow what was aligned to them
  double forgetting = 0.95;    ///< weight of past predictions, per image; 0 .. 1
  double given_px = 2;         ///< expected error of given poses before anything is known
  double prior_images = 0.5;   ///< for how many images the expected errors of the predictions count at first
  /// How the camera may move and its given poses may err.
  static constexpr std::size_t kModels = 5;
  std::array<MotionModel, kModels> models = {
      {{0.14, 10, 0}, {0.1, 4, 0}, {0.2, 20, 0}, {0.14, 10, 0.3}, {0.14, 10, 3}}};
  double rougher = 1.05;    ///< refined poses are doubted when they are rougher by more than this factor
  double smoother = 0.7;    ///< and trusted again when they are smoother by this factor; below 1
  std::size_t memory = 32;  ///< images that are kept before the newest refined one
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

  /// Are refined poses in use? True as long as there are too few of them for a doubt.
  bool helps() const { return trusted_; }

  /// Of corrections, so much is used: less where they are hardly larger than those of exact poses would be (the
  /// positive part of James and Stein's estimator, 1961).
  double share() const;

  /// Uncertainty of the gauge: how far all refined poses together may be off, px.
  double gauge_px() const;

 private:
  static constexpr int kPlain = 3;  // no correction, the newest one, the mean one; then the models
  static constexpr int kCandidates = kPlain + static_cast<int>(CorrectionFilterOptions::kModels);
  using Candidates = Eigen::Matrix<double, 6, kCandidates>;  // a correction each
  using Products = Eigen::Matrix<double, kCandidates, kCandidates>;
  using Errors = Eigen::Matrix<double, kCandidates, 1>;
  struct Track;
  struct Past {
    Products products = Products::Zero();  // sum of the candidates' errors times each other, px^2
    double weight = 0;
  };
  struct Entry {
    RobotTime time;
    Pose given;
    std::optional<Pose> refined = {};
    std::optional<Pose> found = {};            // refined, before its share was given up
    std::map<int, Candidates> predicted = {};  // by lag: images since the newest refined one
  };

  void compare_roughness(std::size_t at, const Matrix6d& px_metric);
  std::size_t index_of(RobotTime time) const;
  std::optional<std::size_t> newest_refined(std::size_t before) const;
  Track track(std::size_t at, std::size_t newest) const;
  std::pair<Candidates, Errors> candidates(std::size_t at, std::size_t newest) const;
  static Errors best_weights(const Products& products);

  CorrectionFilterOptions options_;
  std::deque<Entry> entries_;
  std::map<int, Past> past_;  // by lag
  Vector6d mean_correction_ = Vector6d::Zero();
  Matrix6d px_metric_ = Matrix6d::Zero();  // of the last image
  double mean_square_px_ = 0, mean_weight_ = 0;
  double refined_ = 0;
  double roughness_given_ = 0, roughness_found_ = 0;  // sums, px^2
  bool trusted_ = true;
};

}  // namespace foresight
