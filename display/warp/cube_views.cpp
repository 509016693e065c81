#include "display/warp/cube_views.hpp"

#include <algorithm>
#include <cmath>

#include "gl/faces.hpp"

namespace foresight {
namespace {

constexpr int kRays = 25;  // along each side of a view, to tell what it sees: closer than a guard is wide

Lens lens_of_faces(const Lens& target) {
  const double f = target.parameters().fx, half = std::tan(EIGEN_PI / 4 + CubeViews::kGuard);
  Lens::Parameters p;
  p.width = p.height = 2 * static_cast<int>(std::ceil(f * half));
  p.fx = p.fy = f;
  p.cx = p.cy = (p.width - 1) / 2.0;
  return Lens(p);
}

}  // namespace

CubeViews::CubeViews(std::shared_ptr<const WarpScene> scene, const Lens& target)
    : target_(target), face_lens_(lens_of_faces(target)), warp_(std::move(scene), target) {}

Pose CubeViews::T_world_face(int face, const Pose& T_world_camera) {
  Pose out = Pose::Identity();
  out.translation() = T_world_camera.translation();
  out.linear() = gl::Faces::rotation(face).transpose();
  return out;
}

std::array<int, CubeViews::kFaces> CubeViews::seen_by(const Pose& T_world_camera) const {
  std::array<int, kFaces> rays{};
  for (int y = 0; y < kRays; ++y)
    for (int x = 0; x < kRays; ++x) {
      const Eigen::Vector2d pixel(x * (target_.width() - 1.0) / (kRays - 1),
                                  y * (target_.height() - 1.0) / (kRays - 1));
      const Eigen::Vector3d ray = T_world_camera.linear() * *target_.unproject(pixel);
      const auto ahead = [&](int face) { return (gl::Faces::rotation(face) * ray).z(); };
      int face = 0;
      for (int other = 1; other < kFaces; ++other)
        if (ahead(other) > ahead(face)) face = other;
      ++rays[static_cast<std::size_t>(face)];
    }
  return rays;
}

std::optional<int> CubeViews::missing(const Pose& T_world_camera) const {
  const std::array<int, kFaces> rays = seen_by(T_world_camera);
  std::optional<int> out;
  for (int face = 0; face < kFaces; ++face) {
    const auto i = static_cast<std::size_t>(face);
    const auto& layers = faces_[i];
    const bool there =
        layers && (layers->T_world_camera.translation() - T_world_camera.translation()).norm() < kFarthest;
    if (rays[i] > 0 && !there && (!out || rays[i] > rays[static_cast<std::size_t>(*out)])) out = face;
  }
  return out;
}

WarpLayers& CubeViews::layers(int face) {
  auto& out = faces_[static_cast<std::size_t>(face)];
  if (!out) out.emplace(face_lens_);
  return *out;
}

void CubeViews::forget() {
  for (auto& face : faces_) face.reset();
}

const gl::Texture& CubeViews::operator()(const Pose& T_world_camera, std::span<const Pose> T_world_node) {
  const std::array<int, kFaces> rays = seen_by(T_world_camera);
  warp_.clear();
  for (std::size_t i = 0; i < faces_.size(); ++i)
    if (rays[i] > 0 && faces_[i]) warp_.add(*faces_[i], T_world_camera, T_world_node);
  return warp_.picture();
}

}  // namespace foresight
