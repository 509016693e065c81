#include "calibration/result/frame_drawing.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/svg_plot.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kWidth = 640, kHeight = 460, kMargin = 46;
constexpr double kAzimuth = -0.95, kElevation = 0.42;  // rad: the eye is before, to the right and above
constexpr const char* kAxes[] = {"ax", "ay", "az"};    // classes: red, green, blue

// Right and down on paper.
Eigen::Vector2d on_paper(const Eigen::Vector3d& p) {
  const Eigen::Vector3d right(-std::sin(kAzimuth), std::cos(kAzimuth), 0);
  const Eigen::Vector3d to_eye(std::cos(kElevation) * std::cos(kAzimuth), std::cos(kElevation) * std::sin(kAzimuth),
                               std::sin(kElevation));
  const Eigen::Vector3d up = to_eye.cross(right);
  return {right.dot(p), -up.dot(p)};
}

double round_step(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= length) return factor * power;
  return 10 * power;
}

}  // namespace

void FrameDrawing::line(const std::vector<Eigen::Vector3d>& points, const std::string& css_class, bool closed) {
  lines_.push_back({points, css_class, 1.5, closed});
}

void FrameDrawing::dot(const Eigen::Vector3d& point, const std::string& css_class) {
  dots_.emplace_back(point, css_class);
}

void FrameDrawing::frame(const std::string& name, const Pose& T, double size) {
  for (int axis = 0; axis < 3; ++axis)
    lines_.push_back({{T.translation(), T * Eigen::Vector3d(size * Eigen::Vector3d::Unit(axis))},
                      kAxes[axis],
                      name.empty() ? 1.2 : 2.6,
                      false});
  if (!name.empty()) words_.push_back({T.translation(), name});
}

void FrameDrawing::camera(const std::string& name, const Pose& T, double tan_x, double tan_y, double depth) {
  std::vector<Eigen::Vector3d> corners;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    corners.push_back(T * Eigen::Vector3d(depth * x * tan_x, depth * y * tan_y, depth));
  for (const Eigen::Vector3d& corner : corners) line({T.translation(), corner}, "k1");
  line(corners, "k1", true);
  if (!name.empty()) words_.push_back({T.translation(), name});
}

std::string FrameDrawing::svg(const std::string& label) const {
  Eigen::AlignedBox3d box;
  for (const Line& line : lines_)
    for (const Eigen::Vector3d& p : line.points) box.extend(p);
  for (const auto& [p, css] : dots_) box.extend(p);
  if (box.isEmpty()) return "";
  const double step = round_step(std::max(1e-3, box.sizes().head<2>().maxCoeff()) / 6);
  const Eigen::Array2d low = (box.min().head<2>().array() / step).floor() * step,
                       high = (box.max().head<2>().array() / step).ceil() * step;
  std::vector<Line> all;  // the grid first
  const double floor = box.min().z();
  for (double x = low.x(); x < high.x() + step / 2; x += step)
    all.push_back({{{x, low.y(), floor}, {x, high.y(), floor}}, "grid", 1, false});
  for (double y = low.y(); y < high.y() + step / 2; y += step)
    all.push_back({{{low.x(), y, floor}, {high.x(), y, floor}}, "grid", 1, false});

  all.insert(all.end(), lines_.begin(), lines_.end());
  Eigen::AlignedBox2d paper;
  for (const Line& line : all)
    for (const Eigen::Vector3d& p : line.points) paper.extend(on_paper(p));
  const double scale = std::min((kWidth - 2 * kMargin) / std::max(1e-6, paper.sizes().x()),
                                (kHeight - 2 * kMargin) / std::max(1e-6, paper.sizes().y()));
  const auto place = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector2d q = scale * (on_paper(p) - paper.center());
    return Eigen::Vector2d(kWidth / 2 + q.x(), kHeight / 2 + q.y());
  };
  std::string out = fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">", kWidth, kHeight,
                                escape_html(label));
  for (const Line& line : all) {
    out += line.closed ? "<polygon" : "<polyline";
    out += fmt::format(" class=\"frame3 {}\" stroke-width=\"{:.1f}\" points=\"", line.css_class, line.width);
    for (const Eigen::Vector3d& p : line.points) out += fmt::format("{:.1f},{:.1f} ", place(p).x(), place(p).y());
    out += "\"/>";
  }
  for (const auto& [p, css] : dots_)
    out += fmt::format("<circle class=\"dot {}\" r=\"2.6\" cx=\"{:.1f}\" cy=\"{:.1f}\"/>", css, place(p).x(),
                       place(p).y());
  std::vector<Eigen::Vector2d> taken;
  for (const Word& word : words_) {
    Eigen::Vector2d at = place(word.at) + Eigen::Vector2d(7, 16);
    while (std::any_of(taken.begin(), taken.end(), [&](const Eigen::Vector2d& other) {
      return std::abs(other.x() - at.x()) < 90 && std::abs(other.y() - at.y()) < 14;
    }))
      at.y() += 14;
    taken.push_back(at);
    out += fmt::format("<text class=\"m-strong\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", at.x(), at.y(),
                       escape_html(word.text));
  }
  out += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\">grid: {} m; x red, y green, z blue</text>", 8.0, kHeight - 8,
                     readable(step, step < 0.1 ? 2 : 1));
  return out + "</svg>";
}

}  // namespace foresight
