#include "calibration/registration/tag_correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include "calibration/registration/projection_slope.hpp"

namespace foresight {
namespace {

constexpr double kHuber = 2;         // sigmas
constexpr double kConverged = 1e-7;  // rad and m

/// Pixel and its slope by the correction's twist.
struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 6> slope;
};

/// `p_left`: corner in the corrected left camera's frame.
std::optional<Projection> project(const Lens& lens, const Pose& T_camera_left, const Eigen::Vector3d& p_left) {
  const Eigen::Vector3d p = T_camera_left * p_left;
  const auto pixel = lens.project(p);
  if (!pixel) return std::nullopt;
  const auto slope = projection_slope(lens, p);
  if (!slope) return std::nullopt;
  Eigen::Matrix<double, 3, 6> moved;  // of p_left, when the left camera moves
  moved << 0, -p_left.z(), p_left.y(), -1, 0, 0, p_left.z(), 0, -p_left.x(), 0, -1, 0, -p_left.y(), p_left.x(), 0, 0, 0,
      -1;
  return Projection{*pixel, *slope * T_camera_left.linear() * moved};
}

}  // namespace

/// One solution over the window.
struct TagCorrection::Problem {
  const TagCorrection& of;
  RobotTime now;
  Pose D = Pose::Identity();
  std::vector<const Observation*> left_out{};
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double square_px = 0;
  int tags = 0;

  double variance(const Image& image) const {
    const double age = std::max(0.0, to_seconds(now - image.time));
    return std::pow(of.options_.corner_px, 2) + std::pow(of.options_.drift_px_per_s, 2) * age;
  }

  /// Chi-square of one tag; its normal equations are added where asked for. Infinite where the lens
  /// does not see it.
  double add(const Image& image, const Observation& seen, bool to_equations) {
    const Pose T_left_world = (image.T_world_left * D).inverse();
    const Lens& lens = seen.right ? of.lenses_.right : of.lenses_.left;
    const Pose T_camera_left = seen.right ? of.lenses_.T_left_right.inverse() : Pose::Identity();
    const double var = variance(image);
    double chi2 = 0;
    Matrix6d h = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (std::size_t c = 0; c < 4; ++c) {
      const auto at = project(lens, T_camera_left, T_left_world * (*seen.corners)[c]);
      if (!at) return std::numeric_limits<double>::infinity();
      const Eigen::Vector2d r = at->pixel - seen.pixels[c];
      const double size = r.norm() / std::sqrt(var);
      const double w = (size > kHuber ? kHuber / size : 1) / var;
      chi2 += size * size;
      h.noalias() += w * at->slope.transpose() * at->slope;
      b.noalias() += w * at->slope.transpose() * r;
    }
    if (to_equations) {
      H += h;
      g += b;
      square_px += chi2 * var / 4;
      ++tags;
    }
    return chi2;
  }

  bool is_left_out(const Observation& seen) const {
    return std::find(left_out.begin(), left_out.end(), &seen) != left_out.end();
  }

  void minimise() {
    const Vector6d information = of.options_.prior_sigma.array().square().inverse();
    for (int i = 0; i < of.options_.iterations; ++i) {
      H = information.asDiagonal();
      g = information.asDiagonal() * to_twist(D);
      square_px = tags = 0;
      for (const Image& image : of.images_)
        for (const Observation& seen : image.observations)
          if (!is_left_out(seen)) add(image, seen, true);
      const Vector6d step = -H.ldlt().solve(g);
      D = D * to_motion(step);
      if (step.norm() < kConverged) break;
    }
  }

  /// Leaves out the tags that the solution does not explain; true where there was a new one.
  bool gate() {
    bool any = false;
    for (const Image& image : of.images_)
      for (const Observation& seen : image.observations) {
        if (is_left_out(seen) || add(image, seen, false) <= of.options_.gate) continue;
        left_out.push_back(&seen);
        any = true;
      }
    return any;
  }
};

TagCorrection::TagCorrection(const StereoLenses& lenses, const TagMap& map, const TagCorrectionOptions& options)
    : lenses_(lenses), map_(map), options_(options) {}

void TagCorrection::add(RobotTime time, const Pose& T_world_left, const std::vector<DetectedTag>& left,
                        const std::vector<DetectedTag>& right) {
  Image image{time, T_world_left, {}};
  const auto take = [&](const std::vector<DetectedTag>& tags, bool is_right) {
    for (const DetectedTag& tag : tags)
      if (const auto known = map_.find(tag.id); known != map_.end())
        image.observations.push_back({&known->second, tag.corners, is_right});
  };
  take(left, false);
  take(right, true);
  if (!image.observations.empty()) images_.push_back(std::move(image));
  while (!images_.empty() &&
         (images_.size() > options_.most_images || to_seconds(time - images_.front().time) > options_.lag_s))
    images_.pop_front();
}

std::optional<RobotTime> TagCorrection::newest() const {
  return images_.empty() ? std::nullopt : std::optional(images_.back().time);
}

TagCorrectionSummary TagCorrection::solve(RobotTime now) const {
  Problem problem{*this, now};
  problem.minimise();
  for (int round = 0; round < 3 && problem.gate(); ++round) problem.minimise();
  TagCorrectionSummary out;
  out.T_left_corrected = problem.D;
  out.covariance = problem.H.ldlt().solve(Matrix6d::Identity());
  out.tags = problem.tags;
  out.gated = static_cast<int>(problem.left_out.size());
  out.usable = problem.tags > 0;
  out.rms_px = out.usable ? std::sqrt(problem.square_px / problem.tags) : 0;
  return out;
}

}  // namespace foresight
