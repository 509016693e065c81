#include "calibration/registration/tag_correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/camera/pose_solver.hpp"
#include "calibration/registration/projection_slope.hpp"

namespace foresight {
namespace {

constexpr double kTagHuber = 2;          // sigmas
constexpr double kStepConverged = 1e-7;  // rad and m

/// Slope of the pixel by the correction's twist. `p_left`: corner in the corrected left camera's frame.
std::optional<Eigen::Matrix<double, 2, 6>> slope_of(const Lens& lens, const Pose& T_camera_left,
                                                    const Eigen::Vector3d& p_left) {
  const auto slope = projection_slope(lens, T_camera_left * p_left);
  if (!slope) return std::nullopt;
  Eigen::Matrix<double, 3, 6> moved;  // of p_left, when the left camera moves
  moved << 0, -p_left.z(), p_left.y(), -1, 0, 0, p_left.z(), 0, -p_left.x(), 0, -1, 0, -p_left.y(), p_left.x(), 0, 0, 0,
      -1;
  return *slope * T_camera_left.linear() * moved;
}

}  // namespace

/// One solution over the window.
struct TagCorrection::Problem {
  const TagCorrection& of;
  RobotTime now;
  Pose D = Pose::Identity();
  Matrix6d information = Matrix6d::Zero();  // of D
  std::vector<const Observation*> left_out{};

  double variance(const Image& image) const {
    const double age = std::max(0.0, to_seconds(now - image.time));
    return std::pow(of.options_.corner_px, 2) + std::pow(of.options_.drift_px_per_s, 2) * age;
  }

  /// Chi-square of one tag, infinite where the lens does not see it. Loss and, where `derivatives`, normal equations of
  /// its corners are added to `sum`.
  double add(const Image& image, const Observation& seen, const Pose& T_left_world, bool derivatives,
             PoseEquations<0>& sum) const {
    const Lens& lens = seen.right ? of.lenses_.right : of.lenses_.left;
    const Pose T_camera_left = seen.right ? of.T_right_left_ : Pose::Identity();
    const double var = variance(image), sigma = std::sqrt(var);
    double chi2 = 0;
    PoseEquations<0> tag;
    for (std::size_t c = 0; c < 4; ++c) {
      const Eigen::Vector3d p_left = T_left_world * (*seen.corners)[c];
      const auto pixel = lens.project(T_camera_left * p_left);
      const auto slope = pixel && derivatives ? slope_of(lens, T_camera_left, p_left) : std::nullopt;
      if (!pixel || (derivatives && !slope)) {
        sum.cost += of.options_.gate / 2;  // no step is for the better because it loses a tag
        return std::numeric_limits<double>::infinity();
      }
      const Eigen::Vector2d r = *pixel - seen.pixels[c];
      const double size = r.norm() / sigma;
      chi2 += size * size;
      tag.cost += size > kTagHuber ? kTagHuber * (size - kTagHuber / 2) : size * size / 2;
      if (!derivatives) continue;
      const double w = (size > kTagHuber ? kTagHuber / size : 1) / var;
      tag.H.noalias() += w * slope->transpose() * *slope;
      tag.g.noalias() += w * slope->transpose() * r;
    }
    sum.H += tag.H, sum.g += tag.g, sum.cost += tag.cost;
    return chi2;
  }

  bool is_left_out(const Observation& seen) const {
    return std::find(left_out.begin(), left_out.end(), &seen) != left_out.end();
  }

  void minimise() {
    PoseSolverOptions<0> options;
    options.prior = Vector6d(of.options_.prior_sigma.array().square().inverse()).asDiagonal();
    options.most_iterations = of.options_.iterations;
    options.step_metric = Matrix6d::Identity() / (kStepConverged * kStepConverged);
    const auto problem = [this](const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) {
      for (const Image& image : of.images_) {
        const Pose T_left_world = (image.T_world_left * at.T).inverse();
        for (const Observation& seen : image.observations)
          if (!is_left_out(seen)) add(image, seen, T_left_world, derivatives, sum);
      }
      return true;
    };
    const PoseSolution<0> found = solve_pose<0>({D, {}}, problem, options);
    D = found.at.T;
    information = found.equations.H;
  }

  /// Calls `use` with each tag that counts, its image and its chi-square.
  template <typename Use>
  void judge(Use use) const {
    for (const Image& image : of.images_) {
      const Pose T_left_world = (image.T_world_left * D).inverse();
      for (const Observation& seen : image.observations) {
        PoseEquations<0> unused;
        if (!is_left_out(seen)) use(seen, image, add(image, seen, T_left_world, false, unused));
      }
    }
  }

  /// Leaves out the tags that the solution does not explain; true where there was a new one.
  bool gate() {
    const std::size_t before = left_out.size();
    judge([this](const Observation& seen, const Image&, double chi2) {
      if (chi2 > of.options_.gate) left_out.push_back(&seen);
    });
    return left_out.size() > before;
  }
};

TagCorrection::TagCorrection(const StereoLenses& lenses, const TagMap& map, const TagCorrectionOptions& options)
    : lenses_(lenses), T_right_left_(lenses.T_left_right.inverse()), map_(map), options_(options) {}

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
  TagCorrectionSummary out;
  problem.minimise();
  for (int round = 0; round < 3 && problem.gate(); ++round) problem.minimise();
  double square_px = 0;
  problem.judge([&](const Observation&, const Image& image, double chi2) {
    if (!std::isfinite(chi2)) return;
    square_px += chi2 * problem.variance(image) / 4;
    ++out.tags;
  });
  out.T_left_corrected = problem.D;
  out.covariance = problem.information.ldlt().solve(Matrix6d::Identity());
  out.gated = static_cast<int>(problem.left_out.size());
  out.usable = out.tags > 0;
  out.rms_px = out.usable ? std::sqrt(square_px / out.tags) : 0;
  return out;
}

}  // namespace foresight
