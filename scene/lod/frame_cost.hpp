// How long a frame will take, learnt from those that were drawn.
//
//   time = c0 + c1 triangles + c2 nodes
//
// Pixels do not tell frames apart: each is drawn once and their count stays. The c explain the newest frames best,
// those before less and less. What these frames do not tell, as they were all alike, stays as the first guess has it,
// times what all of it has turned out to take: a machine may be a hundred times as fast. Beside the mean it learns how
// far frames were off, so that a budget can be kept in most of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace foresight {

struct FrameWork {
  double triangles = 0, nodes = 0;
};

struct FrameCostOptions {
  double base_ms = 5, ms_per_million = 80, ms_per_node = 0.01;  ///< the first guess: a software renderer's
  double forgetting = 0.95;                                     ///< weight of a frame when the next one comes
  double sigmas = 2.1;  ///< spreads that margin() holds: 98 % of frames, one-sided
};

/// One thread.
class FrameCost {
 public:
  explicit FrameCost(const FrameCostOptions& options = {});

  /// What was learnt so far, ms.
  double base_ms() const { return c_[0]; }
  double ms_per_triangle() const { return c_[1] * 1e-6; }
  double ms_per_node() const { return c_[2] * 1e-2; }
  /// ms, without margin.
  double expected(const FrameWork& work) const;
  /// ms by which a frame may take longer than expected, in most cases.
  double margin() const;
  /// A frame took so long; nothing is learnt from numbers that are none, or below zero.
  void took(const FrameWork& work, double ms);

 private:
  static Eigen::Vector3d features(const FrameWork& work);
  void solve();

  FrameCostOptions options_;
  Eigen::Vector3d guess_, c_;
  Eigen::Matrix3d S_ = Eigen::Matrix3d::Zero();  // weighted sums over frames: of features by features,
  Eigen::Vector3d r_ = Eigen::Vector3d::Zero();  // of features by times
  double taken_ = 0, guessed_ = 0;               // of times, and of what the guess says of them
  double spread_ = 0;                            // mean of squared errors, ms2
  std::size_t frames_ = 0;
};

}  // namespace foresight
