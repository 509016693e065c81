#include "texture_gpu/baked_atlas.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"
#include "texture_gpu/skyline_packer.hpp"

namespace foresight {
namespace {

// Level 2 has pixels of 4 px: its filter reaches one of their widths from a point, and that pixel
// is half of one wider.
constexpr int kGuard = 6;
constexpr int kAlign = 4;
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

/// Colours of a chart without alpha; texels without any take those of the nearest that has one.
cv::Mat without_holes(const cv::Mat& bgra) {
  cv::Mat hole(bgra.size(), CV_8U), colours, distance, labels;
  for (int y = 0; y < bgra.rows; ++y)
    for (int x = 0; x < bgra.cols; ++x) hole.at<std::uint8_t>(y, x) = bgra.at<cv::Vec4b>(y, x)[3] < 128 ? 255 : 0;
  cv::cvtColor(bgra, colours, cv::COLOR_BGRA2BGR);
  const int holes = cv::countNonZero(hole);
  if (holes == static_cast<int>(hole.total())) colours.setTo(kNeverSeen);
  if (holes == 0 || holes == static_cast<int>(hole.total())) return colours;
  cv::distanceTransform(hole, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec3b> colour_of(static_cast<std::size_t>(hole.total()) + 1);
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (!hole.at<std::uint8_t>(y, x))
        colour_of[static_cast<std::size_t>(labels.at<int>(y, x))] = colours.at<cv::Vec3b>(y, x);
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (hole.at<std::uint8_t>(y, x))
        colours.at<cv::Vec3b>(y, x) = colour_of[static_cast<std::size_t>(labels.at<int>(y, x))];
  return colours;
}

/// One axis of the map from a pixel of a patch's rectangle to a chart's texels: slope, offset.
struct AxisMap {
  double slope, offset;
};
AxisMap axis_map(double px_per_metre, double uv0, double texels_per_metre, int texels, int texels_after_shrinking) {
  // Pixel p has its centre at (p - kGuard + 0.5) / px_per_metre on the patch's plane.
  const double slope = texels_per_metre / px_per_metre;
  const double offset = ((0.5 - kGuard) / px_per_metre - uv0) * texels_per_metre;
  const double shrink = static_cast<double>(texels_after_shrinking) / texels;
  return {slope * shrink, (offset + 0.5) * shrink - 0.5};
}

/// Resamples a chart into `region` (px) of its patch's rectangle.
void draw_chart(const ChartTexels& texels, const Eigen::Vector2d& density, const cv::Rect& region, cv::Mat& rectangle) {
  cv::Mat colours = without_holes(texels.colours);
  // Sharper than the rectangle: means first, or fine patterns would alias.
  const Eigen::Array2d ratio = density.array() / texels.raster.density.array();
  const auto shrunk = [](int size, double r) {
    return r < 0.95 ? std::max(1, static_cast<int>(std::lround(size * r))) : size;
  };
  const cv::Size size(shrunk(colours.cols, ratio.x()), shrunk(colours.rows, ratio.y()));
  const AxisMap x = axis_map(density.x(), texels.raster.uv0.x(), texels.raster.density.x(), colours.cols, size.width);
  const AxisMap y = axis_map(density.y(), texels.raster.uv0.y(), texels.raster.density.y(), colours.rows, size.height);
  if (size != colours.size()) cv::resize(colours, colours, size, 0, 0, cv::INTER_AREA);
  const cv::Matx23d to_texel(x.slope, 0, x.offset + x.slope * region.x, 0, y.slope, y.offset + y.slope * region.y);
  cv::Mat part;
  cv::warpAffine(colours, part, to_texel, region.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  part.copyTo(rectangle(region));
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

/// Draws all cells of a patch into its rectangle.
void draw_patch(const TextureReadback& textures, const Patch& patch, const Eigen::Vector2d& density,
                cv::Mat rectangle) {
  const Eigen::Vector2d cell_px = patch.cell_size().cwiseProduct(density);
  const std::vector<int> xs = cell_bounds(patch.cells.x(), cell_px.x(), rectangle.cols),
                         ys = cell_bounds(patch.cells.y(), cell_px.y(), rectangle.rows);
  for (int i = 0; i < patch.cells.prod(); ++i) {
    const auto x = static_cast<std::size_t>(i % patch.cells.x()), y = static_cast<std::size_t>(i / patch.cells.x());
    const cv::Rect region(xs[x], ys[y], xs[x + 1] - xs[x], ys[y + 1] - ys[y]);
    if (region.empty()) continue;
    const int chart = patch.first_chart + i;
    if (textures.resolution(chart).x() > 0) {
      draw_chart(*textures.chart(chart), density, region, rectangle);
    } else {
      const cv::Vec4b mean = textures.mean(chart);
      rectangle(region).setTo(mean[3] == 128 ? cv::Vec3b(mean[0], mean[1], mean[2]) : kNeverSeen);
    }
  }
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
  out.colours.convertTo(out.colours, -1, textures.display_gain());
  return out;
}

}  // namespace foresight
