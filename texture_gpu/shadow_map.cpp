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
// A map is a little wider than what it has to hold, and stays until that has no room in it, or too much.
constexpr double kSpare = 1.08, kLeastUsed = 0.75;

gl::Faces square_face() {
  gl::Faces faces;
  faces.width = faces.height = kMapSide;
  faces.cx = faces.cy = (kMapSide - 1) / 2.0;
  return faces;
}

}  // namespace

SceneLight light_from_above(const gl::SceneBuffers& scene, const SceneState& state) {
  constexpr double kFar = 3;  // diagonals of the scene: a map holds all of it, then
  Eigen::AlignedBox3d all;
  for (std::size_t i = 0; i < scene.boxes().box.size(); ++i)
    if (const auto& box = scene.boxes().box[i]; !box.isEmpty()) all.extend(box.transformed(state.T_world_node[i]));
  SceneLight out{{}, std::vector<bool>(scene.boxes().box.size(), true)};
  if (!all.isEmpty()) out.lamp.position = all.center() + kFar * all.diagonal().norm() * Eigen::Vector3d::UnitZ();
  return out;
}

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

ShadowMap::Reach ShadowMap::reach_of(const SceneLight& light, const SceneState& state) const {
  const auto& boxes = scene_->boxes().box;
  Reach out;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].isEmpty()) continue;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3d corner =
          state.T_world_node[i] * boxes[i].corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
      out.farthest = std::max(out.farthest, (corner - light.lamp.position).norm());
      if (light.moving[i]) out.moving.push_back(corner);
    }
  }
  return out;
}

/// How the map, as it is turned, has to be; nothing where the lamp stands among what moves.
std::optional<ShadowMap::Extent> ShadowMap::extent_of(const Reach& reach) const {
  double widest = 0, nearest = reach.farthest;
  for (const Eigen::Vector3d& corner : reach.moving) {
    const Eigen::Vector3d p = T_world_lamp_.inverse() * corner;
    if (p.z() < kClosest) return std::nullopt;
    widest = std::max(widest, p.head<2>().cwiseAbs().maxCoeff() / p.z());
    nearest = std::min(nearest, p.z());
  }
  const double rim = lamp_.radius * (1 / nearest - 1 / reach.farthest);
  return Extent{widest + rim, rim};  // shadows are looked for that far beside what throws them
}

/// Turns the lamp to what moves, and chooses a map that holds it all; the one before, where that does.
bool ShadowMap::aim(const SceneLight& light, const SceneState& state) {
  const Reach reach = reach_of(light, state);
  if (reach.moving.empty()) return false;
  const bool is_aimed = held_ > 0 && lamp_ == light.lamp;
  lamp_ = light.lamp;
  std::optional<Extent> extent = is_aimed ? extent_of(reach) : std::nullopt;
  if (!extent || extent->widest > held_ || extent->widest < kLeastUsed * held_) {
    held_ = 0;
    still_of_.reset();
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : reach.moving) box.extend(corner);
    const Eigen::Vector3d ahead = box.center() - lamp_.position;
    if (!(ahead.norm() > kClosest)) return false;
    T_world_lamp_ = Pose::Identity();
    T_world_lamp_.linear().col(2) = ahead.normalized();
    T_world_lamp_.linear().col(0) = ahead.unitOrthogonal();
    T_world_lamp_.linear().col(1) = T_world_lamp_.linear().col(2).cross(T_world_lamp_.linear().col(0));
    T_world_lamp_.translation() = lamp_.position;
    extent = extent_of(reach);
    if (!extent || extent->widest > kWidest) return false;
    held_ = std::min(kSpare * extent->widest, kWidest);
    moving_.faces.fx = moving_.faces.fy = kMapSide / 2.0 / held_;
    still_.faces = moving_.faces;
  }
  reach_ = extent->rim * moving_.faces.fx;
  return true;
}

/// What stands still, where it does not stand in the map as it is.
void ShadowMap::draw_still(const SceneLight& light, const SceneState& state) {
  std::vector<std::optional<Pose>> still_of(light.moving.size());
  for (std::size_t i = 0; i < still_of.size(); ++i)
    if (!light.moving[i]) still_of[i] = state.T_world_node[i];
  const auto is_same = [](const std::optional<Pose>& a, const std::optional<Pose>& b) {
    return a && b ? a->matrix() == b->matrix() : !a && !b;
  };
  if (still_of_ && std::ranges::equal(still_of, *still_of_, is_same)) return;
  std::vector<bool> still = light.moving;
  still.flip();
  raster_.draw_only(std::move(still));
  raster_(T_world_lamp_, state, still_);
  still_of_ = std::move(still_of);
}

bool ShadowMap::update(const SceneLight& light, const SceneState& state) {
  if (!aim(light, state)) return false;
  raster_.draw_only(light.moving);
  raster_(T_world_lamp_, state, moving_);
  draw_still(light, state);

  glBindTextureUnit(0, moving_.depth.name());
  glBindImageTexture(0, cells_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  cells_program_.dispatch(kCells, kCells);
  spread_program_.set("reach", static_cast<int>(std::min(std::ceil(reach_ / kCell), kMostCells)) + 1);
  for (const bool down : {false, true}) {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    spread_program_.set("along", down ? Eigen::Vector2i(0, 1) : Eigen::Vector2i(1, 0));
    glBindTextureUnit(0, (down ? spread_ : cells_).name());
    glBindImageTexture(0, (down ? cells_ : spread_).name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    spread_program_.dispatch(kCells, kCells);
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
