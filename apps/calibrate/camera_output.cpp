#include "apps/calibrate/camera_output.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/calibrate/camera_report.hpp"
#include "calibration/camera/camera_result.hpp"
#include "calibration/formats/camera_formats.hpp"

namespace foresight {
namespace {

using Json = nlohmann::ordered_json;

Json score_json(const HeldOutScore& score, bool pair) {
  Json json{{"joint_px", score.joint_px}};
  if (pair) json["cross_px"] = score.cross_px, json["epipolar_px"] = score.epipolar_px;
  json["joint_inlier_px"] = score.joint_inlier_px;
  if (pair) json["cross_inlier_px"] = score.cross_inlier_px, json["epipolar_inlier_px"] = score.epipolar_inlier_px;
  json["rejected_points"] = score.rejected_points;
  json["views"] = score.views;
  return json;
}

Json map_json(const UncertaintyMap& map) {
  return {{"centre_px", map.centre_px},
          {"median_px", map.median_px},
          {"p90_px", map.p90_px},
          {"worst_corner_px", map.worst_corner_px}};
}

Json camera_json(const CameraCalibration& c, std::size_t camera) {
  const CameraModel& model = c.solution.rig.cameras[camera];
  const auto count = free_parameters(model.distortion).size();
  return {{"model", to_string(model.distortion)},
          {"width", model.width},
          {"height", model.height},
          {"fx_px", model.lens[0]},
          {"fy_px", model.lens[1]},
          {"cx_px", model.lens[2]},
          {"cy_px", model.lens[3]},
          {"distortion", std::vector<double>(model.lens.begin() + 4, model.lens.begin() + std::ptrdiff_t(count))},
          {"uncertainty_at_infinity", map_json(c.at_infinity[camera])},
          {"uncertainty_at_board", map_json(c.at_board[camera])},
          {"odd_even_px", c.odd_even_px[camera]}};
}

void add_pair(const CameraCalibration& c, Json& json) {
  const Pose& T = c.solution.rig.T_left_right;
  json["baseline_m"] = T.translation().norm();
  json["rotation_deg"] = Eigen::AngleAxisd(T.linear()).angle() * 180 / M_PI;
  const Eigen::Quaterniond q(T.linear());
  json["T_left_right"] = {{"xyz", {T.translation().x(), T.translation().y(), T.translation().z()}},
                          {"quaternion", {q.x(), q.y(), q.z(), q.w()}}};
  json["stereo_over_mono"] = c.stereo_over_mono;
  json["left"] = camera_json(c, 0);
  json["right"] = camera_json(c, 1);
}

ResultHeader header_of(const CameraCalibration& c, const std::vector<std::string>& serials) {
  ResultHeader header;
  const bool pair = c.cameras() == 2;
  header.kind = pair ? "stereo" : "intrinsics";
  for (std::size_t i = 0; i < std::min(serials.size(), c.cameras()); ++i)
    header.devices[camera_name(static_cast<int>(i), c.views.cameras)] = serials[i];
  header.score_name = pair ? "loo_joint_px" : "loo_px";
  header.score = c.held_out.joint_px;
  for (const auto& [name, sigma] : c.sigma)
    if (std::isfinite(sigma)) header.sigma[name] = sigma;
  return header;
}

void write_camera_info(const CameraCalibration& c, const std::filesystem::path& folder) {
  const CameraRig& rig = c.solution.rig;
  std::filesystem::create_directories(folder);
  write_cameras(CameraFormat::camera_info, rig, rig.pair() ? folder : folder / "camera.yaml", true);
}

std::vector<Output> camera_info_outputs(const std::filesystem::path& folder) {
  return {{folder, Output::Kind::folder},
          {folder / "camera.yaml", Output::Kind::file, camera_info_form()},
          {folder / "camera_right.yaml", Output::Kind::file, camera_info_form()}};
}

}  // namespace

void add_camera_output(Command& command, CameraOutput& output) {
  add_outputs(command, output.files);
  command.add_option("--camera-info", output.camera_info, "Folder for ROS camera_info files, as a run folder has them")
      ->writes(camera_info_outputs);
  command.add_option("--serials", output.serials, "Serial numbers of the cameras, for the result file")->expected(1, 2);
}

nlohmann::ordered_json camera_numbers(const CameraCalibration& c) {
  const bool pair = c.cameras() == 2;
  const LensParameters& lens = c.solution.rig.cameras[0].lens;
  Json json{{"in_sample_px", c.solution.rms_px},
            {"rejected_points", c.solution.rejected.size()},
            {"views", c.views.views.size()}};
  json[pair ? "loo_joint_px" : "loo_px"] = c.held_out.joint_px;
  if (pair) json["loo_cross_px"] = c.held_out.cross_px, json["loo_epipolar_px"] = c.held_out.epipolar_px;
  json[pair ? "loo_joint_inlier_px" : "loo_inlier_px"] = c.held_out.joint_inlier_px;
  if (pair) {
    json["loo_cross_inlier_px"] = c.held_out.cross_inlier_px;
    json["loo_epipolar_inlier_px"] = c.held_out.epipolar_inlier_px;
  }
  json["loo_rejected_points"] = c.held_out.rejected_points;
  json["fx_px"] = lens[0];
  json["fy_px"] = lens[1];
  json["noise_px"] = c.solution.noise_px;
  json["points"] = c.solution.points;
  json["folds"] = c.folds;
  if (c.unseen) json["unseen"] = score_json(*c.unseen, pair);
  if (pair)
    add_pair(c, json);
  else
    json["camera"] = camera_json(c, 0);
  json["board_distance_m"] = c.board_distance_m;
  if (c.warp) json["board_warp_m"] = {c.solution.rig.warp.x_m, c.solution.rig.warp.y_m};
  for (const auto& [name, sigma] : c.sigma) json["sigma"][name] = sigma;
  json["turned_views"] = c.repairs.turned;
  json["dropped_views"] = c.repairs.dropped;
  json["notes"] = c.notes;
  return json;
}

int deliver(const CameraCalibration& c, const CameraViewsInput& input, const CameraOutput& output) {
  std::fputs(c.full().c_str(), stdout);
  const CameraRig& rig = c.solution.rig;
  Deliverable found{c.verdict, header_of(c, output.serials), to_yaml(rig),
                    [&] { return camera_report(c, input.files); }};
  found.header.views = prints_of(input.train, c.views);
  if (c.warp) found.payload["board"] = to_yaml(KnownBoard(c.views.p_board, rig.warp));
  Json numbers = camera_numbers(c);
  const int code = deliver(found, numbers, output.files);
  if (output.camera_info && c.usable()) write_camera_info(c, *output.camera_info);
  return code;
}

}  // namespace foresight
