// How far from where it is drawn each node may be seen: the joints' uncertainty, in pixels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/lens.hpp"
#include "display/doubt_kinds.hpp"
#include "seat/predicted_place.hpp"

namespace foresight {

/// Middle of each node's vertices, in its frame.
std::vector<Eigen::Vector3d> node_middles(const SceneModel& scene);

inline constexpr double kBlurred = 0.02;  ///< s: exposure, and what is not known of instants
inline constexpr double kNotKnownPx = 3;  ///< what the joints are less sure of may be anywhere

/// For each node how far off it may be, px of `lens` about its middle: by the uncertainty of all joints, those of the
/// head move the whole view; and by how far it goes within kBlurred at the speed at which the view went from `before`
/// here. At most kAnywherePx, which is that of an invalid robot, and of a node about which the joints' uncertainty
/// alone is more than kNotKnownPx: how often pixels are wrong is learnt while the robot does as predicted.
std::vector<double> node_doubt_px(const PredictedPlaces& places, const PredictedRobot& robot, const Lens& lens,
                                  std::span<const Eigen::Vector3d> middles, const std::optional<ViewPlace>& before);

}  // namespace foresight
