// Robot calibrations in result files (calibration/result/result_file.hpp).
//
//   kind "arm"       mount: fixed|moving; T_base_camera or T_flange_camera; T_flange_board or
//                    T_base_board; board_scale; camera: {...} as in kind "intrinsics";
//                    joint_offsets: {NAME: rad or m}; mounts: [{parent, child, pose}] for a URDF;
//                    T_head_base where the head's angles were given
//   kind "time"      offset_s (t_encoder = t_camera + offset); T_hand_camera; T_base_target
//   kind "pan-tilt"  what PanTiltModel holds, under its names; from tags also pose_sigma (6: rad, m; of the camera's
//                    pose by the model), shaft_sigma_rad, corner_px, and offset_s where it was estimated
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/robot/hand_eye.hpp"
#include "calibration/robot/pan_tilt.hpp"
#include "calibration/robot/pan_tilt_tags.hpp"
#include "calibration/robot/time_offset.hpp"

namespace YAML {
class Node;
}

namespace foresight {

class YamlMap;

struct ArmNames {
  std::string base = "base", flange = "flange", camera = "camera";
  std::vector<std::string> joints;  ///< of HandEyeSummary::joint_offsets
};

YAML::Node to_yaml(const HandEyeSummary& summary, const ArmNames& names, const std::optional<Pose>& T_head_base);
YAML::Node to_yaml(const TimeOffsetSummary& summary);
YAML::Node to_yaml(const PanTiltModel& model);
/// `offset_s`: what stands in the file, nothing where the clocks were not compared.
YAML::Node to_yaml(const PanTiltTagSummary& summary, std::optional<double> offset_s);

/// What `verify` needs of a file of kind "arm". Throws InputError naming file and field.
KnownHandEye read_hand_eye(const YamlMap& result);

/// Standard deviations by name, as the header of the file holds them.
std::map<std::string, double> sigmas_of(const HandEyeSummary& summary, const ArmNames& names);
std::map<std::string, double> sigmas_of(const TimeOffsetSummary& summary);
std::map<std::string, double> sigmas_of(const PanTiltSummary& summary);
std::map<std::string, double> sigmas_of(const PanTiltTagSummary& summary);

/// "T_base_camera", "T_flange_board" and so on.
std::string name_of_X(CameraMount mount);
std::string name_of_Y(CameraMount mount);

}  // namespace foresight
