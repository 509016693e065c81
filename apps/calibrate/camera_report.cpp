#include "apps/calibrate/camera_report.hpp"

#include <opencv2/core.hpp>
#include <sstream>

#include "common/text.hpp"

namespace foresight {
namespace {

std::size_t cameras(const CameraCalibration& c) {
  return static_cast<std::size_t>(c.views.cameras);
}

std::string title(const std::string& name) {
  std::string text = name;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

cv::Mat image_of(const Eigen::MatrixXd& values) {
  cv::Mat image(static_cast<int>(values.rows()), static_cast<int>(values.cols()), CV_64F);
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) image.at<double>(row, col) = values(row, col);
  return image;
}

void add_scores(const CameraCalibration& c, HtmlReport& report) {
  report.heading("Scores");
  std::vector<std::vector<std::string>> rows;
  const auto row = [&](const std::string& name, double value) { rows.push_back({name, readable(value, 4, " px")}); };
  row("in sample, RMS per corner", c.solution.rms_px);
  row("left out, joint", c.held_out.joint_px);
  if (cameras(c) == 2) {
    row("left out, cross", c.held_out.cross_px);
    row("left out, epipolar (mean)", c.held_out.epipolar_px);
  }
  const std::string without = ", without " + std::to_string(c.held_out.rejected_points) + " outliers";
  row("left out, joint" + without, c.held_out.joint_inlier_px);
  if (cameras(c) == 2) {
    row("left out, cross" + without, c.held_out.cross_inlier_px);
    row("left out, epipolar (mean)" + without, c.held_out.epipolar_inlier_px);
  }
  for (std::size_t i = 0; i < cameras(c); ++i)
    row("odd and even views, " + camera_name(static_cast<int>(i), c.views.cameras), c.odd_even_px[i]);
  report.table({"what", "error"}, rows);
}

void add_residuals(const CameraCalibration& c, HtmlReport& report) {
  const RigErrors errors = rig_errors(c.views, c.solution);
  std::vector<HtmlReport::Series> clouds(cameras(c)), places(cameras(c)), by_view(cameras(c));
  for (std::size_t i = 0; i < cameras(c); ++i) {
    const std::string name = camera_name(static_cast<int>(i), c.views.cameras);
    clouds[i].name = places[i].name = by_view[i].name = name;
    for (std::size_t v = 0; v < errors.size(); ++v) {
      double sum = 0;
      const auto& corners = c.views.views[v].corners[i];
      for (std::size_t k = 0; k < corners.size(); ++k) {
        if (!errors[v][i][k].allFinite()) continue;
        clouds[i].points.push_back(errors[v][i][k]);
        places[i].points.push_back(corners[k].pixel);
        sum += errors[v][i][k].squaredNorm();
      }
      if (!corners.empty())
        by_view[i].points.emplace_back(double(v + 1), std::sqrt(sum / static_cast<double>(corners.size())));
    }
  }
  report.heading("Residuals");
  report.plot("Error of every corner, rejected ones included", "x in px", "y in px", clouds, true);
  report.plot("Error of each view", "view", "RMS in px", by_view);
  report.plot("Where the corners were seen", "x in px", "y in px", places, true);
}

void add_maps(const CameraCalibration& c, HtmlReport& report) {
  report.heading("Projection uncertainty");
  report.paragraph("How far the image of a point that stands still would move if all corners were measured again.");
  for (std::size_t i = 0; i < cameras(c); ++i) {
    const CameraModel& model = c.solution.rig.cameras[i];
    const std::string name = title(camera_name(static_cast<int>(i), c.views.cameras));
    report.heat_map(name + ", at infinity", image_of(c.at_infinity[i].px), model.width, model.height, "px");
    report.heat_map(name + ", at " + readable(c.board_distance_m, 2, " m"), image_of(c.at_board[i].px), model.width,
                    model.height, "px");
  }
}

}  // namespace

HtmlReport camera_report(const CameraCalibration& c) {
  HtmlReport report(cameras(c) == 2 ? "Calibration of a stereo pair" : "Calibration of a camera");
  std::istringstream lines(c.full());
  for (std::string line; std::getline(lines, line);) report.paragraph(line);
  add_scores(c, report);
  add_residuals(c, report);
  add_maps(c, report);
  return report;
}

}  // namespace foresight
