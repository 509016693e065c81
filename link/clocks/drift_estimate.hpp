// How fast another clock runs away from ours, from bounds of their offset at several instants.
#pragma once

#include <cstdint>
#include <span>

namespace foresight {

/// Shares of a second per second: 1e-6 is a millionth.
struct DriftInterval {
  double least = 0, most = 0;
};

/// The two bounds of an offset around one instant, ns. Their middle is off by half of what the two ways differ, and by
/// up to half of what the bounds are wider than they could be.
struct OffsetAnchor {
  double at = 0;
  double least = 0, most = 0;
};

/// What drifts within `widest` all of them allow, newest last. While the ways' least delays stay as they are, the
/// middles of two anchors move by the drift alone, but for what each is wider than the narrowest. Where they contradict
/// each other a way has changed: then only those since are believed. An exchange of delay between the ways that leaves
/// their sum as it was goes unnoticed as long as a single pair of anchors straddles it.
DriftInterval drift_of(std::span<const OffsetAnchor> anchors, DriftInterval widest);

}  // namespace foresight
