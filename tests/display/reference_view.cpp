#include "tests/display/reference_view.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace foresight::reference {
namespace {

constexpr double kSeen = 1, kHole = 128.0 / 255, kBare = 64.0 / 255;

/// Pixels of the image per texel, of a texel's alpha (atlas.glsl).
double image_px(double alpha) {
  return std::exp2((31 * alpha - 2) * 8 / 29 - 8);
}

}  // namespace

ViewPixel View::at(const Lens& lens, const Pose& T_world_camera, const Eigen::Vector2d& pixel) const {
  const auto cast = [&](const Eigen::Vector2d& at) -> std::optional<RayCaster::Hit> {
    const auto ray = lens.unproject(at);
    return ray ? caster_.cast(T_world_camera.translation(), T_world_camera.linear() * *ray, gl::kNearPlane)
               : std::nullopt;
  };
  const auto hit = cast(pixel);
  ViewPixel out;
  if (hit)
    out = shade(*hit, T_world_camera.linear() * *lens.unproject(pixel),
                std::max(lens.parameters().fx, lens.parameters().fy));
  // The face's pixel that names the triangle lies up to 0.7 face pixels beside the ray.
  for (int i = 0; i < 9; ++i) {
    const auto beside = cast(pixel + 1.5 * Eigen::Vector2d(i % 3 - 1, i / 3 - 1));
    if (beside.has_value() != hit.has_value()) out.borderline = true;
    if (!beside || !hit || beside->triangle == hit->triangle) continue;
    out.borderline = true;
  }
  return out;
}

ViewPixel View::shade(const RayCaster::Hit& hit, const Eigen::Vector3d& ray, double focal_px) const {
  const auto patch_index = static_cast<std::size_t>(surface_.patch_of_triangle[static_cast<std::size_t>(hit.triangle)]);
  const Patch& patch = surface_.patches[patch_index];
  const Pose T_node_world = state_.T_world_node[static_cast<std::size_t>(patch.node)].inverse();
  const Eigen::Vector3d p = T_node_world * hit.p_world - patch.origin;
  const Eigen::Vector2d uv(p.dot(patch.eu), p.dot(patch.ev));
  const Eigen::Vector2d in_cells = uv.cwiseQuotient(patch.cell_size());
  const Eigen::Array2i cell = in_cells.array().floor().cast<int>().max(0).min(patch.cells.array() - 1);
  const auto index = static_cast<std::size_t>(patch.first_chart + cell.y() * patch.cells.x() + cell.x());
  const ChartCopy& chart = generation_.charts[index];

  ViewPixel out;
  // Between two charts either one is right.
  out.borderline = (in_cells - in_cells.array().round().matrix()).cwiseAbs().minCoeff() < 1e-4;
  const auto with = [&](Eigen::Vector3d rgb, double alpha) {
    rgb = (rgb * static_cast<double>(generation_.display_gain)).cwiseMin(1);
    out.rgba << rgb, alpha;
    return out;
  };
  Eigen::Vector4d fallback = generation_.means[index];
  if (chart.density.x() > 0) {
    const Eigen::Vector2d texel = (uv - chart.uv0).cwiseProduct(chart.density);
    const Eigen::Vector3d sight = (T_node_world.linear() * ray).normalized();
    const auto across = [&](const Eigen::Vector3d& e) { return (e - sight * sight.dot(e)).norm(); };
    const double pixels = focal_px * std::max(across(chart.eu), across(chart.ev)) / (hit.t * ray.norm());
    const double lod = std::clamp(-std::log2(pixels), 0.0, 4.0);
    const int level = static_cast<int>(std::floor(lod + 0.15));
    out.borderline |= std::abs(lod + 0.15 - std::round(lod + 0.15)) < 1e-3;

    Eigen::Vector4d seen(0, 0, 0, 0), filled(0, 0, 0, 0);
    double quality = 0;
    const Eigen::Vector2d at = (texel + Eigen::Vector2d(0.5, 0.5)) / (1 << level) - Eigen::Vector2d(0.5, 0.5);
    const auto fetch = [&](const Eigen::Vector2i& t) { return texel_of(generation_, pixels_, chart, level, t); };
    bilinear(at, [&](const Eigen::Vector2i& t, double weight) {
      const Eigen::Vector4d c = fetch(t);
      const double code = 31 * c.w(), share = code < 1.5 ? 0 : level == 0 ? 1 : c.w();
      const Eigen::Vector4d opaque(c.x(), c.y(), c.z(), 1);
      seen += weight * share * opaque;
      quality += weight * share * c.w();
      if (code > 0.5) filled += weight * (1 - share) * opaque;
    });
    if (const auto sharp = level <= 2 ? cubic(at, level, fetch) : std::nullopt) {
      // Pixels of the image, as an image saw the texels of level 0, for one here.
      const double finer = (level == 0 ? image_px(quality) : 1) / (pixels * (1 << level));
      const double share =
          std::min<double>(generation_.sharp, std::max(generation_.sharp - 6 * 0.36 * (finer * finer - 1), -1.0));
      seen.head<3>() = ((1 - share) * seen.head<3>() + share * *sharp).cwiseMax(0).cwiseMin(1);
      const Eigen::Array2d middle = at.array() + 0.5;
      out.borderline |= (middle - middle.round()).abs().minCoeff() < 1e-3;  // between two rows or columns
    }
    out.borderline |= std::abs(seen.w() - 0.25) < 1e-3;
    if (seen.w() >= 0.25) return with(seen.head<3>() / seen.w(), kSeen);
    const Eigen::Vector4d all = seen + filled;
    if (all.w() > 0) {
      out.borderline |= all.w() < 1e-3;
      return with(all.head<3>() / all.w(), kHole);
    }
    fallback = coarse(chart, index, texel);
  }
  return fallback.w() > 0 ? with(fallback.head<3>(), kHole) : with({0, 0, 0}, kBare);
}

/// What stands in for pages without texels: their means, between the centres of the pages.
Eigen::Vector4d View::coarse(const ChartCopy& chart, std::size_t index, const Eigen::Vector2d& texel) const {
  Eigen::Vector4d sum(0, 0, 0, 0);
  bilinear((texel + Eigen::Vector2d(0.5, 0.5)) / 16 - Eigen::Vector2d(0.5, 0.5),
           [&](const Eigen::Vector2i& at, double weight) {
             const Eigen::Array2i page = at.array().max(0).min(chart.pages.array() - 1);
             const Eigen::Vector4d c =
                 generation_.coarse[static_cast<std::size_t>(chart.first_page + page.y() * chart.pages.x() + page.x())];
             sum += weight * c.w() * Eigen::Vector4d(c.x(), c.y(), c.z(), 1);
           });
  return sum.w() > 0 ? (sum / sum.w()).eval() : generation_.means[index];
}

}  // namespace foresight::reference
