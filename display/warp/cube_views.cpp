#include "display/warp/cube_views.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

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

/// m; of what no model shows: endless.
double nearest_of(const WarpLayers& layers) {
  std::vector<Eigen::Vector4f> blocks(static_cast<std::size_t>(layers.blocks.width()) *
                                      static_cast<std::size_t>(layers.blocks.height()));
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glGetTextureImage(layers.blocks.name(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(blocks.size() * sizeof(Eigen::Vector4f)), blocks.data());
  float most = 0;  // 1/m
  for (const Eigen::Vector4f& block : blocks) most = std::max(most, block.x());
  return most > 0 ? 1.0 / static_cast<double>(most) : std::numeric_limits<double>::infinity();
}

}  // namespace

CubeViews::CubeViews(std::shared_ptr<const WarpScene> scene, const Lens& target, std::vector<double> borders)
    : target_(target),
      face_lens_(lens_of_faces(target)),
      borders_(std::move(borders)),
      warp_(std::move(scene), target),
      shells_(borders_.size() + 1) {
  const bool ascends = std::ranges::adjacent_find(borders_, std::greater_equal()) == borders_.end();
  if (!ascends || (!borders_.empty() && borders_.front() < kNearestBorder))
    throw std::invalid_argument("borders of shells that do not ascend, or are too near");
}

Pose CubeViews::T_world_face(int side, const Pose& T_world_camera) {
  Pose out = Pose::Identity();
  out.translation() = T_world_camera.translation();
  out.linear() = gl::Faces::rotation(side).transpose();
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

double CubeViews::may_move(std::size_t shell) const {
  return shell == 0 ? kFarthest : kFarthest * std::max(1.0, borders_[shell - 1] / kNear);
}

gl::ViewPart CubeViews::part(std::size_t shell) const {
  gl::ViewPart out;
  if (shell > 0) out.nearest = borders_[shell - 1] - may_move(shell - 1) - may_move(shell);
  if (shell < borders_.size()) out.farthest = borders_[shell];
  return out;
}

// A viewer who goes past something that is near, or through it, sees what no pixel of the face shows.
bool CubeViews::serves(Kept& face, std::size_t shell, const Pose& T_world_camera) const {
  if (!face.is_new) return false;
  if (!face.nearest) face.nearest = nearest_of(*face.layers);
  const double gone = (face.layers->T_world_camera.translation() - T_world_camera.translation()).norm();
  return gone < (*face.nearest < kNear ? std::min(kShare * *face.nearest, may_move(shell)) : may_move(shell));
}

std::optional<CubeViews::Face> CubeViews::missing(const Pose& T_world_camera) {
  const std::array<int, kFaces> rays = seen_by(T_world_camera);
  for (std::size_t shell = 0; shell < shells_.size(); ++shell) {
    int most = 0;
    Face out{0, shell};
    for (int side = 0; side < kFaces; ++side) {
      const auto i = static_cast<std::size_t>(side);
      if (rays[i] <= most || serves(shells_[shell][i], shell, T_world_camera)) continue;
      most = rays[i];
      out.side = side;
    }
    if (most > 0) return out;
  }
  return std::nullopt;
}

WarpLayers& CubeViews::layers(const Face& face) {
  Kept& kept = shells_[face.shell][static_cast<std::size_t>(face.side)];
  if (!kept.layers) kept.layers.emplace(face_lens_, face.shell + 1 < shells_.size());
  kept.is_new = true;
  kept.nearest.reset();
  return *kept.layers;
}

void CubeViews::changed() {
  ++changes_;
  for (std::size_t shell = 0; shell < shells_.size() && changes_ % (1U << shell) == 0; ++shell)
    for (Kept& face : shells_[shell]) face.is_new = false;
}

void CubeViews::forget() {
  for (auto& shell : shells_)
    for (Kept& face : shell) face.is_new = false;
}

const gl::Texture& CubeViews::operator()(const Pose& T_world_camera, std::span<const Pose> T_world_node) {
  const std::array<int, kFaces> rays = seen_by(T_world_camera);
  warp_.clear();
  for (auto& shell : shells_)
    for (std::size_t i = 0; i < shell.size(); ++i)
      if (rays[i] > 0 && shell[i].layers) warp_.add(*shell[i].layers, T_world_camera, T_world_node);
  return warp_.picture();
}

}  // namespace foresight
