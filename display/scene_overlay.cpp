#include "display/scene_overlay.hpp"

#include "display/shaders.hpp"
#include "gl/camera_block.hpp"

namespace foresight {
namespace {

constexpr float kRim = 1.6f;         // px around each stroke
constexpr float kRimOpacity = 0.6f;  // of the stroke's

const gl::ShaderSources& overlay_sources() {
  static const gl::ShaderSources all = [] {
    gl::ShaderSources s = gl::display_shaders();
    s.insert(gl::gl_shaders().begin(), gl::gl_shaders().end());
    return s;
  }();
  return all;
}

std::vector<Eigen::Vector4f> texels(const OverlayLines& lines) {
  std::vector<Eigen::Vector4f> out;
  out.reserve(4 * lines.strokes().size());
  for (const OverlayStroke& stroke : lines.strokes()) {
    const OverlayStyle& style = stroke.style;
    out.emplace_back(stroke.a.x(), stroke.a.y(), stroke.a.z(), stroke.along);
    out.emplace_back(stroke.b.x(), stroke.b.y(), stroke.b.z(), style.width_px);
    out.emplace_back(style.colour.x(), style.colour.y(), style.colour.z(), style.opacity);
    out.emplace_back(style.dash, stroke.begins ? 1.0f : 0.0f, stroke.ends ? 1.0f : 0.0f, 0.0f);
  }
  return out;
}

}  // namespace

SceneOverlay::SceneOverlay(const Lens& lens)
    : lens_(lens),
      program_(gl::Program::graphics(overlay_sources(), "overlay.vert", "overlay.frag")),
      camera_(sizeof(gl::CameraBlock), "overlay camera"),
      strokes_(GL_RGBA32F, 64, "overlay strokes"),
      nothing_(gl::create_vertex_array("overlay")) {}

void SceneOverlay::draw(const OverlayLines& lines, const Pose& T_world_camera, const gl::FaceImages& faces,
                        const ViewTarget& target) {
  if (lines.empty() || target.width < 1 || target.height < 1) return;
  const gl::CameraBlock block = gl::make_camera_block(lens_, faces.faces);
  camera_.write(std::span(&block, 1));
  const std::vector<Eigen::Vector4f> data = texels(lines);
  strokes_.assign(std::span<const Eigen::Vector4f>(data));

  fences_();
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glViewport(target.x, target.y, target.width, target.height);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  program_.use();
  program_.set("T_camera_world", T_world_camera.inverse().matrix().cast<float>().eval());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera_.name());
  glBindTextureUnit(0, strokes_.texture());
  glBindTextureUnit(1, faces.depth.name());
  glBindVertexArray(nothing_.name());
  for (const bool rim : {true, false}) {
    program_.set("target", Eigen::Vector4f(static_cast<float>(target.width), static_cast<float>(target.height),
                                           target.first_row_at_top ? 1.0f : 0.0f, rim ? kRim : 0.0f));
    program_.set("rim", Eigen::Vector4f(0.03f, 0.03f, 0.04f, rim ? kRimOpacity : 0.0f));
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * lines.strokes().size()));
  }
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::optional<Eigen::Vector2d> seen_at(const Eigen::Vector3d& p_world, const Lens& lens, const Pose& T_world_camera,
                                       const ViewTarget& target, int height) {
  const auto pixel = lens.project(T_world_camera.inverse() * p_world);
  if (!pixel || !pixel->allFinite()) return std::nullopt;
  const double x = (pixel->x() + 0.5) * target.width / lens.width();
  const double y = (pixel->y() + 0.5) * target.height / lens.height();
  if (x < 0 || y < 0 || x >= target.width || y >= target.height) return std::nullopt;
  const double top = target.first_row_at_top ? target.y : height - target.y - target.height;
  return Eigen::Vector2d(target.x + x, top + y);
}

}  // namespace foresight
