#include "calibration/robot/time_covariance.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

namespace foresight {
namespace {

// A stretch's share of the normal equations, and its gradient.
struct Stretch {
  Eigen::MatrixXd H;
  Eigen::VectorXd gradient;
};

std::vector<Stretch> cut(const ceres::CRSMatrix& J, const std::vector<double>& r, const std::vector<double>& time_s,
                         double segment_s) {
  std::map<long, Stretch> by_time;
  Eigen::VectorXd j(J.num_cols);
  for (std::size_t row = 0; row < r.size(); ++row) {
    j.setZero();
    for (int k = J.rows[row]; k < J.rows[row + 1]; ++k)
      j[J.cols[static_cast<std::size_t>(k)]] = J.values[static_cast<std::size_t>(k)];
    const long at = std::lround(std::floor((time_s[row] - time_s.front()) / segment_s));
    const auto [place, first] = by_time.try_emplace(at);
    Stretch& stretch = place->second;
    if (first) stretch = {Eigen::MatrixXd::Zero(J.num_cols, J.num_cols), Eigen::VectorXd::Zero(J.num_cols)};
    stretch.H += j * j.transpose();
    stretch.gradient += j * r[row];
  }
  std::vector<Stretch> out;
  for (auto& [at, stretch] : by_time) out.push_back(std::move(stretch));
  return out;
}

Eigen::MatrixXd left_out(const std::vector<Stretch>& stretches) {
  const Eigen::Index n = stretches.front().gradient.size();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  for (const Stretch& stretch : stretches) H += stretch.H;
  const double least = 1e-12 * H.diagonal().maxCoeff();  // holds what no residual sees
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (const Stretch& stretch : stretches) {
    Eigen::MatrixXd others = H - stretch.H;
    others.diagonal().array() += least;
    const Eigen::VectorXd moved = others.ldlt().solve(stretch.gradient);
    out += moved * moved.transpose();
  }
  const auto count = static_cast<double>(stretches.size());
  return out * ((count - 1) / count);
}

}  // namespace

StretchCovariance stretch_covariance(const ceres::CRSMatrix& J, const std::vector<double>& r,
                                     const std::vector<double>& time_s, double segment_s) {
  std::vector<Stretch> stretches = cut(J, r, time_s, segment_s);
  const auto count = static_cast<int>(stretches.size());
  const double span = time_s.back() - time_s.front();
  if (count < kFewestStretches) stretches = cut(J, r, time_s, span * (1 + 1e-9) / kFewestStretches);
  return {left_out(stretches), count};
}

}  // namespace foresight
