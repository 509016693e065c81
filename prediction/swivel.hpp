// Three joints whose axes meet in one point while the arm swivels: for which swivel angles are they within their
// limits?
//
// With hand and shoulder where they are, the elbow of a seven-joint arm can still turn about the line from the shoulder
// to the wrist. All that shoulder and wrist do then is a rotation R(psi) whose entries have the form
//
//   k0 + kc cos(psi) + ks sin(psi)                                                            (1)
//
// (Shimizu, Kakuya, Yoon, Kitagaki, Kosuge: Analytical inverse kinematic computation for 7-DOF redundant manipulators
// with joint limits, IEEE T-RO 24(5), 2008, equations 6 to 12; here for axes of any sign and any zero.) Where axis 1 is
// perpendicular to axis 2, and 2 to 3,
//
//   R = rot(a1, q1) rot(a2, q2) rot(a3, q3),    rot(a2, z) a1 = a3,    Q = q2 + z
//
//   a1' R a3 = cos Q                         e1' R a3 = sin Q cos q1        a2' R a3 = sin Q sin q1       e1 = a2 x a1
//                                           -a1' R e3 = sin Q cos q3        a1' R a2 = sin Q sin q3       e3 = a2 x a3
//
// so for either sign of sin Q a joint stands at one of its limits where an expression of form (1) is 0: at two swivel
// angles at most. Between these angles nothing changes, which is why looking once between each two neighbours finds
// every swivel angle that there is.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Geometry>

namespace foresight {

/// k0 + kc cos(psi) + ks sin(psi)
struct Harmonic {
  double k0 = 0, kc = 0, ks = 0;

  double at(double cosine, double sine) const noexcept { return k0 + kc * cosine + ks * sine; }
};

/// x' rot(n, psi) y; n of unit length.
Harmonic turned_product(const Eigen::Vector3d& x, const Eigen::Vector3d& n, const Eigen::Vector3d& y) noexcept;

/// Swivel angles at which something changes, of a few balls. No allocation.
class SwivelAngles {
 public:
  /// The roots of `f`, in -pi .. pi: none, or two (equal where they touch, and where `f` stays `miss` or less off 0).
  void add_roots(const Harmonic& f, double miss) noexcept;
  void sort() noexcept;
  std::size_t size() const noexcept { return size_; }
  double operator[](std::size_t i) const noexcept { return angles_[i]; }

 private:
  std::array<double, 32> angles_;
  std::size_t size_ = 0;
};

/// The entries of R(psi) that say what the three joints do.
struct BallTurn {
  Harmonic cos_middle, cos_first, sin_first, cos_last, sin_last;  ///< the latter four times sin Q
};

/// The two ways of three such joints to make one rotation: sin Q >= 0, and <= 0.
enum class BallSide : std::size_t { positive = 0, negative = 1 };

/// Three joints whose axes meet in one point, each perpendicular to the next. Immutable; no method allocates or throws.
class BallJoint {
 public:
  using Angles = std::array<double, 3>;

  BallJoint() = default;
  /// Unit axes with all joints at 0; limits in rad, infinite where there is none.
  BallJoint(const std::array<Eigen::Vector3d, 3>& axes, const Angles& lower, const Angles& upper);

  /// `product(y, z)`: the harmonic y' R(psi) z.
  template <typename Product>
  BallTurn turn(const Product& product) const noexcept {
    const Harmonic last = product(a_[0], e3_);
    return {product(a_[0], a_[2]),
            product(e1_, a_[2]),
            product(a_[1], a_[2]),
            {-last.k0, -last.kc, -last.ks},
            product(a_[0], a_[1])};
  }

  /// Adds the swivel angles at which a joint stands at a limit, on either side, or comes as near to it as `miss`.
  void add_limits(const BallTurn& turn, double miss, SwivelAngles& angles) const noexcept;

  /// For both sides: how far the joints are from their nearest limit and from the angle at which the first and the last
  /// axis fall together, whichever is less, in rad; negative: beyond a limit by so much. Exact where it is near 0, to
  /// 1e-4 elsewhere.
  std::array<double, 2> margins(const BallTurn& turn, double cosine, double sine) const noexcept;

  /// The three angles that make R, nearest to the middle of the limits where turns of 2 pi are free. Where first and
  /// last axis fall together, the first joint stands at `first`, within its limits.
  Angles angles(const Eigen::Matrix3d& R, BallSide side, double first) const noexcept;
  Eigen::Matrix3d rotation(const Angles& angles) const noexcept;

 private:
  std::array<Eigen::Vector3d, 3> a_;
  Eigen::Vector3d e1_, e3_;
  double z_ = 0;
  Angles middle_{}, half_{};  ///< of the limits; of Q for the second joint
  Angles cos_middle_{}, sin_middle_{};
  std::array<std::array<double, 2>, 3> cos_limit_{}, sin_limit_{};
};

/// `angle` plus the multiple of 2 pi that brings it nearest to `wanted`.
double nearest_turn(double angle, double wanted) noexcept;

}  // namespace foresight
