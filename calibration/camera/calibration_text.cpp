#include <cstdio>
#include <sstream>

#include "calibration/camera/camera_calibration.hpp"
#include "common/counted.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kListed = 10;

std::string lens_line(const CameraCalibration& c, std::size_t camera) {
  const CameraModel& model = c.solution.rig.cameras[camera];
  const std::string side = c.views.cameras == 2 ? "_" + camera_name(static_cast<int>(camera), 2) : "";
  const auto with_sigma = [&](const char* name, double value) {
    return std::string(name) + " " + readable(value, 2) + " +- " + readable(c.sigma.at(name + side + "_px"), 2) + "  ";
  };
  const LensParameters& l = model.lens;
  std::string line = with_sigma("fx", l[0]) + with_sigma("fy", l[1]) + with_sigma("cx", l[2]) + with_sigma("cy", l[3]);
  return line + to_string(model.distortion) + ", " + std::to_string(model.width) + "x" + std::to_string(model.height);
}

void write_uncertainty(std::ostream& out, const CameraCalibration& c, std::size_t camera) {
  const auto row = [&](const UncertaintyMap& map, const std::string& where) {
    out << "  uncertainty " << where << ": centre " << readable(map.centre_px, 3) << ", middle "
        << readable(map.median_px, 3) << ", 90 % below " << readable(map.p90_px, 3) << ", worst corner "
        << readable(map.worst_corner_px, 2, " px") << "\n";
  };
  row(c.at_infinity[camera], "at infinity");
  row(c.at_board[camera], "at " + readable(c.board_distance_m, 2, " m"));
  out << "  odd and even views differ by " << readable(c.odd_even_px[camera], 3, " px") << "\n";
}

void write_lists(std::ostream& out, const CameraCalibration& c) {
  for (const std::string& name : c.repairs.turned)
    out << "turned: view " << name << " (one camera saw the board reversed)\n";
  for (const std::string& name : c.repairs.dropped) out << "dropped: view " << name << "\n";
  const auto& rejected = c.solution.rejected;
  for (std::size_t i = 0; i < std::min(kListed, rejected.size()); ++i)
    out << "rejected: " << camera_name(rejected[i].camera, c.views.cameras) << " view "
        << c.views.views[rejected[i].view].name << ", corner " << rejected[i].index << ", "
        << readable(rejected[i].error_px, 2, " px") << "\n";
  if (rejected.size() > kListed) out << "rejected: and " << rejected.size() - kListed << " more\n";
  for (const std::string& note : c.notes) out << "note: " << note << "\n";
}

}  // namespace

std::string CameraCalibration::brief() const {
  std::ostringstream out;
  out << (usable() ? "usable" : "NOT USABLE") << ": " << readable(solution.rms_px, 3, " px") << " in sample, ";
  if (views.cameras == 2)
    out << readable(held_out.joint_px, 3) << " / " << readable(held_out.cross_px, 3) << " / "
        << readable(held_out.epipolar_px, 3, " px") << " held out (joint / cross / epipolar)";
  else
    out << readable(held_out.joint_px, 3, " px") << " held out";
  out << ", " << counted(views.views.size(), "view");
  if (!usable()) out << "; " << verdict.against.front().text();
  return out.str();
}

std::string CameraCalibration::full() const {
  std::ostringstream out;
  out << brief() << "\n";
  for (std::size_t c = 0; c < static_cast<std::size_t>(views.cameras); ++c) {
    out << camera_name(static_cast<int>(c), views.cameras) << ": " << lens_line(*this, c) << "\n";
    write_uncertainty(out, *this, c);
  }
  if (views.cameras == 2) {
    const Pose& T = solution.rig.T_left_right;
    out << "T_left_right: baseline " << readable(1000 * T.translation().norm(), 3) << " +- "
        << readable(1000 * sigma.at("baseline_m"), 3, " mm") << ", turned by "
        << readable(Eigen::AngleAxisd(T.linear()).angle() * 180 / M_PI, 4) << " +- "
        << readable(sigma.at("rotation_deg"), 4, " degrees") << "\n";
    out << "stereo over mono noise: " << readable(stereo_over_mono, 3) << "\n";
  }
  if (warp)
    out << "board warp: " << readable(1000 * solution.rig.warp.x_m, 3) << " along x, "
        << readable(1000 * solution.rig.warp.y_m, 3, " mm") << " along y\n";
  out << (folds == static_cast<int>(views.views.size()) ? "held out: each view in turn\n"
                                                        : "held out: in " + counted(folds, "group") + "\n");
  out << "held out, without " << counted(held_out.rejected_points, "outlier") << ": "
      << readable(held_out.joint_inlier_px, 3);
  if (views.cameras == 2)
    out << " / " << readable(held_out.cross_inlier_px, 3) << " / " << readable(held_out.epipolar_inlier_px, 3);
  out << " px\n";
  if (unseen)
    out << "on " << counted(unseen->views, "view") << " never used: " << readable(unseen->joint_px, 3) << " / "
        << readable(unseen->cross_px, 3) << " / " << readable(unseen->epipolar_px, 3, " px") << "\n";
  out << "corners: " << solution.points << " used, " << solution.rejected.size() << " rejected\n";
  write_lists(out, *this);
  return out.str();
}

}  // namespace foresight
