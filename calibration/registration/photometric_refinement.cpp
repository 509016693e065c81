#include "calibration/registration/photometric_refinement.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/camera/pose_solver.hpp"
#include "calibration/registration/view_points.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr double kHuber = 1.345;      // scales; 95 % as efficient as least squares for normal noise
constexpr double kBeyond = 5;         // scales; further out it is another surface, a shadow, a highlight
constexpr double kLeastScale = 0.5;   // 8-bit values: rounding
constexpr double kConverged = 0.003;  // px
constexpr std::size_t kFewestOfLevel = 12;
constexpr double kTiny = 0.3;  // px: below this the judging blocks' noise decides, so they may only not object

/// T_view_image; gain and bias of the image.
using Estimate = PoseEstimate<2>;

Estimate estimate(const Pose& T_view_image, double gain, double bias) {
  return {T_view_image, {gain, bias}};
}

/// One level of the problem.
struct Level {
  const Lens& lens;
  const cv::Mat& image;
  std::vector<ViewPoint> points;
  int level;

  /// I(D^-1 X) - gain * R - bias, or nothing outside the image.
  std::optional<double> residual(const ViewPoint& point, const Estimate& at, const Pose& T_image_view) const {
    const auto pixel = lens.project(T_image_view * point.p_view);
    if (!pixel) return std::nullopt;
    const auto value = sample(image, to_level(*pixel, level));
    if (!value) return std::nullopt;
    return *value - at.extra[0] * point.value - at.extra[1];
  }
};

/// Of all points, NaN outside the image.
std::vector<double> residuals_of(const Level& level, const Estimate& at) {
  const Pose T_image_view = at.T.inverse();
  std::vector<double> out;
  out.reserve(level.points.size());
  for (const ViewPoint& point : level.points) out.push_back(level.residual(point, at, T_image_view).value_or(NAN));
  return out;
}

double scale_of(std::vector<double> residuals) {
  std::erase_if(residuals, [](double r) { return !std::isfinite(r); });
  return std::max(robust_sigma(std::move(residuals)), kLeastScale);
}

double weight_of(double r, double scale) {
  const double size = std::abs(r) / scale;
  return size > kBeyond ? 0 : size > kHuber ? kHuber / size : 1;
}

double loss(double r, double scale) {
  const double size = std::min(std::abs(r) / scale, kBeyond);
  return size > kHuber ? kHuber * (size - kHuber / 2) : size * size / 2;
}

/// Gain and bias from medians of the values where the pose cannot be trusted yet.
void start_exposure(const Level& level, Estimate& at) {
  const std::vector<double> all = residuals_of(level, estimate(at.T, 0, 0));
  std::vector<double> seen, drawn;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (std::isfinite(all[i])) seen.push_back(all[i]), drawn.push_back(level.points[i].value);
  const double a = median(seen), b = median(drawn);
  for (double& x : seen) x = std::abs(x - a);
  for (double& x : drawn) x = std::abs(x - b);
  const double spread = median(std::move(drawn));
  const double gain = spread > 1 ? std::clamp(median(std::move(seen)) / spread, 0.4, 2.5) : 1;
  at.extra = {gain, a - gain * b};
}

/// One level, as the solver asks for it. Each time it asks for derivatives, the scale is found anew; the costs that it
/// compares with one another are of one scale.
struct LevelProblem {
  const Level& level;
  double scale = 1;
  std::size_t count = 0;                // points with a weight
  std::map<int, Vector8d>* by_block{};  // g of each block, where wanted

  bool operator()(const Estimate& at, bool derivatives, PoseEquations<2>& sum) {
    const std::vector<double> residuals = residuals_of(level, at);
    if (derivatives) scale = scale_of(residuals), count = 0;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const ViewPoint& point = level.points[i];
      const double r = residuals[i];
      if (judges(point.block)) continue;
      sum.cost += std::isfinite(r) ? loss(r, scale) : loss(kBeyond * scale, scale);
      const double w = std::isfinite(r) ? weight_of(r, scale) / (scale * scale) : 0;
      if (!derivatives || w == 0) continue;
      Vector8d j;
      j << at.extra[0] * point.slope.transpose(), -point.value, -1;
      sum.H.noalias() += w * j * j.transpose();
      const Vector8d g = w * r * j;
      sum.g += g;
      if (by_block) by_block->try_emplace(point.block, Vector8d::Zero()).first->second += g;
      ++count;
    }
    return !derivatives || count >= kFewestOfLevel;
  }
};

Matrix6d px_metric_of(const std::vector<ViewPoint>& points) {
  Matrix6d metric = Matrix6d::Zero();
  for (const ViewPoint& point : points) metric.noalias() += point.displacement.transpose() * point.displacement;
  return points.empty() ? metric : Matrix6d(metric / static_cast<double>(points.size()));
}

double size_px(const Matrix6d& metric, const Vector6d& twist) {
  return std::sqrt(std::max(0.0, twist.dot(metric * twist)));
}

void refine(const Level& level, const RefinementOptions& options, const Matrix6d& metric, Estimate& at) {
  PoseSolverOptions<2> solver;
  solver.prior.topLeftCorner<6, 6>() = options.prior_information;
  solver.most_iterations = options.iterations;
  solver.step_metric = metric / (kConverged * kConverged);
  at = solve_pose<2>(at, LevelProblem{level}, solver).at;
}

/// Mean loss on the judging blocks, with gain and bias as they are.
double judge(const Level& level, const Estimate& at, double scale) {
  const Pose T_image_view = at.T.inverse();
  double sum = 0;
  std::size_t count = 0;
  for (const ViewPoint& point : level.points) {
    if (!judges(point.block)) continue;
    const auto r = level.residual(point, at, T_image_view);
    sum += r ? loss(*r, scale) : loss(kBeyond * scale, scale);  // what leaves the image does not help
    ++count;
  }
  return count ? sum / static_cast<double>(count) : 0;
}

/// The residuals of neighbouring pixels are alike: blocks, not pixels, are the independent draws.
Matrix6d covariance_of(const Level& level, const Estimate& at, const RefinementOptions& options) {
  std::map<int, Vector8d> by_block;
  PoseEquations<2> n;
  LevelProblem{level, 1, 0, &by_block}(at, true, n);
  n.H.topLeftCorner<6, 6>() += options.prior_information;
  Matrix8d middle = Matrix8d::Zero();
  for (const auto& [block, g] : by_block) middle += g * g.transpose();
  middle.topLeftCorner<6, 6>() += options.prior_information;
  // Scaled to a unit diagonal: metres, radians and grey values have nothing to do with each other.
  const Vector8d s = n.H.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  const Matrix8d unit = s.asDiagonal() * n.H * s.asDiagonal() + 1e-9 * Matrix8d::Identity();
  const Matrix8d inverse = s.asDiagonal() * unit.inverse() * s.asDiagonal();
  return (inverse * middle * inverse).topLeftCorner<6, 6>();
}

std::string objection(const RefinementSummary& s, const RefinementOptions& options) {
  if (s.points < options.fewest_points) return "too few textured pixels";
  if (!(s.moved_px <= options.largest_px)) return "the correction is larger than the gate";
  if (!(s.gain > 0.3 && s.gain < 3)) return "brightness does not fit";
  const double least = s.moved_px < kTiny ? -0.01 : options.least_gain;
  if (!(s.error_after <= (1 - least) * s.error_before)) return "the pixels left out do not agree";
  return {};
}

void require_sizes(const Lens& lens, const RenderedView& view, const cv::Mat& image) {
  const cv::Size size(lens.width(), lens.height());
  if (view.colour.size() != size || view.colour.type() != CV_8UC4 || view.range.size() != size ||
      view.range.type() != CV_32FC1 || image.size() != size || image.depth() != CV_8U)
    throw std::invalid_argument("refine_pose: view, range and image must have the lens's size and the stated types");
}

}  // namespace

RefinementSummary refine_pose(const Lens& lens, const RenderedView& view, const cv::Mat& image,
                              const RefinementOptions& options) {
  require_sizes(lens, view, image);
  const int levels = options.coarsest_level + 1;
  const auto views = grey_pyramid(view.colour, levels), images = grey_pyramid(image, levels);
  const cv::Mat evidence = evidence_mask(view, options);
  RefinementSummary out;
  out.T_world_camera = view.T_world_camera;
  out.covariance = Matrix6d::Zero();
  Estimate at = estimate(Pose::Identity(), 1, 0), before = at;
  for (int l = options.coarsest_level; l >= 0; --l) {
    const auto k = static_cast<std::size_t>(l);
    cv::Mat mask;
    const int reach = (1 << l) / 2;  // what the level's pixels add to the margin
    cv::erode(evidence, mask, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
    const Level level{lens, images[k], find_view_points(lens, view, views[k], mask, l, options), l};
    if (l == options.coarsest_level) start_exposure(level, at);
    out.px_metric = px_metric_of(level.points);
    refine(level, options, out.px_metric, at);
    if (l > 0) continue;
    out.points = level.points.size();
    const double scale = scale_of(residuals_of(level, at));
    start_exposure(level, before);
    out.error_before = std::min(judge(level, before, scale), judge(level, {Pose::Identity(), at.extra}, scale));
    out.error_after = judge(level, at, scale);
    out.covariance = covariance_of(level, at, options);
  }
  out.moved_px = size_px(out.px_metric, to_twist(at.T));
  out.sigma_px = std::sqrt(std::max(0.0, (out.px_metric * out.covariance).trace()));
  out.gain = at.extra[0], out.bias = at.extra[1];
  out.reason = objection(out, options);
  out.accepted = out.reason.empty();
  if (out.accepted) out.T_world_camera = view.T_world_camera * at.T;
  return out;
}

}  // namespace foresight
