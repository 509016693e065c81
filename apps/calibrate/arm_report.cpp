#include "apps/calibrate/arm_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/calibrate/robot_output.hpp"
#include "apps/calibrate/view_pictures.hpp"
#include "calibration/result/frame_drawing.hpp"
#include "common/counted.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostArmPictures = 24;

nlohmann::ordered_json numbers_of(const HandEyeView& view) {
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

std::vector<std::string> names_of(const HandEyeSummary& summary) {
  std::vector<std::string> names;
  for (const HandEyeView& view : summary.views) names.push_back(view.name);
  return names;
}

void plot_residuals(const HandEyeSummary& summary, HtmlReport& report) {
  const std::vector<int> number = view_numbers(names_of(summary));
  HtmlReport::Series corners{"corners", {}, false}, px{"left out, px", {}, false}, mm{"left out, mm", {}, false};
  for (std::size_t v = 0; v < summary.views.size(); ++v) {
    const HandEyeView& view = summary.views[v];
    if (!view.used) continue;
    corners.points.insert(corners.points.end(), view.residuals_px.begin(), view.residuals_px.end());
    px.points.emplace_back(number[v], view.loo_px);
    mm.points.emplace_back(number[v], view.loo_mm);
  }
  report.plot("Error of each view when it is left out", "view", "px or mm", {px, mm});
  report.plot("Residuals of the corners, robot poses corrected", "x / px", "y / px", {corners}, true);
}

std::vector<Pose> flanges_of(const ArmViews& views) {
  std::vector<Pose> out;
  for (const RobotPose& pose : views.data.poses) out.push_back(pose.T_base_flange);
  if (!views.chain) return out;
  JointChain chain = *views.chain;
  for (const std::vector<double>& row : views.rows) out.push_back(flange_pose(chain, row, "joints"));
  return out;
}

std::vector<Eigen::Vector3d> outline(const std::vector<Eigen::Vector3d>& p_board, const Pose& T) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : p_board) box.extend(p);
  const Eigen::Vector3d a = box.min(), b = box.max();
  return {T * a, T * Eigen::Vector3d(b.x(), a.y(), 0), T * b, T * Eigen::Vector3d(a.x(), b.y(), 0)};
}

void draw_frames(const HandEyeSummary& s, const ArmViews& views, HtmlReport& report) {
  const std::vector<Pose> flanges = flanges_of(views);
  const double width = s.camera.width > 0 ? s.camera.width : 2 * s.camera.lens[2],
               height = s.camera.height > 0 ? s.camera.height : 2 * s.camera.lens[3];
  const double tan_x = width / 2 / s.camera.lens[0], tan_y = height / 2 / s.camera.lens[1];
  Eigen::AlignedBox3d box(Eigen::Vector3d::Zero());
  for (const Pose& T : flanges) box.extend(T.translation());
  box.extend(s.mount == CameraMount::fixed ? s.X.translation() : s.Y.translation());
  const double size = std::clamp(0.08 * box.diagonal().norm(), 0.02, 0.3);
  FrameDrawing drawing;
  drawing.frame(views.names.base, Pose::Identity(), 1.5 * size);
  bool named = false;
  for (std::size_t v = 0; v < flanges.size(); ++v) {
    const Pose& F = flanges[v];
    const std::string name = !named && s.views[v].used ? views.names.flange : "";
    drawing.frame(name, F, (name.empty() ? 0.35 : 0.8) * size);
    if (s.mount == CameraMount::fixed)
      drawing.line(outline(views.data.corners.p_board, F * s.Y), s.views[v].used ? "k5" : "k7", true);
    else
      drawing.camera("", F * s.X, tan_x, tan_y, 0.6 * size);
    named = named || !name.empty();
  }
  if (s.mount == CameraMount::fixed) {
    drawing.frame(views.names.camera, s.X, size);
    drawing.camera("", s.X, tan_x, tan_y, 1.5 * size);
  } else {
    drawing.frame("board", s.Y, size);
    drawing.line(outline(views.data.corners.p_board, s.Y), "k5", true);
  }
  report.drawing("Where everything stands", drawing.svg("frames of the calibration"));
}

void show_pictures(const HandEyeSummary& s, const ArmViews& views, HtmlReport& report) {
  const std::vector<int> number = view_numbers(names_of(s));
  std::vector<HtmlReport::Picture> pictures;
  for (const std::size_t v : some_of(s.views.size(), kMostArmPictures)) {
    const HandEyeView& view = s.views[v];
    const auto file = views.files.find(view.name);
    if (file == views.files.end()) continue;
    std::vector<ShownPoint> points;
    for (std::size_t c = 0; c < view.found_px.size(); ++c)
      points.push_back({view.found_px[c], view.found_px[c] - view.residuals_px[c]});
    const std::string caption = view.used ? readable(view.rms_px, 2, " px; left out ") +
                                                readable(view.loo_px, 2, " px, ") + readable(view.loo_mm, 2, " mm")
                                          : "left out: its robot pose contradicts the others";
    pictures.push_back({draw_view(file->second, points), std::to_string(number[v]) + ": " + view.name, caption});
  }
  if (pictures.empty()) return;
  report.heading("Pictures");
  report.paragraph("Rings: corners as found. Lines: to where the solution has them, " + readable(kArrow, 0) +
                   " times too long.");
  report.pictures(pictures);
}

}  // namespace

std::string robot_noise_words(const HandEyeSummary& s) {
  constexpr double kLeast = 2e-5;  // rad or m: what the solver takes at least
  if (s.sigma_robot_m < kLeast && s.sigma_robot_rad < kLeast) return "none found (below 0.02 mm and 0.02 mrad)";
  return readable(1e3 * s.sigma_robot_m, 2) + " mm and " + readable(1e3 * s.sigma_robot_rad, 2) + " mrad";
}

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
  for (const HandEyeView& view : s.views) out["per_view"].push_back(numbers_of(view));
  out["notes"] = s.notes;
  return out;
}

HtmlReport arm_report(const HandEyeSummary& s, const ArmViews& views, const std::optional<HandEyeScore>& kept) {
  HtmlReport report("Hand-eye calibration");
  const std::string of_kept =
      kept ? readable(kept->px, 3, " px, ") + readable(kept->mm, 3, " mm on ") + counted(kept->views, "view") : "-";
  report.table({"", ""}, {{"each view left out in turn", readable(s.loo_px, 3, " px, ") + readable(s.loo_mm, 3, " mm")},
                          {"views kept back from the solver", of_kept},
                          {"in sample, px", readable(s.in_sample_px, 3)},
                          {"corners rejected", std::to_string(s.rejected_points)},
                          {"camera", to_string(s.mount)},
                          {name_of_X(s.mount), readable_pose(s.X)},
                          {name_of_Y(s.mount), readable_pose(s.Y)},
                          {"board, true over stated size", readable(s.board_scale, 5)},
                          {"noise of a corner, px", readable(s.sigma_px, 3)},
                          {"noise of the robot, per axis", robot_noise_words(s)}});
  report.paragraph(
      "Noise of the robot: by how much its poses differ from where the pictures have the board, beyond what the noise "
      "of "
      "the corners explains.");
  report_notes(report, s.notes);
  draw_frames(s, views, report);
  plot_residuals(s, report);
  show_pictures(s, views, report);
  report.heading("Views");
  const std::vector<int> number = view_numbers(names_of(s));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    const HandEyeView& view = s.views[v];
    rows.push_back({std::to_string(number[v]), view.name, view.used ? "yes" : "no", std::to_string(view.points),
                    std::to_string(view.rejected), readable(view.rms_px, 3), readable(view.loo_px, 2),
                    readable(view.loo_mm, 2), readable(1e3 * view.correction.head<3>().norm(), 2),
                    readable(1e3 * view.correction.tail<3>().norm(), 2)});
  }
  report.table({"view", "name", "used", "corners", "rejected", "rms / px", "left out / px", "left out / mm",
                "robot turned / mrad", "robot moved / mm"},
               rows);
  report_sigmas(report, sigmas_of(s, views.names));
  return report;
}

}  // namespace foresight
