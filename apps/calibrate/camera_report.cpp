#include "apps/calibrate/camera_report.hpp"

#include <opencv2/core.hpp>
#include <sstream>

#include "apps/calibrate/view_pictures.hpp"
#include "calibration/camera/camera_result.hpp"
#include "calibration/result/frame_drawing.hpp"
#include "common/counted.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostCameraPictures = 28;

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
  if (c.cameras() == 2) {
    row("left out, cross", c.held_out.cross_px);
    row("left out, epipolar (mean)", c.held_out.epipolar_px);
  }
  const std::string without = ", without " + counted(c.held_out.rejected_points, "outlier");
  row("left out, joint" + without, c.held_out.joint_inlier_px);
  if (c.cameras() == 2) {
    row("left out, cross" + without, c.held_out.cross_inlier_px);
    row("left out, epipolar (mean)" + without, c.held_out.epipolar_inlier_px);
  }
  for (std::size_t i = 0; i < c.cameras(); ++i)
    row("odd and even views, " + camera_name(static_cast<int>(i), c.views.cameras), c.odd_even_px[i]);
  report.table({"what", "error"}, rows);
}

std::vector<int> numbers_of(const CameraCalibration& c) {
  std::vector<std::string> names;
  for (const RigView& view : c.views.views) names.push_back(view.name);
  return view_numbers(names);
}

double rms_of(const std::vector<Eigen::Vector2d>& errors) {
  double sum = 0, count = 0;
  for (const Eigen::Vector2d& error : errors)
    if (error.allFinite()) sum += error.squaredNorm(), ++count;
  return std::sqrt(sum / std::max(1.0, count));
}

void add_residuals(const CameraCalibration& c, const RigErrors& errors, HtmlReport& report) {
  const std::vector<int> number = numbers_of(c);
  std::vector<HtmlReport::Series> clouds(c.cameras()), by_view(c.cameras());
  for (std::size_t i = 0; i < c.cameras(); ++i) {
    clouds[i].name = by_view[i].name = camera_name(static_cast<int>(i), c.views.cameras);
    for (std::size_t v = 0; v < errors.size(); ++v) {
      for (const Eigen::Vector2d& error : errors[v][i])
        if (error.allFinite()) clouds[i].points.push_back(error);
      if (!errors[v][i].empty()) by_view[i].points.emplace_back(number[v], rms_of(errors[v][i]));
    }
  }
  report.heading("Residuals");
  report.plot("Error of every corner, rejected ones included", "x in px", "y in px", clouds, true);
  report.plot("Error of each view", "view", "RMS in px", by_view);
}

void add_coverage(const CameraCalibration& c, HtmlReport& report) {
  report.heading("Coverage");
  report.paragraph("Every corner that was seen, in the whole image. Where none was, the lens is not known.");
  for (std::size_t i = 0; i < c.cameras(); ++i) {
    HtmlReport::Series places{camera_name(static_cast<int>(i), c.views.cameras), {}, false};
    for (const RigView& view : c.views.views)
      for (const Corner& corner : view.corners[i]) places.points.push_back(corner.pixel);
    report.places(title(places.name), {places}, c.views.width[i], c.views.height[i]);
  }
}

/// The left camera looks along the drawing's x.
void add_drawing(const CameraCalibration& c, HtmlReport& report) {
  const CameraRig& rig = c.solution.rig;
  Pose T_drawing_left = Pose::Identity();
  T_drawing_left.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const KnownBoard board(c.views.p_board, {});
  const Eigen::Vector2d size = board.extent_m;
  const double depth = 0.2 * c.board_distance_m;
  FrameDrawing drawing;
  for (const Pose& T_left_board : c.solution.T_left_board) {
    const Pose T = T_drawing_left * T_left_board;
    drawing.line({T * Eigen::Vector3d::Zero(), T * Eigen::Vector3d(size.x(), 0, 0),
                  T * Eigen::Vector3d(size.x(), size.y(), 0), T * Eigen::Vector3d(0, size.y(), 0)},
                 "k5", true);
  }
  for (std::size_t i = 0; i < c.cameras(); ++i) {
    const CameraModel& model = rig.cameras[i];
    const Pose T = i == 0 ? T_drawing_left : Pose(T_drawing_left * rig.T_left_right);
    drawing.frame(camera_name(static_cast<int>(i), c.views.cameras), T, 0.6 * depth);
    drawing.camera("", T, model.width / (2 * model.lens[0]), model.height / (2 * model.lens[1]), depth);
  }
  report.heading("Where everything stood");
  report.drawing("Cameras, and the board in each view", drawing.svg("cameras and boards in space"));
}

void add_pictures(const CameraCalibration& c, const RigErrors& errors, const PicturesOfViews& files,
                  HtmlReport& report) {
  const std::vector<int> number = numbers_of(c);
  std::vector<HtmlReport::Picture> pictures;
  for (const std::size_t v : some_of(errors.size(), kMostCameraPictures / c.cameras())) {
    const RigView& view = c.views.views[v];
    const auto found = files.find(view.name);
    for (std::size_t i = 0; found != files.end() && i < c.cameras(); ++i) {
      if (found->second[i].empty() || view.corners[i].empty()) continue;
      std::vector<ShownPoint> points;
      for (std::size_t k = 0; k < view.corners[i].size(); ++k)
        points.push_back({view.corners[i][k].pixel, view.corners[i][k].pixel + errors[v][i][k]});
      const std::string side = c.cameras() == 2 ? ", " + camera_name(static_cast<int>(i), 2) : "";
      pictures.push_back({draw_view(found->second[i], points), std::to_string(number[v]) + side,
                          view.name + ": " + readable(rms_of(errors[v][i]), 2, " px")});
    }
  }
  if (pictures.empty()) return;
  report.heading("Pictures");
  report.paragraph("Rings: corners as found. Lines: to where the solution has them, " + readable(kArrow, 0) +
                   " times too long.");
  report.pictures(pictures);
}

void add_maps(const CameraCalibration& c, HtmlReport& report) {
  report.heading("Projection uncertainty");
  report.paragraph("How far the image of a point that stands still would move if all corners were measured again.");
  for (std::size_t i = 0; i < c.cameras(); ++i) {
    const CameraModel& model = c.solution.rig.cameras[i];
    const std::string name = title(camera_name(static_cast<int>(i), c.views.cameras));
    report.heat_map(name + ", at infinity", image_of(c.at_infinity[i].px), model.width, model.height, "px");
    report.heat_map(name + ", at " + readable(c.board_distance_m, 2, " m"), image_of(c.at_board[i].px), model.width,
                    model.height, "px");
  }
}

}  // namespace

HtmlReport camera_report(const CameraCalibration& c, const PicturesOfViews& files) {
  const RigErrors errors = rig_errors(c.views, c.solution);
  HtmlReport report(c.cameras() == 2 ? "Calibration of a stereo pair" : "Calibration of a camera");
  std::istringstream lines(c.full());
  for (std::string line; std::getline(lines, line);) report.paragraph(line);
  add_scores(c, report);
  add_residuals(c, errors, report);
  add_coverage(c, report);
  add_drawing(c, report);
  add_maps(c, report);
  add_pictures(c, errors, files, report);
  return report;
}

}  // namespace foresight
