#include "calibration/registration/correction_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <stdexcept>

namespace foresight {
namespace {

constexpr double kRidge = 0.02;  // of the mean diagonal, against weights that cancel each other

Vector6d correction(const Pose& given, const Pose& pose) {
  return to_twist(given.inverse() * pose);
}

}  // namespace

void CorrectionFilter::add_given(RobotTime time, const Pose& T_world_camera) {
  if (!entries_.empty() && time <= entries_.back().time)
    throw std::invalid_argument("CorrectionFilter: images must come in ascending order of time");
  entries_.push_back({time, T_world_camera});
}

std::size_t CorrectionFilter::index_of(RobotTime time) const {
  const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.time == time; });
  if (at == entries_.end()) throw std::invalid_argument("CorrectionFilter: no pose was given for this time");
  return static_cast<std::size_t>(at - entries_.begin());
}

std::optional<std::size_t> CorrectionFilter::newest_refined(std::size_t before) const {
  for (std::size_t i = before; i-- > 0;)
    if (entries_[i].refined) return i;
  return std::nullopt;
}

Pose CorrectionFilter::add_refined(RobotTime time, const Pose& T_world_camera, const Matrix6d& px_metric) {
  const std::size_t at = index_of(time);
  Entry& entry = entries_[at];
  const Vector6d found = correction(entry.given, T_world_camera);
  for (const auto& [lag, candidates] : entry.predicted) {
    const Candidates errors = candidates.colwise() - found;
    auto sum = products_.try_emplace(lag, prior()).first;
    sum->second = options_.forgetting * sum->second + errors.transpose() * px_metric * errors;
    double& weight = weights_.try_emplace(lag, options_.prior_images).first->second;
    weight = options_.forgetting * weight + 1;
  }
  mean_square_px_ = options_.forgetting * mean_square_px_ + found.dot(px_metric * found);
  mean_weight_ = options_.forgetting * mean_weight_ + 1;
  ++refined_;
  mean_correction_ += std::max(options_.mean_share, 1.0 / refined_) * (found - mean_correction_);
  entry.found = T_world_camera;
  compare_roughness(at, px_metric);
  const Vector6d kept = helps() ? Vector6d(found - options_.to_given * mean_correction_) : Vector6d::Zero();
  entry.refined = entry.given * to_motion(kept);
  const Pose out = *entry.refined;
  for (std::size_t i = at; i > options_.memory; --i) entries_.pop_front();
  return out;
}

/// Third differences of the last four poses, both ways.
void CorrectionFilter::compare_roughness(std::size_t at, const Matrix6d& px_metric) {
  if (at < 3) return;
  std::array<Vector6d, 3> given, found;
  for (std::size_t i = 0; i < 3; ++i) {
    const Entry &a = entries_[at - 3 + i], &b = entries_[at - 2 + i];
    if (!a.found || !b.found) return;
    given[i] = correction(a.given, b.given);
    found[i] = correction(*a.found, *b.found);
  }
  const auto size = [&](const std::array<Vector6d, 3>& motion) {
    const Vector6d third = motion[2] - 2 * motion[1] + motion[0];
    return third.dot(px_metric * third);
  };
  roughness_given_ = options_.forgetting * roughness_given_ + size(given);
  roughness_found_ = options_.forgetting * roughness_found_ + size(found);
}

CorrectionFilter::Products CorrectionFilter::prior() const {
  Products out = Products::Zero();
  out.diagonal().setConstant(options_.other_px * options_.other_px);
  out(0, 0) = options_.given_px * options_.given_px;
  return options_.prior_images * out;
}

/// A polynomial in time through the last `images` refined poses and the given ones since, at `at`.
Vector6d CorrectionFilter::smooth_motion(std::size_t at, std::size_t newest, int degree, std::size_t images,
                                         double given_weight) const {
  const Entry& origin = entries_[newest];
  const std::size_t first = newest + 1 > images ? newest + 1 - images : 0;
  const auto rows = static_cast<Eigen::Index>(at - first + 1);
  Eigen::MatrixXd A(rows, degree + 1), b(rows, 6);
  for (std::size_t i = first; i <= at; ++i) {
    const Entry& e = entries_[i];
    const auto row = static_cast<Eigen::Index>(i - first);
    const double weight = e.refined && i <= newest ? 1 : given_weight;
    const double t = to_seconds(e.time - origin.time) / std::max(1e-9, to_seconds(entries_[at].time - origin.time));
    const Pose& pose = e.refined && i <= newest ? *e.refined : e.given;
    b.row(row) = weight * correction(*origin.refined, pose).transpose();
    for (int power = 0; power <= degree; ++power) A(row, power) = weight * std::pow(t, power);
  }
  if (rows < degree + 1) return Vector6d::Zero();
  const Eigen::MatrixXd x = A.completeOrthogonalDecomposition().solve(b);
  const Vector6d motion = x.colwise().sum().transpose();  // at t = 1
  return correction(entries_[at].given, *origin.refined * to_motion(motion));
}

CorrectionFilter::Candidates CorrectionFilter::candidates(std::size_t at, std::size_t newest) const {
  Candidates out;
  out << Vector6d::Zero(), correction(entries_[newest].given, *entries_[newest].refined), mean_correction_,
      smooth_motion(at, newest, 1, 3, 0.2), smooth_motion(at, newest, 2, 4, 0.1), smooth_motion(at, newest, 2, 4, 0.25),
      smooth_motion(at, newest, 3, 6, 0.2);
  return out;
}

CorrectionFilter::Prediction CorrectionFilter::predict(RobotTime time) {
  const std::size_t at = index_of(time);
  Entry& entry = entries_[at];
  const auto newest = newest_refined(at);
  if (!newest || !helps()) return {entry.given, options_.given_px};
  const int lag = static_cast<int>(at - *newest);
  const Candidates all = entry.predicted[lag] = candidates(at, *newest);
  const auto sum = products_.find(lag);
  Products products = sum == products_.end() ? prior() : sum->second;
  products /= sum == products_.end() ? options_.prior_images : weights_.at(lag);
  Products firm = products;
  firm.diagonal().array() += kRidge * products.diagonal().minCoeff();
  Eigen::Matrix<double, kCandidates, 1> weights = firm.ldlt().solve(Eigen::Matrix<double, kCandidates, 1>::Ones());
  weights /= weights.sum();
  return {entry.given * to_motion(all * weights), std::sqrt(std::max(0.0, weights.dot(products * weights)))};
}

double CorrectionFilter::gauge_px() const {
  if (mean_weight_ == 0) return options_.given_px;
  const double k = options_.to_given;
  return std::sqrt(mean_square_px_ / mean_weight_ * k / (2 - k));
}

}  // namespace foresight
