#include "gl/raster_pass.hpp"

#include <algorithm>
#include <stdexcept>

namespace foresight::gl {
namespace {

constexpr double kOutside = 2 * kNearPlane;  // m from a body: nothing of it that is in view is cut by the near plane

}  // namespace

FaceImages::FaceImages(const Faces& f, bool with_surface, bool with_planes)
    : faces(f), depth(GL_DEPTH_COMPONENT32F, f.width, f.height, f.count, 1, "face depth") {
  if (with_surface) surface = Texture(GL_R32UI, f.width, f.height, f.count, 1, "face surfaces");
  if (with_planes) planes = Texture(GL_RGBA32F, f.width, f.height, f.count, 1, "face planes");
}

RasterPass::RasterPass(std::shared_ptr<const SceneBuffers> scene, bool with_surface)
    : scene_(std::move(scene)),
      array_(scene_->create_vertex_array()),
      program_(
          Program::graphics(gl_shaders(), "raster.vert", with_surface ? "surface_id.frag" : "depth.frag", {"PART 0"})),
      framebuffer_(create_framebuffer("faces")),
      with_surface_(with_surface),
      leaves_out_(scene_->triangles() > kMany ? LeavesOut::hidden : LeavesOut::behind_walls) {
  if (!with_surface) glNamedFramebufferReadBuffer(framebuffer_.name(), GL_NONE);
}

void use_part(const Program& program, const ViewPart& part) {
  const double nearest = std::max(part.nearest, kNearPlane);
  program.set("between", Eigen::Vector2d(1 / part.farthest, 1 / nearest).cast<float>().eval());
  program.set("behind", part.seen ? 1 : 0);
  glBindTextureUnit(1, part.seen);
  glBindTextureUnit(2, part.edges);
}

std::vector<bool> seen_nodes(const Pose& T_world_face, const Faces& faces, const NodeBoxes& boxes,
                             const CellGraph* cells, const SceneState& state, LeavesOut leaves_out) {
  if (leaves_out == LeavesOut::nothing) return std::vector<bool>(boxes.box.size(), true);
  const ViewPyramid pyramid(T_world_face, (-0.5 - faces.cx) / faces.fx, (faces.width - 0.5 - faces.cx) / faces.fx,
                            (-0.5 - faces.cy) / faces.fy, (faces.height - 0.5 - faces.cy) / faces.fy);
  return visible_nodes(pyramid, boxes, state, leaves_out >= LeavesOut::behind_walls ? cells : nullptr);
}

void RasterPass::draw_part(const std::optional<ViewPart>& part) {
  if (part && !with_surface_) throw std::invalid_argument("a part of a view without surfaces");
  part_ = part;
  if (part_ && !part_program_)
    part_program_ = Program::graphics(gl_shaders(), "raster.vert", "surface_id.frag", {"PART 1"});
}

const Program& RasterPass::choose_program() const {
  if (!part_) return program_;
  use_part(part_program_, *part_);
  return part_program_;
}

std::vector<bool> RasterPass::wanted(std::vector<bool> nodes) const {
  for (std::size_t i = 0; i < nodes.size() && !only_.empty(); ++i) nodes[i] = nodes[i] && only_[i];
  return nodes;
}

void RasterPass::set_node(const Program& program, const Pose& T_face_world, const SceneState& state,
                          const SceneBuffers::NodeRange& range) const {
  const Pose T_face_node = T_face_world * state.T_world_node[static_cast<std::size_t>(range.node)];
  program.set("T_face_node", T_face_node.matrix().cast<float>().eval());
  program.set("first_triangle", range.first_triangle);
  // Of a part of a view, backs may be seen where what is before them is left out.
  const auto& box = scene_->boxes().box[static_cast<std::size_t>(range.node)];
  const bool is_outside = box.exteriorDistance(T_face_node.inverse().translation()) > kOutside;
  (range.is_solid && is_outside && !part_ ? glEnable : glDisable)(GL_CULL_FACE);
}

void RasterPass::draw(const Program& program, const Pose& T_face_world, const SceneState& state,
                      const std::vector<bool>& nodes) const {
  for (const auto& range : scene_->ranges()) {
    if (!nodes[static_cast<std::size_t>(range.node)]) continue;
    triangles_ += static_cast<std::size_t>(range.index_count) / 3;
    set_node(program, T_face_world, state, range);
    glDrawElementsBaseVertex(GL_TRIANGLES, range.index_count, GL_UNSIGNED_INT,
                             reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t)),
                             range.base_vertex);
  }
}

// What was seen last time first; of the others only what that does not hide.
void RasterPass::draw_unhidden(const Program& program, const FaceImages& target, int face, const Pose& T_face_world,
                               const SceneState& state, const std::vector<bool>& seen) const {
  const auto index = static_cast<std::size_t>(face);
  while (culling_.size() <= index) culling_.emplace_back(scene_);
  OcclusionCulling& culling = culling_[index];
  const std::vector<bool> first = culling.first(seen);
  draw(program, T_face_world, state, first);
  culling.judge(target.faces, target.depth.name(), face, T_face_world, state, seen, first);
  culled_faces_ = index + 1;
  program.use();
  for (std::size_t i = 0; i < scene_->ranges().size(); ++i) {
    const auto& range = scene_->ranges()[i];
    const auto node = static_cast<std::size_t>(range.node);
    if (!seen[node] || first[node]) continue;
    set_node(program, T_face_world, state, range);
    culling.draw(i);
  }
}

std::size_t RasterPass::triangles() const {
  std::size_t out = triangles_;
  for (std::size_t i = 0; i < culled_faces_; ++i) out += culling_[i].triangles();
  return out;
}

void RasterPass::operator()(const Pose& T_world_camera, const SceneState& state, const FaceImages& target,
                            const Texture* depth_copy) const {
  const Faces& faces = target.faces;
  const Program& program = choose_program();
  program.use();
  program.set("face", Eigen::Vector4d(faces.fx, faces.fy, faces.cx, faces.cy).cast<float>().eval());
  program.set("face_size", Eigen::Vector2i(faces.width, faces.height).cast<float>().eval());
  glBindVertexArray(array_.name());
  glViewport(0, 0, faces.width, faces.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glCullFace(GL_FRONT);  // rows run downwards: what faces the camera turns the other way round
  const Pose T_camera_world = T_world_camera.inverse();
  triangles_ = 0;
  culled_faces_ = 0;
  const Texture* colour = with_surface_ ? &target.surface : depth_copy;
  glNamedFramebufferDrawBuffer(framebuffer_.name(), colour ? GL_COLOR_ATTACHMENT0 : GL_NONE);
  for (int i = 0; i < faces.count; ++i) {
    glNamedFramebufferTextureLayer(framebuffer_.name(), GL_DEPTH_ATTACHMENT, target.depth.name(), 0, i);
    if (colour) glNamedFramebufferTextureLayer(framebuffer_.name(), GL_COLOR_ATTACHMENT0, colour->name(), 0, i);
    fences_();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    const float no_depth[4] = {};
    const GLuint no_surface[4] = {};
    glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, no_depth);
    if (with_surface_)
      glClearNamedFramebufferuiv(framebuffer_.name(), GL_COLOR, 0, no_surface);
    else if (depth_copy)
      glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, no_depth);

    Pose R_face_camera = Pose::Identity();
    R_face_camera.linear() = Faces::rotation(i);
    const Pose T_face_world = R_face_camera * T_camera_world;
    const std::vector<bool> seen =
        wanted(seen_nodes(T_face_world.inverse(), faces, scene_->boxes(), scene_->cells(), state, leaves_out_));
    if (leaves_out_ == LeavesOut::hidden && !part_)
      draw_unhidden(program, target, i, T_face_world, state, seen);
    else
      draw(program, T_face_world, state, seen);
  }
  glDisable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace foresight::gl
