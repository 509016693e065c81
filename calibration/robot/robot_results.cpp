#include "calibration/robot/robot_results.hpp"

#include <yaml-cpp/yaml.h>

#include "calibration/camera/camera_result.hpp"
#include "common/error.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

void add_motion(const std::string& name, const Vector6d& sigma, std::map<std::string, double>& out) {
  const char* kParts[] = {"_rx_rad", "_ry_rad", "_rz_rad", "_x_m", "_y_m", "_z_m"};
  for (int i = 0; i < 6; ++i) out[name + kParts[i]] = sigma[i];
}

}  // namespace

std::string name_of_X(CameraMount mount) {
  return mount == CameraMount::fixed ? "T_base_camera" : "T_flange_camera";
}

std::string name_of_Y(CameraMount mount) {
  return mount == CameraMount::fixed ? "T_flange_board" : "T_base_board";
}

YAML::Node to_yaml(const HandEyeSummary& summary, const ArmNames& names, const std::optional<Pose>& T_head_base) {
  YAML::Node out;
  out["mount"] = to_string(summary.mount);
  out[name_of_X(summary.mount)] = to_yaml(summary.X);
  out[name_of_Y(summary.mount)] = to_yaml(summary.Y);
  out["board_scale"] = summary.board_scale;
  if (summary.camera.width > 0) out["camera"] = to_yaml(summary.camera);
  for (std::size_t i = 0; i < names.joints.size() && i < summary.joint_offsets.size(); ++i)
    out["joint_offsets"][names.joints[i]] = summary.joint_offsets[i];
  YAML::Node mount;
  mount["parent"] = summary.mount == CameraMount::fixed ? names.base : names.flange;
  mount["child"] = names.camera;
  mount["pose"] = to_yaml(summary.X);
  out["mounts"].push_back(mount);
  if (T_head_base) out["T_head_base"] = to_yaml(*T_head_base);
  return out;
}

YAML::Node to_yaml(const TimeOffsetSummary& summary) {
  YAML::Node out;
  out["offset_s"] = summary.offset_s;
  out["T_hand_camera"] = to_yaml(summary.X);
  out["T_base_target"] = to_yaml(summary.Y);
  return out;
}

YAML::Node to_yaml(const PanTiltModel& model) {
  YAML::Node out;
  out["T_world_pan"] = to_yaml(model.T_world_pan);
  out["length_m"] = model.length_m;
  out["twist_rad"] = model.twist_rad;
  out["T_tilt_camera"] = to_yaml(model.T_tilt_camera);
  for (const double gain : model.gain) out["gain"].push_back(gain);
  for (const double backlash : model.backlash_rad) out["backlash_rad"].push_back(backlash);
  return out;
}

YAML::Node to_yaml(const PanTiltTagSummary& summary, std::optional<double> offset_s) {
  YAML::Node out = to_yaml(summary.model);
  if (offset_s) out["offset_s"] = *offset_s;
  for (const double sigma : summary.pose_sigma) out["pose_sigma"].push_back(sigma);
  out["shaft_sigma_rad"] = summary.shaft_rad;
  out["corner_px"] = summary.corner_px;
  return out;
}

KnownHandEye read_hand_eye(const YamlMap& result) {
  KnownHandEye out;
  out.mount = result.choice<CameraMount>("mount", {{"fixed", CameraMount::fixed}, {"moving", CameraMount::moving}});
  out.X = result.pose(name_of_X(out.mount));
  out.Y = result.pose(name_of_Y(out.mount));
  out.board_scale = result.positive("board_scale");
  if (!result.has("camera"))
    throw InputError(result.file().string(), "holds no lens", "solve it from images, or with --camera FILE");
  out.camera = read_camera(result.map("camera"));
  return out;
}

std::map<std::string, double> sigmas_of(const HandEyeSummary& summary, const ArmNames& names) {
  std::map<std::string, double> out;
  add_motion(name_of_X(summary.mount), summary.X_sigma, out);
  add_motion(name_of_Y(summary.mount), summary.Y_sigma, out);
  if (summary.board_scale_sigma > 0) out["board_scale"] = summary.board_scale_sigma;
  if (!summary.camera_given) {
    const char* kNames[] = {"fx_px", "fy_px", "cx_px", "cy_px"};
    for (std::size_t i = 0; i < 4; ++i) out[kNames[i]] = summary.lens_sigma[i];
  }
  for (std::size_t i = 0; i < names.joints.size() && i < summary.joint_offset_sigma.size(); ++i)
    if (summary.joint_offset_sigma[i] > 0) out[names.joints[i] + "_offset"] = summary.joint_offset_sigma[i];
  return out;
}

std::map<std::string, double> sigmas_of(const TimeOffsetSummary& summary) {
  std::map<std::string, double> out{{"offset_s", summary.offset_sigma_s}};
  add_motion("T_hand_camera", summary.X_sigma, out);
  return out;
}

std::map<std::string, double> sigmas_of(const PanTiltTagSummary& summary) {
  std::map<std::string, double> out;
  for (std::size_t i = 0; i < summary.names.size(); ++i) out[summary.names[i]] = summary.sigmas[i];
  return out;
}

std::map<std::string, double> sigmas_of(const PanTiltSummary& summary) {
  std::map<std::string, double> out;
  for (std::size_t i = 0; i < summary.names.size(); ++i) out[summary.names[i]] = summary.sigmas[i];
  return out;
}

}  // namespace foresight
