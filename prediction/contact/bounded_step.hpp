// The change of joints that brings the tool nearest to where it is wanted, where some ways are closed.
//
//   min  |J x - e|^2 + mu |x|^2      with   lower <= x <= upper   and   c_k . x >= b_k
//
// by ascent over the multipliers of the closed ways, one after the other (Hildreth, A quadratic programming procedure,
// 1957): a contact takes away the part of the motion that goes into it and leaves what goes along.
#pragma once

#include <span>

#include "prediction/arm_chain.hpp"

namespace foresight {

/// row . x >= least. `pressed` gets how hard the step leans on it: its multiplier, 0 where the step would stay clear.
struct ClosedWay {
  JointVector row;
  double least = 0;
  double pressed = 0;
};

inline constexpr std::size_t kMostClosedWays = 16;

/// Heeds the first kMostClosedWays of `closed`. `change` is weighted as the error `e` is; 0 within lower .. upper, one
/// number per joint; mu > 0. Where the closed ways contradict one another or the limits, the limits hold. Neither
/// throws nor allocates; any thread.
JointVector bounded_step(const TipChange& change, const Vector6& e, double mu, const JointVector& lower,
                         const JointVector& upper, std::span<ClosedWay> closed) noexcept;

}  // namespace foresight
