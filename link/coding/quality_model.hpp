// How coarse a picture has to be coded so that it takes a given number of bytes.
#pragma once

#include <cstddef>

namespace foresight {

/// Steps are those of H.264's quantiser: six of them double its width. Learns from every picture that was coded; what a
/// picture will take is known only afterwards, so that a change of the scene shows in the next one's step.
class QualityModel {
 public:
  struct Range {
    int finest = 0, coarsest = 51;
  };
  /// `steps_per_halving`: how many steps halve the bytes. `step`, `bytes`: what a first picture is expected to take.
  QualityModel(Range range, double steps_per_halving, int step, double bytes);

  /// The step at which a picture as hard as the last is expected to take about `budget` bytes.
  int step_for(std::size_t budget) const;
  /// A picture took `bytes` at `step`.
  void learn(int step, std::size_t bytes);

 private:
  Range range_;
  double steps_per_halving_;
  double at_zero_;  // log2 of the bytes at step 0
};

}  // namespace foresight
