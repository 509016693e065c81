// Published textures, texel by texel on the CPU: for measuring and for writing them to files.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "texture_gpu/chart_raster.hpp"
#include "texture_gpu/published_textures.hpp"

namespace foresight {

/// The texels of one chart. Texel (x, y) has its centre at uv(x, y) on the patch's plane.
///
///     guard guard guard guard        guard: continues the surface for the filter's sake, or is the
///     guard core  core  guard               part of a neighbouring chart that this one overlaps
///     guard core  core  core  <- also counted by no other chart
struct ChartTexels {
  int chart = 0;
  Patch patch;         ///< its plane, and its node
  ChartRaster raster;  ///< its grid and heights
  /// CV_8UC4, BGRA, at the exposure of the newest image, as a display shows them: what is brighter than
  /// its white is cut off. Alpha as in pictures/view_alpha.hpp; kNoModel: no surface. BGR 0 without colour.
  cv::Mat colours;
  /// Row-major: index in the scene of the triangle under a core texel's centre; -1: not core.
  std::vector<int> triangle;

  int width() const { return raster.width; }
  int height() const { return raster.height; }
  int node() const { return patch.node; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(x);
  }

  /// Along u and v, on the patch's plane.
  Eigen::Vector2d metres_per_texel() const { return raster.density.cwiseInverse(); }

  /// Centre of a texel on the patch's plane, metres.
  Eigen::Vector2d uv(double x, double y) const {
    return raster.uv0 + Eigen::Vector2d(x, y).cwiseQuotient(raster.density);
  }

  /// The point that the extraction projected for the texel, in the node's frame, metres. For a core
  /// texel it lies on its triangle, up to the step of 16-bit heights (1/32766 of the chart's
  /// relief); for a guard texel, on the surface as continued. Nothing where there is no surface.
  std::optional<Eigen::Vector3d> point(int x, int y) const;

  /// The texel's centre lies in the chart's own cell and over one of its triangles. Over all charts,
  /// core texels tile the surface: each point of it lies in the core of one chart only.
  bool core(int x, int y) const { return triangle[index(x, y)] >= 0; }
};

/// A copy of one generation. Construct it on a thread with a context of the textures' share group,
/// while they are leased; from then on it needs neither, and is safe to share.
class TextureReadback {
 public:
  /// Waits for the GPU; reads the layers of the atlas that hold pages of this generation.
  /// `surface`: what the textures were made for.
  TextureReadback(const PublishedTextures& textures, std::shared_ptr<const SurfacePatches> surface);

  const SurfacePatches& surface() const { return *surface_; }

  /// Nothing for a chart that never came into view: mean() stands in for it.
  std::optional<ChartTexels> chart(int index) const;

  /// Texels per metre along u and v of a chart that has pages with colours; 0 for any other.
  Eigen::Vector2d resolution(int index) const;

  /// Mean colour of a chart, handed on from its neighbours where it was never seen: BGR as
  /// ChartTexels::colours, alpha kFromFill; all 0 but alpha kBare where there is none.
  cv::Vec4b mean(int index) const;

 private:
  struct Page {
    std::uint32_t slot;
    cv::Vec4b coarse;
  };
  cv::Vec4b stored(std::uint32_t slot, int x, int y) const;
  cv::Vec4b stand_in(int chart, const Page* pages, const Eigen::Vector2i& size, int x, int y) const;

  std::shared_ptr<const SurfacePatches> surface_;
  std::vector<ChartPlace> places_;
  std::vector<Page> pages_;
  std::vector<cv::Vec4b> means_;
  std::vector<cv::Mat_<cv::Vec4b>> layers_;  // BGRA; empty where no page of the generation lies in it
};

}  // namespace foresight
