// Shadows of what moves as images have them over time: points of a surface, each beside what it usually looks like.
#pragma once

#include <deque>
#include <random>
#include <vector>

#include "texture_gpu/lamp/lamp_record.hpp"
#include "texture_gpu/lamp/round_lamp.hpp"

namespace foresight {

class MovingShadows {
 public:
  /// `moving`: nodes whose shadows are looked for; the others throw theirs where the last record has them. `rays`,
  /// `witnesses` and `records`, of which there is one at least, must outlive this. `generator` chooses observations.
  MovingShadows(const ShadowRays& rays, const std::vector<Witness>& witnesses, const std::deque<LampRecord>& records,
                const std::vector<bool>& moving, std::mt19937& generator);

  /// How often something was darker than it usually is; of these, those that are among the first `most` observations.
  std::size_t dark() const { return dark_; }
  std::size_t dark(std::size_t most) const;
  /// Share of the squared deviations that shadows of a lamp there take away, at the darkness that suits them best: of
  /// `most` observations at most, dark ones first. Metres, world.
  double explained(const Eigen::Vector3d& lamp, double radius, const Disc& disc, std::size_t most) const;

  /// An observation that a lamp has to do with, as parts of it are hidden now, or were when all was as usual.
  struct Shadowed {
    Eigen::Vector3f deviation;       ///< of red, green and blue from what is usual, logarithms
    double facing, hidden, usually;  ///< (n . l) / d^2; shares of the lamp
  };
  /// `coarsely` tells which they are, `finely` how much is hidden.
  std::vector<Shadowed> shadowed(const Eigen::Vector3d& lamp, double radius, const Disc& coarsely,
                                 const Disc& finely) const;

 private:
  struct Observation {
    std::size_t record = 0, witness = 0;
    std::size_t lit = 0;  // the record that shows the witness as bright as it usually is
    Eigen::Vector3f deviation;
    float luma = 0;  // mean of these
  };
  std::vector<Observation> observations() const;
  double hidden(std::size_t witness, std::size_t record, const Eigen::Vector3d& lamp, double radius,
                const Disc& disc) const;

  const std::vector<Witness>& witnesses_;
  const std::deque<LampRecord>& records_;
  std::vector<ShadowRays::Posed> moving_;  // of each record
  ShadowRays::Posed still_;
  std::vector<Observation> all_, chosen_;
  std::size_t dark_ = 0;
};

}  // namespace foresight
