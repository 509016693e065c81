#include "display/observer_pass.hpp"

#include <algorithm>
#include <array>

#include "display/shaders.hpp"

namespace foresight {
namespace {

constexpr double kPanelZ = 0.30, kEyeZ = 0.55;  // m: near enough to leave the scene to be seen
constexpr double kNearest = 0.02;               // m before the observer: nearer, wires are cut off

Eigen::Matrix4f matrix(const Pose& pose) {
  return pose.matrix().cast<float>();
}

}  // namespace

Lens observer_lens(int width, int height, double focal) {
  Lens::Parameters p;
  p.width = std::max(1, width);
  p.height = std::max(1, height);
  p.fx = p.fy = std::max(1.0, focal * p.height);
  p.cx = 0.5 * (p.width - 1);
  p.cy = 0.5 * (p.height - 1);
  return Lens(p);
}

ObserverPass::ObserverPass()
    : program_(gl::Program::compute(display_and_lookup_shaders(), "observer.comp")),
      observer_(sizeof(gl::CameraBlock), "observer"),
      others_((1 + kMostPanels) * sizeof(gl::CameraBlock), "operator and panels"),
      wire_texels_(GL_RGBA32F, 4096, "wires") {}

// From the camera's centre to the corners of what it sees at z, and around them.
void ObserverPass::add_pyramid(const Lens& observer, const Pose& T_observer_camera, const Lens& lens, double z,
                               Wire kind) {
  const double right = lens.width() - 0.5, below = lens.height() - 0.5;
  std::array<Eigen::Vector3d, 5> p{Eigen::Vector3d::Zero()};
  const std::array<Eigen::Vector2d, 4> corners{{{-0.5, -0.5}, {right, -0.5}, {right, below}, {-0.5, below}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto ray = lens.unproject(corners[i]);
    if (!ray || ray->z() < 0.1) return;  // sees too much for a pyramid
    p[i + 1] = *ray * (z / ray->z());
  }
  const auto wire = [&](std::size_t from, std::size_t to) {
    Eigen::Vector3d a = T_observer_camera * p[from], b = T_observer_camera * p[to];
    if (a.z() < kNearest && b.z() < kNearest) return;
    if (a.z() < kNearest) a += (kNearest - a.z()) / (b.z() - a.z()) * (b - a);
    if (b.z() < kNearest) b += (kNearest - b.z()) / (a.z() - b.z()) * (a - b);
    for (const Eigen::Vector3d& end : {a, b}) {
      const auto& o = observer.parameters();
      wires_.push_back(Eigen::Vector4d(o.fx * end.x() / end.z() + o.cx, o.fy * end.y() / end.z() + o.cy, 1 / end.z(),
                                       static_cast<double>(kind))
                           .cast<float>());
    }
  };
  for (std::size_t i = 1; i <= 4; ++i) wire(0, i), wire(i, i % 4 + 1);
}

void ObserverPass::operator()(const PredictedView& view, const Pose& T_world_observer, const PredictedView& seen,
                              const Pose& T_world_operator, std::span<const CameraPanel> panels) {
  panels = panels.first(std::min(panels.size(), kMostPanels));
  const Pose T_observer_world = T_world_observer.inverse();
  wires_.clear();
  add_pyramid(view.lens(), T_observer_world * T_world_operator, seen.lens(), kEyeZ, Wire::eye);
  std::array<gl::CameraBlock, 1 + kMostPanels> others{gl::make_camera_block(seen.lens(), seen.faces().faces)};
  const char* const names[kMostPanels] = {"T_panel0_observer", "T_panel1_observer"};
  for (std::size_t i = 0; i < panels.size(); ++i) {
    others[1 + i] = gl::make_camera_block(panels[i].lens, gl::Faces{});
    add_pyramid(view.lens(), T_observer_world * panels[i].T_world_camera, panels[i].lens, kPanelZ, Wire::camera);
    program_.set(names[i], matrix(panels[i].T_world_camera.inverse() * T_world_observer));
    glBindTextureUnit(static_cast<GLuint>(2 + i), panels[i].picture->name());
  }
  const gl::CameraBlock observer = gl::make_camera_block(view.lens(), view.faces().faces);
  observer_.write(std::span(&observer, 1));
  others_.write(std::span<const gl::CameraBlock>(others));
  wire_texels_.assign(std::span<const Eigen::Vector4f>(wires_));
  program_.set("T_operator_observer", matrix(T_world_operator.inverse() * T_world_observer));
  program_.set("panel_count", static_cast<int>(panels.size()));
  program_.set("panel_z", static_cast<float>(kPanelZ));
  program_.set("wire_count", static_cast<int>(wires_.size() / 2));
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, observer_.name());
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, others_.name());
  glBindTextureUnit(0, view.faces().depth.name());
  glBindTextureUnit(1, seen.faces().depth.name());
  glBindTextureUnit(4, wire_texels_.texture());
  glBindImageTexture(0, view.picture().name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);  // the view was stored by the pass before
  program_.dispatch(view.lens().width(), view.lens().height());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

}  // namespace foresight
