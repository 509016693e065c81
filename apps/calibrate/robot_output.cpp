#include "apps/calibrate/robot_output.hpp"

#include <nlohmann/json.hpp>

#include "common/text.hpp"

namespace foresight {

nlohmann::ordered_json json_of(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d t = pose.translation();
  return {{"xyz", {t.x(), t.y(), t.z()}}, {"quaternion", {q.x(), q.y(), q.z(), q.w()}}};
}

nlohmann::ordered_json json_of(const CameraModel& camera) {
  nlohmann::ordered_json out;
  out["model"] = to_string(camera.distortion);
  out["width"] = camera.width, out["height"] = camera.height;
  for (const int i : free_parameters(camera.distortion))
    out["lens"].push_back(camera.lens[static_cast<std::size_t>(i)]);
  return out;
}

std::string readable_pose(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  std::string out;
  for (int i = 0; i < 3; ++i) out += readable(pose.translation()[i], 5) + (i < 2 ? " " : " m, turned ");
  for (int i = 0; i < 4; ++i) out += readable(q.coeffs()[i], 5) + (i < 3 ? " " : " (qx qy qz qw)");
  return out;
}

void report_model(HtmlReport& report, const PanTiltModel& model) {
  report.table({"", ""}, {{"T_world_pan", readable_pose(model.T_world_pan)},
                          {"distance of the axes, mm", readable(1e3 * model.length_m, 3)},
                          {"angle of the axes, degrees", readable(model.twist_rad * 57.29577951, 4)},
                          {"T_tilt_camera", readable_pose(model.T_tilt_camera)},
                          {"gain of pan and tilt", readable(model.gain[0], 5) + " " + readable(model.gain[1], 5)},
                          {"backlash of pan and tilt, mrad",
                           readable(1e3 * model.backlash_rad[0], 3) + " " + readable(1e3 * model.backlash_rad[1], 3)}});
}

void report_sigmas(HtmlReport& report, const std::map<std::string, double>& sigmas) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, sigma] : sigmas) rows.push_back({name, readable(sigma, 6)});
  report.heading("Standard deviations");
  report.table({"parameter", "sigma"}, rows);
}

void report_notes(HtmlReport& report, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) report.paragraph("Note: " + note + ".");
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::cout << "note: " << note << "\n";
}

}  // namespace foresight
