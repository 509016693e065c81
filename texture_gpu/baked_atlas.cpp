#include "texture_gpu/baked_atlas.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"
#include "pictures/view_alpha.hpp"
#include "texture_gpu/skyline_packer.hpp"

namespace foresight {
namespace {

// A filter on level 2 takes in, besides the pixel of 4 x 4 px under a point, those next to it.
// Rectangles that start and end between such pixels need one of them as guard.
constexpr int kAlign = 4;
constexpr int kGuard = kAlign;
constexpr double kShrink = 0.97;  // a step of the search for what fits
constexpr double kLeastScale = 1e-3;
const cv::Vec3b kNeverSeen(128, 128, 128);

int aligned(int px) {
  return (px + kAlign - 1) / kAlign * kAlign;
}

/// px per metre of each patch, at full resolution; a patch without texels gets one for each cell.
std::vector<Eigen::Vector2d> full_density(const TextureReadback& textures) {
  std::vector<Eigen::Vector2d> out;
  for (const Patch& patch : textures.surface().patches) {
    Eigen::Vector2d density = patch.cell_size().cwiseInverse();
    for (int i = 0; i < patch.cells.prod(); ++i) density = density.cwiseMax(textures.resolution(patch.first_chart + i));
    out.push_back(density);
  }
  return out;
}

/// Whole pixels over a patch: the density that makes them so is the given one, or a little more.
Eigen::Vector2i inner_size(const Patch& patch, const Eigen::Vector2d& density) {
  return (patch.size.cwiseProduct(density).array() - 1e-6).ceil().max(1).cast<int>();
}

cv::Size outer_size(const Eigen::Vector2i& inner) {
  return {aligned(inner.x() + 2 * kGuard), aligned(inner.y() + 2 * kGuard)};
}

/// 255 where a texel has no colour, else 0.
cv::Mat holes_of(const cv::Mat& bgra) {
  cv::Mat alpha, holes;
  cv::extractChannel(bgra, alpha, 3);
  cv::compare(alpha, view_alpha::kFromFill, holes, cv::CMP_LT);
  return holes;
}

/// Pixels in holes take the colour of the nearest that is in none; where all are, of what was never seen.
void fill(cv::Mat& bgr, const cv::Mat& holes) {
  const int count = cv::countNonZero(holes);
  if (count == 0) return;
  if (count == static_cast<int>(holes.total())) {
    bgr.setTo(kNeverSeen);
    return;
  }
  cv::Mat distance, labels;
  cv::distanceTransform(holes, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec3b> colour_of(holes.total() + 1);
  for (int y = 0; y < holes.rows; ++y)
    for (int x = 0; x < holes.cols; ++x)
      if (!holes.at<std::uint8_t>(y, x))
        colour_of[static_cast<std::size_t>(labels.at<int>(y, x))] = bgr.at<cv::Vec3b>(y, x);
  for (int y = 0; y < holes.rows; ++y)
    for (int x = 0; x < holes.cols; ++x)
      if (holes.at<std::uint8_t>(y, x))
        bgr.at<cv::Vec3b>(y, x) = colour_of[static_cast<std::size_t>(labels.at<int>(y, x))];
}

/// From a pixel of a patch's rectangle to a chart's texels, along one axis.
struct AxisMap {
  double slope, offset;

  /// Pixel p has its centre at (p - kGuard + 0.5) / px_per_metre on the patch's plane.
  AxisMap(double px_per_metre, double uv0, double texels_per_metre)
      : slope(texels_per_metre / px_per_metre), offset(((0.5 - kGuard) / px_per_metre - uv0) * texels_per_metre) {}

  /// The same to a picture of the texels that is smaller by `factor`.
  void shrink(double factor) {
    slope *= factor;
    offset = (offset + 0.5) * factor - 0.5;
  }
};

cv::Mat resampled(const cv::Mat& texels, const AxisMap& x, const AxisMap& y, const cv::Rect& region, int filter,
                  cv::BorderTypes border) {
  const cv::Matx23d to_texel(x.slope, 0, x.offset + x.slope * region.x, 0, y.slope, y.offset + y.slope * region.y);
  cv::Mat out;
  cv::warpAffine(texels, out, to_texel, region.size(), filter | cv::WARP_INVERSE_MAP, border, cv::Scalar::all(255));
  return out;
}

/// Resamples a chart into `region` (px) of its patch's rectangle, and says where it has no surface.
void draw_chart(const ChartTexels& texels, const Eigen::Vector2d& density, const cv::Rect& region, cv::Mat& rectangle,
                cv::Mat& holes) {
  const Eigen::Vector2d& own = texels.raster.density;
  AxisMap x(density.x(), texels.raster.uv0.x(), own.x()), y(density.y(), texels.raster.uv0.y(), own.y());
  const cv::Mat hole = holes_of(texels.colours);
  resampled(hole, x, y, region, cv::INTER_NEAREST, cv::BORDER_CONSTANT).copyTo(holes(region));

  cv::Mat colours;
  cv::cvtColor(texels.colours, colours, cv::COLOR_BGRA2BGR);
  fill(colours, hole);
  // Sharper than the rectangle: means first, or fine patterns would alias.
  const auto shrunk = [](int size, double ratio) {
    return ratio < 0.95 ? std::max(1, static_cast<int>(std::lround(size * ratio))) : size;
  };
  const cv::Size size(shrunk(colours.cols, density.x() / own.x()), shrunk(colours.rows, density.y() / own.y()));
  if (size != colours.size()) {
    x.shrink(static_cast<double>(size.width) / colours.cols);
    y.shrink(static_cast<double>(size.height) / colours.rows);
    cv::resize(colours, colours, size, 0, 0, cv::INTER_AREA);
  }
  resampled(colours, x, y, region, cv::INTER_CUBIC, cv::BORDER_REPLICATE).copyTo(rectangle(region));
}

/// First pixel whose centre lies in each cell along one axis, and the end: outermost cells reach
/// to the rectangle's sides.
std::vector<int> cell_bounds(int cells, double cell_px, int size) {
  std::vector<int> out{0};
  for (int i = 1; i < cells; ++i)
    out.push_back(std::min(size, static_cast<int>(std::ceil(i * cell_px + kGuard - 0.5))));
  out.push_back(size);
  return out;
}

/// Draws all cells of a patch into its rectangle, and continues the surface where it has none.
void draw_patch(const TextureReadback& textures, const Patch& patch, const Eigen::Vector2d& density,
                cv::Mat rectangle) {
  const Eigen::Vector2d cell_px = patch.cell_size().cwiseProduct(density);
  const std::vector<int> xs = cell_bounds(patch.cells.x(), cell_px.x(), rectangle.cols),
                         ys = cell_bounds(patch.cells.y(), cell_px.y(), rectangle.rows);
  cv::Mat holes(rectangle.size(), CV_8U, cv::Scalar(255));
  for (int i = 0; i < patch.cells.prod(); ++i) {
    const auto x = static_cast<std::size_t>(i % patch.cells.x()), y = static_cast<std::size_t>(i / patch.cells.x());
    const cv::Rect region(xs[x], ys[y], xs[x + 1] - xs[x], ys[y + 1] - ys[y]);
    if (region.empty()) continue;
    const int chart = patch.first_chart + i;
    if (textures.resolution(chart).x() > 0) {
      draw_chart(*textures.chart(chart), density, region, rectangle, holes);
    } else if (textures.surface().charts[static_cast<std::size_t>(chart)].radius > 0) {
      const cv::Vec4b mean = textures.mean(chart);
      holes(region).setTo(0);
      rectangle(region).setTo(mean[3] == view_alpha::kFromFill ? cv::Vec3b(mean[0], mean[1], mean[2]) : kNeverSeen);
    }
  }
  fill(rectangle, holes);
}

}  // namespace

Eigen::Vector2d BakedAtlas::texcoord(const SurfacePatches& surface, int index, const Eigen::Vector3d& p_node) const {
  const Patch& patch = surface.patches[static_cast<std::size_t>(index)];
  const Place& place = places[static_cast<std::size_t>(index)];
  const Eigen::Vector3d p = p_node - patch.origin;
  const Eigen::Vector2d uv(p.dot(patch.eu), p.dot(patch.ev));
  return (place.corner + uv.cwiseProduct(place.density)).cwiseQuotient(Eigen::Vector2d(colours.cols, colours.rows));
}

BakedAtlas bake_atlas(const TextureReadback& textures, int most) {
  const std::vector<Patch>& patches = textures.surface().patches;
  const std::vector<Eigen::Vector2d> density = full_density(textures);
  BakedAtlas out;
  std::vector<cv::Size> sizes(patches.size());
  std::optional<std::vector<cv::Point>> corners;
  cv::Size used;
  for (; !corners; out.scale *= corners ? 1 : kShrink) {
    if (out.scale < kLeastScale)
      throw InputError("--max-atlas " + std::to_string(most),
                       "the model's " + std::to_string(patches.size()) + " patches do not fit", "give more");
    for (std::size_t i = 0; i < patches.size(); ++i)
      sizes[i] = outer_size(inner_size(patches[i], out.scale * density[i]));
    corners = pack_skyline(sizes, most / kAlign * kAlign, used);
  }

  out.colours = cv::Mat(aligned(used.height), aligned(used.width), CV_8UC3, kNeverSeen);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Eigen::Vector2d px_per_metre = out.scale * density[i];
    const cv::Rect rectangle((*corners)[i], sizes[i]);
    out.places.push_back({rectangle, Eigen::Vector2d(rectangle.x + kGuard, rectangle.y + kGuard), px_per_metre});
    draw_patch(textures, patches[i], px_per_metre, out.colours(rectangle));
  }
  return out;
}

}  // namespace foresight
