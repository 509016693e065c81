#include "gl/occlusion_culling.hpp"

namespace foresight::gl {
namespace {

constexpr int kTile = 8;  // as in the shaders

/// As in hidden.comp.
struct NodeBox {
  std::array<Eigen::Vector4f, 3> T_face_node;
  Eigen::Vector4f low, high;
  std::array<std::uint32_t, 4> draw;  // indices, first index, base vertex, NodeTask
};
enum NodeTask : std::uint32_t { kLeaveOut = 0, kJudge = 1, kIsDrawn = 2 };
struct Command {  // as glDrawElementsIndirect reads it
  GLuint count, instances, first_index;
  GLint base_vertex;
  GLuint base_instance;
};

int tiles_for(int pixels) {
  return (pixels + kTile - 1) / kTile;
}

Eigen::Vector4f padded(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

}  // namespace

OcclusionCulling::OcclusionCulling(std::shared_ptr<const SceneBuffers> scene)
    : scene_(std::move(scene)),
      farthest_(Program::compute(gl_shaders(), "farthest.comp")),
      judge_(Program::compute(gl_shaders(), "hidden.comp")),
      boxes_(sizeof(NodeBox) * scene_->ranges().size(), "boxes of nodes"),
      commands_(sizeof(Command) * scene_->ranges().size(), "nodes that may be seen"),
      visible_(sizeof(GLuint) * scene_->ranges().size(), "whether they may") {}

std::vector<bool> OcclusionCulling::first(const std::vector<bool>& seen) {
  if (is_judged_ && judged_.signalled()) {
    std::vector<GLuint> flags(scene_->ranges().size());
    visible_.read(std::span(flags));
    seen_last_.assign(seen.size(), false);
    for (std::size_t i = 0; i < flags.size(); ++i)
      seen_last_[static_cast<std::size_t>(scene_->ranges()[i].node)] = flags[i] != 0;
  }
  if (seen_last_.empty()) return seen;
  std::vector<bool> out(seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) out[i] = seen[i] && seen_last_[i];
  return out;
}

void OcclusionCulling::judge(const Faces& faces, GLuint depth, int layer, const Pose& T_face_world,
                             const SceneState& state, const std::vector<bool>& seen, const std::vector<bool>& drawn) {
  const Eigen::Vector2i size(faces.width, faces.height);
  Eigen::Vector2i tiles = size;
  for (std::size_t i = 0; i < 2; ++i) {
    tiles = {tiles_for(tiles.x()), tiles_for(tiles.y())};
    if (tiles_[i].width() != tiles.x() || tiles_[i].height() != tiles.y())
      tiles_[i] = Texture(GL_R32F, tiles.x(), tiles.y(), 0, 1, "farthest depth of tiles");
    farthest_.set("level", static_cast<int>(i));
    farthest_.set("layer", layer);
    glBindTextureUnit(0, depth);
    glBindTextureUnit(1, tiles_[0].name());
    glBindImageTexture(0, tiles_[i].name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    farthest_.dispatch(tiles.x(), tiles.y());
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  }

  std::vector<NodeBox> boxes;
  boxes.reserve(scene_->ranges().size());
  for (const auto& range : scene_->ranges()) {
    const auto node = static_cast<std::size_t>(range.node);
    const Eigen::Matrix4f m = (T_face_world * state.T_world_node[node]).matrix().cast<float>();
    const Eigen::AlignedBox3d& box = scene_->boxes().box[node];
    boxes.push_back({{m.row(0).transpose(), m.row(1).transpose(), m.row(2).transpose()},
                     padded(box.min()),
                     padded(box.max()),
                     {static_cast<std::uint32_t>(range.index_count), static_cast<std::uint32_t>(range.first_index),
                      static_cast<std::uint32_t>(range.base_vertex),
                      drawn[node]  ? kIsDrawn
                      : seen[node] ? kJudge
                                   : kLeaveOut}});
  }
  boxes_.write(std::span<const NodeBox>(boxes));
  judge_.set("face", Eigen::Vector4d(faces.fx, faces.fy, faces.cx, faces.cy).cast<float>().eval());
  judge_.set("size", size);
  judge_.set("count", static_cast<int>(boxes.size()));
  for (GLuint i = 0; i < 2; ++i) glBindTextureUnit(i, tiles_[i].name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, boxes_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, commands_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, visible_.name());
  judge_.dispatch(static_cast<int>(boxes.size()));
  glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  judged_ = Fence::insert();
  is_judged_ = true;
}

void OcclusionCulling::draw(std::size_t range) const {
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.name());
  glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(range * sizeof(Command)));
}

std::size_t OcclusionCulling::triangles() const {
  std::vector<Command> commands(scene_->ranges().size());
  commands_.read(std::span(commands));
  std::size_t out = 0;
  for (const Command& command : commands) out += command.instances * command.count / 3;
  return out;
}

}  // namespace foresight::gl
