#include "apps/calibrate/arm_report.hpp"

#include "apps/calibrate/robot_output.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

nlohmann::ordered_json view_numbers(const HandEyeView& view) {
  return {{"name", view.name},
          {"used", view.used},
          {"points", view.points},
          {"rejected_points", view.rejected},
          {"rms_px", view.rms_px},
          {"loo_px", view.loo_px},
          {"loo_mm", view.loo_mm},
          {"correction_mrad", 1e3 * view.correction.head<3>().norm()},
          {"correction_mm", 1e3 * view.correction.tail<3>().norm()},
          {"robot_pose_weight", view.trust},
          {"quarter_turns", view.turned}};
}

void plot_residuals(const HandEyeSummary& summary, HtmlReport& report) {
  HtmlReport::Series corners{"corners", {}, false}, px{"left out, px", {}, false}, mm{"left out, mm", {}, false};
  for (std::size_t v = 0; v < summary.views.size(); ++v) {
    const HandEyeView& view = summary.views[v];
    if (!view.used) continue;
    corners.points.insert(corners.points.end(), view.residuals_px.begin(), view.residuals_px.end());
    px.points.emplace_back(static_cast<double>(v), view.loo_px);
    mm.points.emplace_back(static_cast<double>(v), view.loo_mm);
  }
  report.plot("Residuals of the corners, robot poses corrected", "x / px", "y / px", {corners}, true);
  report.plot("Error of each view when it is left out", "view", "px or mm", {px, mm});
}

}  // namespace

nlohmann::ordered_json arm_numbers(const HandEyeSummary& s, const ArmNames& names,
                                   const std::optional<Pose>& T_head_base) {
  nlohmann::ordered_json out;
  int unused = 0;
  for (const HandEyeView& view : s.views) unused += !view.used;
  out["loo_px"] = s.loo_px, out["loo_mm"] = s.loo_mm, out["loo_across_mm"] = s.loo_across_mm;
  out["in_sample_px"] = s.in_sample_px, out["uncorrected_px"] = s.uncorrected_px;
  out["views"] = s.views.size(), out["rejected_views"] = unused, out["rejected_points"] = s.rejected_points;
  out["camera_mount"] = to_string(s.mount);
  out["start_mm"] = {{"fixed", s.start_mm_fixed}, {"moving", s.start_mm_moving}};
  out["fx_px"] = s.camera.lens[0], out["fy_px"] = s.camera.lens[1];
  out["camera"] = json_of(s.camera), out["camera_given"] = s.camera_given;
  out["X"] = json_of(s.X), out["X_is"] = name_of_X(s.mount);
  out["Y"] = json_of(s.Y), out["Y_is"] = name_of_Y(s.mount);
  out["board_scale"] = s.board_scale;
  out["corner_noise_px"] = s.sigma_px, out["robot_noise_mrad"] = 1e3 * s.sigma_robot_rad,
  out["robot_noise_mm"] = 1e3 * s.sigma_robot_m;
  for (std::size_t i = 0; i < s.joint_offsets.size() && i < names.joints.size(); ++i)
    out["joint_offsets"][names.joints[i]] = s.joint_offsets[i];
  if (T_head_base) out["T_head_base"] = json_of(*T_head_base);
  out["sigmas"] = sigmas_of(s, names);
  for (const HandEyeView& view : s.views) out["per_view"].push_back(view_numbers(view));
  out["notes"] = s.notes;
  return out;
}

HtmlReport arm_report(const HandEyeSummary& s, const ArmNames& names) {
  HtmlReport report("Hand-eye calibration");
  report.table({"", ""}, {{"left out, px", readable(s.loo_px, 3)},
                          {"left out, mm", readable(s.loo_mm, 3)},
                          {"in sample, px", readable(s.in_sample_px, 3)},
                          {"corners rejected", std::to_string(s.rejected_points)},
                          {"camera", to_string(s.mount)},
                          {name_of_X(s.mount), readable_pose(s.X)},
                          {name_of_Y(s.mount), readable_pose(s.Y)},
                          {"board, true over stated size", readable(s.board_scale, 5)},
                          {"noise of a corner, px", readable(s.sigma_px, 3)},
                          {"noise of the robot, mm", readable(1e3 * s.sigma_robot_m, 3)},
                          {"noise of the robot, mrad", readable(1e3 * s.sigma_robot_rad, 3)}});
  report_notes(report, s.notes);
  plot_residuals(s, report);
  report.heading("Views");
  std::vector<std::vector<std::string>> rows;
  for (const HandEyeView& view : s.views)
    rows.push_back({view.name, view.used ? "yes" : "no", std::to_string(view.points), std::to_string(view.rejected),
                    readable(view.rms_px, 3), readable(view.loo_px, 2), readable(view.loo_mm, 2),
                    readable(1e3 * view.correction.head<3>().norm(), 2),
                    readable(1e3 * view.correction.tail<3>().norm(), 2)});
  report.table({"view", "used", "corners", "rejected", "rms / px", "left out / px", "left out / mm",
                "robot turned / mrad", "robot moved / mm"},
               rows);
  report_sigmas(report, sigmas_of(s, names));
  return report;
}

}  // namespace foresight
