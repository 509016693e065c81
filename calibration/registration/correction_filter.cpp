#include "calibration/registration/correction_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace foresight {
namespace {

constexpr std::size_t kPast = 8;    // refined poses that a prediction looks at
constexpr std::size_t kSince = 24;  // given poses since
constexpr double kRidge = 0.02;     // of the mean diagonal, against weights that cancel each other

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
  px_metric_ = px_metric;
  mean_square_px_ = options_.forgetting * mean_square_px_ + found.dot(px_metric * found);
  mean_weight_ = options_.forgetting * mean_weight_ + 1;
  ++refined_;
  mean_correction_ += std::max(options_.mean_share, 1.0 / refined_) * (found - mean_correction_);
  entry.found = T_world_camera;
  compare_roughness(at, px_metric);
  const Vector6d kept = share() * (found - options_.to_given * mean_correction_);
  for (const auto& [lag, candidates] : entry.predicted) {
    const Candidates errors = candidates.colwise() - (helps() ? kept : found);
    Past& past = past_.at(lag);
    past.products = options_.forgetting * past.products + errors.transpose() * px_metric * errors;
    past.weight = options_.forgetting * past.weight + 1;
  }
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
  const double factor = trusted_ ? options_.rougher : options_.smoother;
  trusted_ = roughness_found_ <= factor * factor * roughness_given_;
}

/// What is known of the camera around the entry `at`, seen from the newest refined pose.
struct CorrectionFilter::Track {
  Pose origin;
  Eigen::VectorXd refined_t, given_t;                       // seconds since the newest refined pose
  Eigen::Matrix<double, 6, Eigen::Dynamic> refined, given;  // motions since then
  double wanted = 0;
  Eigen::Index given_since = 0;  // how many of the given poses came later
};

CorrectionFilter::Track CorrectionFilter::track(std::size_t at, std::size_t newest) const {
  const Entry& origin = entries_[newest];
  std::vector<std::size_t> refined, given;
  for (std::size_t i = newest + 1; i-- > 0 && refined.size() < kPast;)
    if (entries_[i].refined) refined.push_back(i);
  for (std::size_t i = std::max(newest + 1, at + 1 > kSince ? at + 1 - kSince : 0); i <= at; ++i) given.push_back(i);
  Track out;
  out.origin = *origin.refined;
  out.given_since = static_cast<Eigen::Index>(given.size());
  given.insert(given.end(), refined.begin(), refined.end());
  const auto seconds_at = [&](std::size_t i) { return to_seconds(entries_[i].time - origin.time); };
  const auto n = static_cast<Eigen::Index>(refined.size()), m = static_cast<Eigen::Index>(given.size());
  out.refined_t.resize(n), out.refined.resize(6, n), out.given_t.resize(m), out.given.resize(6, m);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Entry& entry = entries_[refined[static_cast<std::size_t>(k)]];
    out.refined_t[k] = seconds_at(refined[static_cast<std::size_t>(k)]);
    out.refined.col(k) = correction(out.origin, *entry.refined);
  }
  for (Eigen::Index k = 0; k < m; ++k) {
    out.given_t[k] = seconds_at(given[static_cast<std::size_t>(k)]);
    out.given.col(k) = correction(out.origin, entries_[given[static_cast<std::size_t>(k)]].given);
  }
  out.wanted = seconds_at(at);
  return out;
}

/// Corrections of entry `at` that the candidates predict, and the errors that they expect of themselves.
std::pair<CorrectionFilter::Candidates, CorrectionFilter::Errors> CorrectionFilter::candidates(
    std::size_t at, std::size_t newest) const {
  const Pose& given = entries_[at].given;
  Candidates out;
  Errors expected;
  out.col(0).setZero();
  out.col(1) = correction(entries_[newest].given, *entries_[newest].refined);
  out.col(2) = share() * mean_correction_;
  expected.head<kPlain>() << options_.given_px, std::numbers::sqrt2 * options_.given_px, options_.given_px;
  const Track track = this->track(at, newest);
  for (int c = kPlain; c < kCandidates; ++c) {
    const MotionModel& model = options_.models[static_cast<std::size_t>(c - kPlain)];
    // Errors that do not persist: what was given for refined poses tells nothing.
    const Eigen::Index n = model.persist_s > 0 ? track.given_t.size() : track.given_since;
    const MotionWeights w = motion_weights(model, track.refined_t, track.given_t.head(n), track.wanted);
    const Vector6d motion = track.refined * w.refined + track.given.leftCols(n) * w.given;
    out.col(c) = correction(given, track.origin * to_motion(motion));
    // A correction beyond what given poses err by is the model's own error.
    const double beyond = out.col(c).dot(px_metric_ * out.col(c)) - options_.given_px * options_.given_px;
    expected[c] = std::sqrt(w.sigma_px * w.sigma_px + std::max(0.0, beyond));
  }
  return {out, expected};
}

/// Sums to one, none negative, least expected square.
CorrectionFilter::Errors CorrectionFilter::best_weights(const Products& products) {
  std::array<int, kCandidates> used;
  std::iota(used.begin(), used.end(), 0);
  for (int n = kCandidates;; --n) {
    const Eigen::Map<const Eigen::VectorXi> rows(used.data(), n);
    Eigen::MatrixXd part = products(rows, rows);
    part.diagonal().array() += kRidge * part.diagonal().minCoeff();
    Eigen::VectorXd weights = part.ldlt().solve(Eigen::VectorXd::Ones(n));
    weights /= weights.sum();
    Eigen::Index worst = 0;
    if (weights.minCoeff(&worst) >= 0) {
      Errors out = Errors::Zero();
      out(rows) = weights;
      return out;
    }
    std::rotate(used.begin() + worst, used.begin() + worst + 1, used.begin() + n);
  }
}

CorrectionFilter::Prediction CorrectionFilter::predict(RobotTime time) {
  const std::size_t at = index_of(time);
  Entry& entry = entries_[at];
  if (entry.refined) return {*entry.refined, gauge_px()};
  const auto newest = newest_refined(at);
  if (!newest) return {entry.given, options_.given_px};
  const int lag = static_cast<int>(at - *newest);
  const auto [all, expected] = candidates(at, *newest);
  entry.predicted[lag] = all;
  const Past& past = past_[lag];
  const double unknown = options_.prior_images / (1 + past.weight);
  const Products claimed = expected.array().square().matrix().asDiagonal();
  const Products products = (past.products + unknown * claimed) / (past.weight + unknown);
  if (!helps()) return {entry.given, std::sqrt(products(0, 0))};
  const Errors weights = best_weights(products);
  return {entry.given * to_motion(all * weights), std::sqrt(std::max(0.0, weights.dot(products * weights)))};
}

double CorrectionFilter::share() const {
  if (!helps()) return 0;
  const double weight = mean_weight_ + options_.prior_images;
  const double square = (mean_square_px_ + options_.prior_images * options_.given_px * options_.given_px) / weight;
  return std::max(0.0, 1 - options_.alignment_px * options_.alignment_px / square);
}

double CorrectionFilter::gauge_px() const {
  if (mean_weight_ == 0) return options_.given_px;
  const double k = options_.to_given;
  return std::sqrt(mean_square_px_ / mean_weight_ * k / (2 - k));
}

}  // namespace foresight
