#include "calibration/registration/photometric_refinement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/registration/view_points.hpp"

namespace foresight {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr double kHuber = 1.345;      // scales; 95 % as efficient as least squares for normal noise
constexpr double kBeyond = 5;         // scales; further out it is another surface, a shadow, a highlight
constexpr double kLeastScale = 0.5;   // 8-bit values: rounding
constexpr double kConverged = 0.003;  // px
constexpr double kTiny = 0.3;         // px: below this the judging blocks' noise decides, so they may only not object

/// What is being estimated.
struct Estimate {
  Pose T_view_image = Pose::Identity();
  double gain = 1, bias = 0;
};

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
    return *value - at.gain * point.value - at.bias;
  }
};

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double scale_of(const Level& level, const Estimate& at) {
  const Pose T_image_view = at.T_view_image.inverse();
  std::vector<double> sizes;
  for (const ViewPoint& point : level.points)
    if (const auto r = level.residual(point, at, T_image_view)) sizes.push_back(std::abs(*r));
  return std::max(1.4826 * median_of(std::move(sizes)), kLeastScale);
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
  const Pose T_image_view = at.T_view_image.inverse();
  std::vector<double> seen, drawn;
  for (const ViewPoint& point : level.points) {
    const auto r = level.residual(point, {at.T_view_image, 0, 0}, T_image_view);
    if (r) seen.push_back(*r), drawn.push_back(point.value);
  }
  const double a = median_of(seen), b = median_of(drawn);
  for (double& x : seen) x = std::abs(x - a);
  for (double& x : drawn) x = std::abs(x - b);
  const double spread = median_of(drawn);
  at.gain = spread > 1 ? std::clamp(median_of(seen) / spread, 0.4, 2.5) : 1;
  at.bias = a - at.gain * b;
}

struct NormalEquations {
  Matrix8d H = Matrix8d::Zero();
  Vector8d g = Vector8d::Zero();
  std::map<int, Vector8d> by_block;  // g of each block
  std::size_t count = 0;
};

NormalEquations normal_equations(const Level& level, const Estimate& at, double scale) {
  NormalEquations out;
  const Pose T_image_view = at.T_view_image.inverse();
  for (const ViewPoint& point : level.points) {
    if (judges(point.block)) continue;
    const auto r = level.residual(point, at, T_image_view);
    if (!r) continue;
    const double w = weight_of(*r, scale) / (scale * scale);
    if (w == 0) continue;
    Vector8d j;
    j << at.gain * point.slope.transpose(), -point.value, -1;
    out.H.noalias() += w * j * j.transpose();
    const Vector8d g = w * *r * j;
    out.g += g;
    out.by_block.try_emplace(point.block, Vector8d::Zero()).first->second += g;
    ++out.count;
  }
  return out;
}

/// Scaled to a unit diagonal: metres, radians and grey values have nothing to do with each other.
Vector8d solve(const Matrix8d& H, const Vector8d& g) {
  const Vector8d s = H.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  const Matrix8d unit = s.asDiagonal() * H * s.asDiagonal() + 1e-9 * Matrix8d::Identity();
  return s.asDiagonal() * unit.ldlt().solve(s.asDiagonal() * g);
}

Matrix6d px_metric_of(const std::vector<ViewPoint>& points) {
  Matrix6d metric = Matrix6d::Zero();
  for (const ViewPoint& point : points) metric.noalias() += point.displacement.transpose() * point.displacement;
  return points.empty() ? metric : Matrix6d(metric / static_cast<double>(points.size()));
}

double size_px(const Matrix6d& metric, const Vector6d& twist) {
  return std::sqrt(std::max(0.0, twist.dot(metric * twist)));
}

void iterate(const Level& level, const RefinementOptions& options, const Matrix6d& metric, Estimate& at) {
  for (int i = 0; i < options.iterations; ++i) {
    NormalEquations n = normal_equations(level, at, scale_of(level, at));
    if (n.count < 12) return;
    n.H.topLeftCorner<6, 6>() += options.prior_information;
    n.g.head<6>() += options.prior_information * to_twist(at.T_view_image);
    const Vector8d step = -solve(n.H, n.g);
    const Vector6d twist = step.head<6>();
    at.T_view_image = at.T_view_image * to_motion(twist);
    at.gain += step[6];
    at.bias += step[7];
    if (size_px(metric, twist) < kConverged) return;
  }
}

/// Mean loss on the judging blocks, with gain and bias as they are.
double judge(const Level& level, const Estimate& at, double scale) {
  const Pose T_image_view = at.T_view_image.inverse();
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
Matrix6d covariance_of(const Level& level, const Estimate& at, double scale, const RefinementOptions& options) {
  NormalEquations n = normal_equations(level, at, scale);
  n.H.topLeftCorner<6, 6>() += options.prior_information;
  Matrix8d middle = Matrix8d::Zero();
  for (const auto& [block, g] : n.by_block) middle += g * g.transpose();
  middle.topLeftCorner<6, 6>() += options.prior_information;
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
  Estimate at, before;
  for (int l = options.coarsest_level; l >= 0; --l) {
    const auto k = static_cast<std::size_t>(l);
    cv::Mat mask;
    const int reach = (1 << l) / 2;  // what the level's pixels add to the margin
    cv::erode(evidence, mask, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
    const Level level{lens, images[k], find_view_points(lens, view, views[k], mask, l, options), l};
    if (l == options.coarsest_level) start_exposure(level, at);
    out.px_metric = px_metric_of(level.points);
    iterate(level, options, out.px_metric, at);
    if (l > 0) continue;
    out.points = level.points.size();
    const double scale = scale_of(level, at);
    start_exposure(level, before);
    out.error_before = std::min(judge(level, before, scale), judge(level, {Pose::Identity(), at.gain, at.bias}, scale));
    out.error_after = judge(level, at, scale);
    out.covariance = covariance_of(level, at, scale, options);
  }
  out.moved_px = size_px(out.px_metric, to_twist(at.T_view_image));
  out.sigma_px = std::sqrt(std::max(0.0, (out.px_metric * out.covariance).trace()));
  out.gain = at.gain;
  out.bias = at.bias;
  out.reason = objection(out, options);
  out.accepted = out.reason.empty();
  if (out.accepted) out.T_world_camera = view.T_world_camera * at.T_view_image;
  return out;
}

}  // namespace foresight
