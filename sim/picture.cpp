#include "sim/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "common/parallel.hpp"
#include "sim/lamp.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int kBlock = 64;       // px; a block holds whole tiles
constexpr int kTilePixels = 64;  // 8 x 8, or 64 x 1 where a row has its own instant
constexpr int kSide = Renderer::kSide, kRays = kTilePixels * kSide * kSide;
constexpr int kCentre = kSide * kSide / 2;  // the ray through the pixel's centre
static_assert(kSide % 2 == 1);
constexpr float kPerSide = 1.0f / kSide, kPerPixel = kPerSide * kPerSide;

// A facet in the camera frame, as its three edge planes through the eye. A ray d = (x, y, 1) meets
// it where all weights w_k = edge_k . d are >= 0; w_k / (w_0 + w_1 + w_2) is then the barycentric
// weight of corner k and (w_0 + w_1 + w_2) * scale the inverse depth. Neighbours compute a shared
// edge as exactly opposite planes, so no ray slips between them.
struct View {
  const Facet* facet;
  int index, part;
  std::array<Vector3f, 3> edges;
  float scale;
};

struct Window {  // a rectangle of directions
  Vector2f low = Vector2f::Constant(std::numeric_limits<float>::infinity()), high = -low;
};

struct TileRays {
  std::array<float, kRays> x, y, inverse_depth;
  std::array<std::int32_t, kRays> view;
};

std::vector<View> views_of(const Lab& lab, const Pose& T_world_camera, const LabState& T_world_part) {
  std::vector<View> out;
  int index = 0;
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k) {
    const Part& part = lab.parts[k];
    const Pose T_camera_part = T_world_camera.inverse() * T_world_part[static_cast<std::size_t>(k)];
    for (const Facet& f : part.facets) {
      std::array<Eigen::Vector3d, 3> v;
      for (int i = 0; i < 3; ++i) v[i] = T_camera_part * f.corners[i].p.cast<double>();
      const double volume = v[0].dot(v[1].cross(v[2]));
      if (volume < 0)  // else seen from behind: all solids are closed
        out.push_back(
            {&f,
             index,
             k,
             {-v[1].cross(v[2]).cast<float>(), -v[2].cross(v[0]).cast<float>(), -v[0].cross(v[1]).cast<float>()},
             static_cast<float>(-1 / volume)});
      ++index;
    }
  }
  return out;
}

Window window_of(const RayTable& rays, const cv::Rect& pixels) {
  Window w;
  for (int row = pixels.y; row <= pixels.br().y; ++row)
    for (int column = pixels.x; column <= pixels.br().x; ++column) {
      const Vector2f& d = rays.corner(column, row);
      if (!d.allFinite()) continue;
      w.low = w.low.cwiseMin(d);
      w.high = w.high.cwiseMax(d);
    }
  return w;
}

bool may_meet(const View& view, const Window& w) {
  return std::all_of(view.edges.begin(), view.edges.end(), [&](const Vector3f& e) {
    return e.x() * (e.x() > 0 ? w.high.x() : w.low.x()) + e.y() * (e.y() > 0 ? w.high.y() : w.low.y()) + e.z() >= 0;
  });
}

std::vector<int> narrow(const std::vector<View>& views, const std::vector<int>& from, const Window& w) {
  std::vector<int> out;
  for (int i : from)
    if (may_meet(views[i], w)) out.push_back(i);
  return out;
}

// Rays are ordered by pixel (row by row), then by place within the pixel.
void aim(const RayTable& rays, const cv::Rect& tile, TileRays& out) {
  out.x.fill(std::numeric_limits<float>::quiet_NaN());
  out.y = out.x;
  for (int r = 0; r < tile.height; ++r)
    for (int c = 0; c < tile.width; ++c) {
      const Vector2f &a = rays.corner(tile.x + c, tile.y + r), &b = rays.corner(tile.x + c + 1, tile.y + r);
      const Vector2f &e = rays.corner(tile.x + c, tile.y + r + 1), &f = rays.corner(tile.x + c + 1, tile.y + r + 1);
      int k = (r * tile.width + c) * kSide * kSide;
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i, ++k) {
          const float u = (static_cast<float>(i) + 0.5f) * kPerSide, v = (static_cast<float>(j) + 0.5f) * kPerSide;
          const Vector2f d = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * e + u * f);
          out.x[k] = d.x();
          out.y[k] = d.y();
        }
      const Vector2f& centre = rays.centre(tile.x + c, tile.y + r);
      k += kCentre - kSide * kSide;
      out.x[k] = centre.x();
      out.y[k] = centre.y();
    }
  out.inverse_depth.fill(0);
  out.view.fill(-1);
}

// Branch-free over a fixed count, so that the compiler turns it into vector instructions.
void meet(const View& view, int index, TileRays& rays) {
  const auto [e0, e1, e2] = view.edges;
  for (int k = 0; k < kRays; ++k) {
    const float x = rays.x[k], y = rays.y[k];
    const float w0 = e0.x() * x + e0.y() * y + e0.z();
    const float w1 = e1.x() * x + e1.y() * y + e1.z();
    const float w2 = e2.x() * x + e2.y() * y + e2.z();
    const float inverse = (w0 + w1 + w2) * view.scale;
    const bool nearer = (w0 >= 0) & (w1 >= 0) & (w2 >= 0) & (inverse > rays.inverse_depth[k]);
    rays.inverse_depth[k] = nearer ? inverse : rays.inverse_depth[k];
    rays.view[k] = nearer ? index : rays.view[k];
  }
}

// Shades the rays of one pixel. The light changes slowly, so one look-up per facet and pixel will do.
class PixelShader {
 public:
  PixelShader(const Lab& lab, const LightMap& light, const LightMap::Irradiance& irradiance, const Pose& T_world_camera,
              const LabState& T_world_part, float pixel_angle)
      : lab_(lab),
        light_(light),
        irradiance_(irradiance),
        T_world_camera_(T_world_camera.cast<float>()),
        footprint_(pixel_angle * kPerSide) {
    for (const Pose& T : T_world_part) rotations_.push_back(T.linear().cast<float>());
  }

  Vector3f shade(const std::vector<View>& views, const TileRays& rays, int first) {
    Vector3f sum = Vector3f::Zero();
    int known = -1;
    for (int k = first; k < first + kSide * kSide; ++k) {
      if (rays.view[k] < 0) continue;
      const View& view = views[rays.view[k]];
      const Vector3f d(rays.x[k], rays.y[k], 1);
      const Vector3f w(view.edges[0].dot(d), view.edges[1].dot(d), view.edges[2].dot(d));
      const Vector3f b = w / w.sum();
      const Material& material = lab_.materials[view.facet->material];
      if (known != rays.view[k]) {
        known = rays.view[k];
        illuminate(view, material, b, d / rays.inverse_depth[k]);
      }
      const auto& c = view.facet->corners;
      const Vector2f uv = b[0] * c[0].uv + b[1] * c[1].uv + b[2] * c[2].uv;
      sum += material.picture.sample(uv, footprint_ / rays.inverse_depth[k]).cwiseProduct(light_here_) + mirror_here_;
    }
    return sum * kPerPixel;
  }

 private:
  void illuminate(const View& view, const Material& material, const Vector3f& b, const Vector3f& p_camera) {
    light_here_ = light_.at(irradiance_, view.index, b[1], b[2]) * std::numbers::inv_pi_v<float>;
    mirror_here_.setZero();
    if (material.gloss == 0) return;
    const auto& c = view.facet->corners;
    Vector3f n = b[0] * c[0].n + b[1] * c[1].n + b[2] * c[2].n;
    n = rotations_[view.part] * n;
    const Vector3f p = T_world_camera_ * p_camera;
    const Vector3f to_eye = (T_world_camera_.translation() - p).normalized();
    mirror_here_.setConstant(10 * material.gloss * lamp::mirrored(p, n.normalized(), to_eye));
  }

  const Lab& lab_;
  const LightMap& light_;
  const LightMap::Irradiance& irradiance_;
  Eigen::Isometry3f T_world_camera_;
  std::vector<Eigen::Matrix3f> rotations_;  // of each part into the world
  float footprint_;                         // metres between rays at one metre
  Vector3f light_here_ = Vector3f::Zero(), mirror_here_ = Vector3f::Zero();
};

// (x / z, y / z) at pixels (column + offset, row + offset).
std::vector<Vector2f> table(const Lens& lens, int columns, int rows, double offset) {
  std::vector<Vector2f> out(static_cast<std::size_t>(columns) * rows,
                            Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
    for (int column = 0; column < columns; ++column) {
      const auto ray = lens.unproject({column + offset, static_cast<double>(row) + offset});
      if (ray && ray->z() > 0.02) out[row * columns + column] = (ray->head<2>() / ray->z()).cast<float>();
    }
  });
  return out;
}

}  // namespace

RayTable::RayTable(const Lens& lens)
    : width_(lens.width()),
      height_(lens.height()),
      pixel_angle_(static_cast<float>(1 / lens.parameters().fx)),
      corners_(table(lens, width_ + 1, height_ + 1, -0.5)),
      centres_(table(lens, width_, height_, 0)) {}

Picture::Picture(cv::Size size)
    : light(size, CV_32FC3, cv::Scalar::all(0)),
      depth(size, CV_32FC1, cv::Scalar::all(0)),
      facet(size, CV_32SC1, cv::Scalar::all(-1)) {}

void Renderer::render(const RayTable& rays, const Pose& T_world_camera, const LabState& T_world_part,
                      const LightMap::Irradiance& irradiance, int first_row, int end_row, Picture& out) const {
  const std::vector<View> views = views_of(lab_, T_world_camera, T_world_part);
  PixelShader shader(lab_, light_, irradiance, T_world_camera, T_world_part, rays.pixel_angle());
  std::vector<int> all(views.size());
  std::iota(all.begin(), all.end(), 0);

  TileRays tile_rays;
  const cv::Rect whole(0, first_row, rays.width(), end_row - first_row);
  const cv::Size size = whole.height < 8 ? cv::Size(kTilePixels, 1) : cv::Size(8, 8);
  for (int by = first_row; by < end_row; by += kBlock)
    for (int bx = 0; bx < whole.width; bx += kBlock) {
      if (poll_) poll_();
      const cv::Rect block = cv::Rect(bx, by, kBlock, kBlock) & whole;
      const std::vector<int> near = narrow(views, all, window_of(rays, block));
      for (int y = by; y < block.br().y; y += size.height)
        for (int x = bx; x < block.br().x; x += size.width) {
          const cv::Rect tile = cv::Rect(cv::Point(x, y), size) & whole;
          aim(rays, tile, tile_rays);
          for (int i : narrow(views, near, window_of(rays, tile))) meet(views[i], i, tile_rays);
          for (int r = 0; r < tile.height; ++r)
            for (int c = 0; c < tile.width; ++c) {
              const int first = (r * tile.width + c) * kSide * kSide;
              const Vector3f light = shader.shade(views, tile_rays, first);
              out.light.at<cv::Vec3f>(y + r, x + c) = {light.x(), light.y(), light.z()};
              const int view = tile_rays.view[first + kCentre];
              out.facet.at<int>(y + r, x + c) = view < 0 ? -1 : views[view].index;
              out.depth.at<float>(y + r, x + c) = view < 0 ? 0 : 1 / tile_rays.inverse_depth[first + kCentre];
            }
        }
    }
}

Picture Renderer::render(const RayTable& rays, const Pose& T_world_camera, const LabState& T_world_part,
                         const LightMap::Irradiance& irradiance) const {
  Picture out({rays.width(), rays.height()});
  render(rays, T_world_camera, T_world_part, irradiance, 0, rays.height(), out);
  return out;
}

}  // namespace foresight::sim
