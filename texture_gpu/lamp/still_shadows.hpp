// Shadows as single images have them: points of a surface, each beside those around it in the same image.
//
// What lies across the border of a shadow is darker than what lies beside it. Print and grain are so too, but not all
// along the shadows that a lamp at some place would throw; so that one image may tell where the lamp is. What lies in a
// corner is darker whatever the lamp: as much as it sees less of its surroundings is left out.
#pragma once

#include <Eigen/SparseCore>
#include <deque>
#include <span>
#include <vector>

#include "texture_gpu/lamp/lamp_record.hpp"
#include "texture_gpu/lamp/round_lamp.hpp"

namespace foresight {

class StillShadows {
 public:
  /// At most `most` points, of the images that show many which those before do not. `rays` must outlive this.
  StillShadows(const ShadowRays& rays, std::span<const Witness> witnesses, const std::deque<LampRecord>& records,
               std::size_t most);

  bool empty() const { return brighter_.empty(); }

  /// Of each point that has enough others around: how much brighter it is than these (logarithms), and how much more of
  /// a lamp is hidden from it; of both, what goes with the surroundings that they see is left out.
  const Eigen::VectorXd& brighter() const { return luma_; }
  Eigen::VectorXd more_hidden(const Eigen::Vector3d& lamp, double radius, const Disc& disc) const;

  /// What a lamp there hides of itself, of each point that was seen.
  struct Cast {
    Eigen::VectorXd facing, hidden;     ///< (n . l) / d^2; 0 .. 1
    std::vector<Eigen::Index> borders;  ///< of the points, those of which more or less is hidden than around
  };
  Cast cast(const Eigen::Vector3d& lamp, double radius, const Disc& disc) const;
  /// For red, green and blue: sums over the borders of by how much, in logarithms, they are not as bright beside what
  /// is around as a lamp makes them that gives `strength * facing` times the light of all else, which comes from all
  /// around.
  Eigen::Array3d errors(const Cast& cast, double strength) const;

 private:
  struct Point {
    Witness witness;
    std::size_t image;
    Eigen::Vector3f value;  // logarithms
  };
  void add(const ShadowRays& rays, std::span<const Witness> witnesses, const LampRecord& record, std::size_t most);
  void compare_with_around(std::size_t first, float near);
  Eigen::VectorXd hidden(const Eigen::Vector3d& lamp, double radius, const Disc& disc) const;
  Eigen::VectorXd hidden_from_point(const Eigen::Vector3d& lamp) const;
  double open(const Point& point, double reach) const;
  void leave_out_corners();

  std::vector<ShadowRays::Posed> images_;  // all that throws shadows in them
  std::vector<Point> points_;              // neighbours follow each other
  std::vector<double> open_;               // of each point: share of what it sees that is not near
  // Of values of all points, a row for each that has enough around: how much more it has than the mean of these.
  Eigen::SparseMatrix<double, Eigen::RowMajor> more_than_around_;
  std::vector<Eigen::Triplet<double>> entries_;  // of it, as long as it grows
  std::vector<Eigen::Vector3f> brighter_;        // of each row, logarithms
  // Of each row: how much more open than around, logarithm, as a unit vector; luma, what goes with that left out.
  Eigen::VectorXd more_open_, luma_;
};

}  // namespace foresight
