#include "apps/bench/texel_truth.hpp"

#include <cmath>

namespace foresight {
namespace {

constexpr double kWrongPlace = 0.020;    // metres between a texel and what its pixel shows
constexpr double kUnit = 0.002 * 0.002;  // m^2 of a counted texel
constexpr int kSteps = 32, kStep = 8;    // 32 values of a channel, eight apart: rounding cannot mix them up
constexpr int kMark = 100;               // the blue channel of all coded pictures

bool inside(const thesis::Polygon& polygon, const Eigen::Vector3d& p) {
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const Eigen::Vector3d& a = polygon.corners[i];
    const Eigen::Vector3d along = polygon.corners[(i + 1) % polygon.corners.size()] - a;
    if (along.cross(p - a).dot(polygon.normal) < 0) return false;
  }
  return true;
}

}  // namespace

TexelCount& TexelCount::operator+=(const TexelCount& other) {
  right += other.right;
  wrong += other.wrong;
  arm_stray += other.arm_stray;
  return *this;
}

cv::Mat coded_picture(const Lens& lens, int index) {
  const cv::Scalar colour(kMark, index / kSteps * kStep + kStep / 2, index % kSteps * kStep + kStep / 2);
  return cv::Mat(lens.height(), lens.width(), CV_8UC3, colour);
}

int decoded(const cv::Vec4b& bgra) {
  if (std::abs(bgra[0] - kMark) > 2) return -1;
  return bgra[1] / kStep * kSteps + bgra[2] / kStep;
}

TexelJudge::TexelJudge(const RunFolder& run) : run_(run) {
  const auto at = [&](std::size_t i) { return run.state_at(run.frames()[i].left.time).T_world_node; };
  const auto first = at(0);
  moves_.assign(first.size(), false);
  for (std::size_t i = 1; i < run.frames().size(); ++i) {
    const auto now = at(i);
    for (std::size_t node = 0; node < first.size(); ++node)
      moves_[node] = moves_[node] || !now[node].isApprox(first[node], 1e-6);
  }
}

void TexelJudge::judge(const JudgedImage& image, int node, const Eigen::Vector3d& p_node, double area_m2,
                       TexelCount& out) const {
  const auto& T_world_node = image.given.scene.T_world_node;
  const Eigen::Vector3d p = T_world_node[static_cast<std::size_t>(node)] * p_node;
  const auto pixel = run_.lens_left().project(image.given.T_world_camera.inverse() * p);
  const double amount = area_m2 / kUnit;
  std::optional<GroundTruth::Point> shown;
  if (pixel) {
    const int u = static_cast<int>(std::lround(pixel->x())), v = static_cast<int>(std::lround(pixel->y()));
    if (u >= 0 && v >= 0 && u < image.truth.width() && v < image.truth.height()) shown = image.truth.at(u, v);
  }
  const bool right =
      shown && (T_world_node[static_cast<std::size_t>(shown->node)] * shown->p_node - p).norm() <= kWrongPlace;
  (right ? out.right : out.wrong) += amount;
  if (!right && shown && moves_[static_cast<std::size_t>(shown->node)] && !moves_[static_cast<std::size_t>(node)])
    out.arm_stray += amount;
}

TexelCount TexelJudge::count(const TextureReadback& textures, const JudgedImage& image) const {
  TexelCount out;
  const SurfacePatches& surface = textures.surface();
  for (std::size_t i = 0; i < surface.charts.size(); ++i) {
    const auto chart = textures.chart(static_cast<int>(i));
    if (!chart) continue;
    const double texel_m2 = chart->metres_per_texel().prod();
    for (int y = 0; y < chart->height(); ++y)
      for (int x = 0; x < chart->width(); ++x) {
        const cv::Vec4b& colour = chart->colours.at<cv::Vec4b>(y, x);
        if (colour[3] != 255 || !chart->core(x, y) || decoded(colour) != image.code) continue;
        // The texel is square on the patch's plane; the surface on it is larger by 1 / cosine.
        const auto& corners = surface.corners[static_cast<std::size_t>(chart->triangle[chart->index(x, y)])];
        const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
        const double cosine = std::max(0.1, std::abs(normal.dot(chart->patch.n)));
        judge(image, chart->node(), *chart->point(x, y), texel_m2 / cosine, out);
      }
  }
  return out;
}

TexelCount TexelJudge::count(const thesis::PolygonTextures& textures, const JudgedImage& image) const {
  TexelCount out;
  for (std::size_t i = 0; i < textures.polygons().size(); ++i) {
    if (!textures.find(i)) continue;
    const cv::Mat texels = textures.read(i);
    const thesis::PolygonFrame& frame = textures.frame(i);
    const double area = frame.width / frame.s * frame.height / frame.t;
    for (int y = 0; y < texels.rows; ++y)
      for (int x = 0; x < texels.cols; ++x) {
        const cv::Vec4b& colour = texels.at<cv::Vec4b>(y, x);
        if (colour[3] != 255 || decoded(colour) != image.code) continue;
        const Eigen::Vector3d p = frame.at(x + 0.5, y + 0.5);
        if (inside(textures.polygons()[i], p)) judge(image, textures.polygons()[i].node, p, area, out);
      }
  }
  return out;
}

}  // namespace foresight
