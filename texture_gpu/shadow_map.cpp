#include "texture_gpu/shadow_map.hpp"

#include <algorithm>
#include <cmath>

#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

// As in the shaders.
constexpr int kMapSide = 256, kCell = 8, kCells = kMapSide / kCell;
constexpr double kClosest = 0.1;   // metres between lamp and what it lights
constexpr double kWidest = 2.5;    // tangent of half the angle that a map can hold
constexpr double kMostCells = 10;  // by which shadows are looked for beyond their middle

gl::Faces square_face() {
  gl::Faces faces;
  faces.width = faces.height = kMapSide;
  faces.cx = faces.cy = (kMapSide - 1) / 2.0;
  return faces;
}

}  // namespace

ShadowMap::ShadowMap(std::shared_ptr<const gl::SceneBuffers> scene)
    : scene_(scene),
      raster_(std::move(scene), false),
      cells_program_(gl::Program::compute(gl::texture_gpu_shaders(), "shadow_cells.comp")),
      spread_program_(gl::Program::compute(gl::texture_gpu_shaders(), "shadow_spread.comp")),
      moving_(square_face(), false),
      still_(square_face(), false),
      cells_(GL_R32F, kCells, kCells, 0, 1, "shadow cells"),
      spread_(GL_R32F, kCells, kCells, 0, 1, "shadow cells, spread") {
  raster_.leave_out(gl::RasterPass::LeavesOut::out_of_view);
}

/// Turns the lamp to what moves, and chooses a map that holds it all.
bool ShadowMap::aim(const SceneLight& light, const SceneState& state) {
  const auto& boxes = scene_->boxes().box;
  Eigen::AlignedBox3d world;
  std::vector<Eigen::Vector3d> corners;
  double farthest = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].isEmpty()) continue;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d corner =
          state.T_world_node[i] * boxes[i].corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
      farthest = std::max(farthest, (corner - light.lamp.position).norm());
      if (!light.moving[i]) continue;
      world.extend(corner);
      corners.push_back(corner);
    }
  }
  if (corners.empty()) return false;
  lamp_ = light.lamp;
  const Eigen::Vector3d ahead = world.center() - lamp_.position;
  if (!(ahead.norm() > kClosest)) return false;
  T_world_lamp_ = Pose::Identity();
  T_world_lamp_.linear().col(2) = ahead.normalized();
  T_world_lamp_.linear().col(0) = ahead.unitOrthogonal();
  T_world_lamp_.linear().col(1) = T_world_lamp_.linear().col(2).cross(T_world_lamp_.linear().col(0));
  T_world_lamp_.translation() = lamp_.position;
  double widest = 0, nearest = farthest;
  for (const Eigen::Vector3d& corner : corners) {
    const Eigen::Vector3d p = T_world_lamp_.inverse() * corner;
    if (p.z() < kClosest) return false;
    widest = std::max(widest, p.head<2>().cwiseAbs().maxCoeff() / p.z());
    nearest = std::min(nearest, p.z());
  }
  const double rim = lamp_.radius * (1 / nearest - 1 / farthest);
  widest += rim;  // shadows are looked for that far beside what throws them
  if (widest > kWidest) return false;
  moving_.faces.fx = moving_.faces.fy = kMapSide / 2.0 / widest;
  still_.faces = moving_.faces;
  reach_ = rim * moving_.faces.fx;
  return true;
}

bool ShadowMap::update(const SceneLight& light, const SceneState& state) {
  if (!aim(light, state)) return false;
  raster_.draw_only(light.moving);
  raster_(T_world_lamp_, state, moving_);
  std::vector<bool> still = light.moving;
  still.flip();
  raster_.draw_only(std::move(still));
  raster_(T_world_lamp_, state, still_);

  cells_program_.use();
  glBindTextureUnit(0, moving_.depth.name());
  glBindImageTexture(0, cells_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  glDispatchCompute(gl::groups(kCells, 8), gl::groups(kCells, 8), 1);
  spread_program_.use();
  spread_program_.set("reach", static_cast<int>(std::min(std::ceil(reach_ / kCell), kMostCells)) + 1);
  for (const bool down : {false, true}) {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    spread_program_.set("along", down ? Eigen::Vector2i(0, 1) : Eigen::Vector2i(1, 0));
    glBindTextureUnit(0, (down ? spread_ : cells_).name());
    glBindImageTexture(0, (down ? cells_ : spread_).name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glDispatchCompute(gl::groups(kCells, 8), gl::groups(kCells, 8), 1);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return true;
}

void ShadowMap::bind(const gl::Program& program, GLuint unit) const {
  program.set("lamp_face", Eigen::Vector4d(faces().fx, faces().fy, faces().cx, faces().cy).cast<float>().eval());
  program.set("lamp_radius", static_cast<float>(lamp_.radius));
  program.set("lamp_strength", lamp_.strength.homogeneous().cast<float>().eval());
  glBindTextureUnit(unit, moving_.depth.name());
  glBindTextureUnit(unit + 1, still_.depth.name());
  glBindTextureUnit(unit + 2, cells_.name());
}

}  // namespace foresight
