// How far from where it is drawn each node may be seen: the joints' uncertainty, in pixels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/lens.hpp"
#include "seat/predicted_place.hpp"

namespace foresight {

/// Middle of each node's vertices, in its frame.
std::vector<Eigen::Vector3d> node_middles(const SceneModel& scene);

inline constexpr double kMostPx = 50;     ///< of node_doubt_px()
inline constexpr double kBlurred = 0.02;  ///< s: exposure, and what is not known of instants

/// For each node how far off it may be, px of `lens` about its middle: by the uncertainty of all joints, those of the
/// head move the whole view; and by how far it goes within kBlurred at the speed at which the view went from `before`
/// here. At most kMostPx, also where the robot is invalid.
std::vector<double> node_doubt_px(const PredictedPlaces& places, const PredictedRobot& robot, const Lens& lens,
                                  std::span<const Eigen::Vector3d> middles, const std::optional<ViewPlace>& before);

}  // namespace foresight
