// What a recording holds beside its scene, as the calibrations of joints read it: pictures with their instants, and
// where the joints were.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/robot/pose_stream.hpp"

namespace foresight {

struct TimedPicture {
  RobotTime time;
  std::filesystem::path file;
};

/// Rows "time file" (rgb.txt of a run), files beside the list. Throws InputError naming file and line.
std::vector<TimedPicture> read_picture_list(const std::filesystem::path& list);

/// Throws InputError where `run` is no folder that `foresight robot --record` or `foresight record` wrote.
void require_run(const std::filesystem::path& run);

/// Positions of the joints `names`, in this order: the columns of these names where the file begins with a row of names
/// (time_s,pan,tilt,...: as `robot --record` and `record` write it), else as many columns after the time. Throws
/// InputError naming file, line, and a joint that is not there with the nearest one; `option`: names the joints.
std::vector<JointRow> read_named_joints(const std::filesystem::path& file, const std::vector<std::string>& names,
                                        const std::string& option);

/// Names in the first row of a table; empty where it begins with numbers.
std::vector<std::string> column_names(const std::filesystem::path& file);

}  // namespace foresight
