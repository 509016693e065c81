#include "gl/level_pass.hpp"

#include <algorithm>
#include <array>

namespace foresight::gl {
namespace {

Program level_program(bool faded, bool planes, bool part) {
  return Program::graphics(
      gl_shaders(), "level.vert", "level.frag",
      {"FADED " + std::to_string(faded), "PLANES " + std::to_string(planes), "PART " + std::to_string(part)});
}

Pose T_face_world(int face, const Pose& T_world_camera) {
  Pose R_face_camera = Pose::Identity();
  R_face_camera.linear() = Faces::rotation(face);
  return R_face_camera * T_world_camera.inverse();
}

}  // namespace

LevelPass::Programs::Programs(bool planes, bool part)
    : whole(level_program(false, planes, part)), faded(level_program(true, planes, part)) {}

LevelPass::LevelPass(std::shared_ptr<const LevelBuffers> levels)
    : levels_(std::move(levels)),
      array_(levels_->create_vertex_array()),
      framebuffer_(create_framebuffer("faces of levels")) {}

const LevelPass::Programs& LevelPass::programs(bool planes) const {
  auto& out = programs_[(planes ? 1 : 0) + (part_ ? 2 : 0)];
  if (!out) out.emplace(planes, part_.has_value());
  return *out;
}

SeenNodes LevelPass::seen_from(const Pose& T_world_camera, const SceneState& state, const Faces& faces) const {
  SeenNodes out;
  out.anywhere.resize(levels_->levels()->nodes().size(), false);
  for (int i = 0; i < faces.count; ++i) {
    out.on_face.push_back(seen_nodes(T_face_world(i, T_world_camera).inverse(), faces, levels_->levels()->boxes(),
                                     levels_->cells(), state, leaves_out_));
    for (std::size_t n = 0; n < out.anywhere.size(); ++n) out.anywhere[n] = out.anywhere[n] || out.on_face.back()[n];
  }
  return out;
}

void LevelPass::operator()(const Pose& T_world_camera, const SceneState& state, const LevelPlan& plan,
                           const SeenNodes& seen, const FaceImages& target) const {
  const Faces& faces = target.faces;
  const bool planes = static_cast<bool>(target.planes);
  const Programs& all = programs(planes);
  for (const Program* program : {&all.whole, &all.faded}) {
    program->set("face", Eigen::Vector4d(faces.fx, faces.fy, faces.cx, faces.cy).cast<float>().eval());
    program->set("face_size", Eigen::Vector2i(faces.width, faces.height).cast<float>().eval());
    if (part_) use_part(*program, *part_);
  }
  glBindVertexArray(array_.name());
  glBindTextureUnit(0, levels_->sources());
  glViewport(0, 0, faces.width, faces.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  const std::array<GLenum, 2> buffers{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(framebuffer_.name(), planes ? 2 : 1, buffers.data());
  triangles_ = 0;
  for (int i = 0; i < faces.count; ++i) {
    start_face(i, target);
    const Pose T = T_face_world(i, T_world_camera);
    const std::vector<bool>& on_face = seen.on_face[static_cast<std::size_t>(i)];
    for (std::size_t n = 0; n < on_face.size(); ++n) {
      if (!on_face[n] || levels_->levels()->nodes()[n].levels.empty()) continue;
      draw_node(n, T * state.T_world_node[n], plan, all);
    }
  }
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void LevelPass::start_face(int i, const FaceImages& target) const {
  glNamedFramebufferTextureLayer(framebuffer_.name(), GL_DEPTH_ATTACHMENT, target.depth.name(), 0, i);
  glNamedFramebufferTextureLayer(framebuffer_.name(), GL_COLOR_ATTACHMENT0, target.surface.name(), 0, i);
  if (target.planes)
    glNamedFramebufferTextureLayer(framebuffer_.name(), GL_COLOR_ATTACHMENT1, target.planes.name(), 0, i);
  else
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT1, 0, 0);
  fences_();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  const float no_depth = 0;
  const GLuint no_surface[4] = {};
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &no_depth);
  glClearNamedFramebufferuiv(framebuffer_.name(), GL_COLOR, 0, no_surface);
}

void LevelPass::draw_node(std::size_t node, const Pose& T_face_node, const LevelPlan& plan, const Programs& all) const {
  const LevelBlend blend = plan.blends[node];
  const bool fades = blend.share > 0 && plan.transition == LevelTransition::fade;
  const Program& program = fades ? all.faded : all.whole;
  program.use();
  program.set("T_face_node", T_face_node.matrix().cast<float>().eval());
  program.set("moved", fades ? 0 : blend.share);
  if (!fades) return draw_level(node, blend.level, program);
  for (const int coarser : {0, 1}) {
    program.set("share", blend.share);
    program.set("coarser", coarser);
    draw_level(node, blend.level + coarser, program);
  }
}

void LevelPass::draw_level(std::size_t node, int level, const Program& program) const {
  const LevelBuffers::Range& range = levels_->range(node, level);
  program.set("first_triangle", range.first_triangle);
  program.set("first_source", range.first_source);
  program.set("first_going", range.first_going);
  triangles_ += static_cast<std::size_t>(range.index_count) / 3;
  glDrawElementsBaseVertex(GL_TRIANGLES, range.index_count, GL_UNSIGNED_INT,
                           reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t)), range.base_vertex);
}

}  // namespace foresight::gl
