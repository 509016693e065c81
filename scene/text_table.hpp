// Text tables in the form of TUM RGB-D runs: one row a line, fields between blanks.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "common/text_rows.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Visits every row of `file`, as common/text_rows.hpp has them. `form` names the fields, one blank between them
/// ("time tx ty"). Throws InputError naming file and line where a row has another number of fields, and where there is
/// no row.
void for_each_row(const std::filesystem::path& file, const std::string& form,
                  const std::function<void(const TextRow&)>& visit);

/// Field `index` as seconds, exact to the nanosecond. Throws InputError: no number, or beyond
/// what seconds can be (then it is probably in milliseconds).
RobotTime time_field(const TextRow& row, std::size_t index);

/// Seven fields from `first` on, tx ty tz qx qy qz qw, as a pose. Throws InputError: no number,
/// not finite, farther than kFarthest, a quaternion whose length differs from 1 by over 1e-3
/// (a smaller difference is rounding and is normalised away).
Pose pose_fields(const TextRow& row, std::size_t first);

/// Shared with the yaml forms of a pose: `t` and a quaternion given as x, y, z, w.
Pose checked_pose(const Eigen::Vector3d& t, const Eigen::Vector4d& q_xyzw, const std::string& where);
inline constexpr double kFarthest = 1e6;  ///< metres from the world's origin

/// Throws InputError unless `time` lies after `previous`; duplicate and unsorted times are told apart.
void require_ascending(const TextRow& row, RobotTime previous, RobotTime time);

}  // namespace foresight
