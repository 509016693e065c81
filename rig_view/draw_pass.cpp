#include "rig_view/draw_pass.hpp"

#include <opencv2/imgproc.hpp>

namespace foresight::gl {
const ShaderSources& rig_view_shaders();
}  // namespace foresight::gl

namespace foresight {
namespace {

constexpr int kFiner = 2;  // pixels of a pixel, along each side
constexpr float kGround[4] = {0.955f, 0.960f, 0.965f, 1};
constexpr float kBehind = 0.40f;  // opacity of lines behind something

struct LineCorner {
  Eigen::Vector3f p, other;
  Colour colour;
  Eigen::Vector2f side_width;
};
static_assert(sizeof(LineCorner) == 12 * sizeof(float) && sizeof(Drawing::Corner) == 7 * sizeof(float));

struct Attribute {
  GLint size;
  std::size_t offset;
};

template <typename T>
void fill(gl::Buffer& buffer, const gl::VertexArray& array, const std::vector<T>& data, const char* label) {
  const std::size_t bytes = data.size() * sizeof(T);
  if (bytes > buffer.bytes()) buffer = gl::Buffer(2 * bytes, label);
  if (bytes > 0) buffer.write(std::span<const T>(data));
  glVertexArrayVertexBuffer(array.name(), 0, buffer.name(), 0, sizeof(T));
}

gl::VertexArray array_of(std::initializer_list<Attribute> attributes, const char* label) {
  gl::VertexArray array = gl::create_vertex_array(label);
  GLuint i = 0;
  for (const Attribute& a : attributes) {
    glEnableVertexArrayAttrib(array.name(), i);
    glVertexArrayAttribFormat(array.name(), i, a.size, GL_FLOAT, GL_FALSE, static_cast<GLuint>(a.offset));
    glVertexArrayAttribBinding(array.name(), i++, 0);
  }
  return array;
}

}  // namespace

DrawPass::DrawPass(std::shared_ptr<const SceneModel> model)
    : line_array_(array_of({{3, offsetof(LineCorner, p)},
                            {3, offsetof(LineCorner, other)},
                            {4, offsetof(LineCorner, colour)},
                            {2, offsetof(LineCorner, side_width)}},
                           "lines")),
      glass_array_(array_of({{3, offsetof(Drawing::Corner, p)}, {4, offsetof(Drawing::Corner, colour)}}, "glass")),
      mesh_(gl::Program::graphics(gl::rig_view_shaders(), "mesh.vert", "mesh.frag")),
      line_(gl::Program::graphics(gl::rig_view_shaders(), "line.vert", "shape.frag")),
      glass_(gl::Program::graphics(gl::rig_view_shaders(), "shape.vert", "shape.frag")),
      target_(gl::create_framebuffer("rig view, fine")),
      small_target_(gl::create_framebuffer("rig view")) {
  if (!model) return;
  meshes_.emplace(*model);
  mesh_array_ = meshes_->create_vertex_array();
}

void DrawPass::fit(int width, int height) {
  if (small_ && small_.width() == width && small_.height() == height) return;
  small_ = gl::Texture(GL_RGBA8, width, height, 0, 1, "rig view");
  colour_ = gl::Texture(GL_RGBA8, kFiner * width, kFiner * height, 0, 1, "rig view, fine");
  depth_ = gl::Texture(GL_DEPTH_COMPONENT32F, kFiner * width, kFiner * height, 0, 1, "rig view depth");
  glNamedFramebufferTexture(target_.name(), GL_COLOR_ATTACHMENT0, colour_.name(), 0);
  glNamedFramebufferTexture(target_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  glNamedFramebufferTexture(small_target_.name(), GL_COLOR_ATTACHMENT0, small_.name(), 0);
}

void DrawPass::draw_meshes(const Eye& eye, const Eigen::Matrix4f& clip, std::span<const Pose> T_world_node,
                           std::span<const Colour> colours) const {
  if (!meshes_) return;
  mesh_.use();
  mesh_.set("clip_from_world", clip);
  const Eigen::Vector3f to_eye = -eye.T_world_eye().linear().col(2).cast<float>();
  mesh_.set("to_eye", Eigen::Vector4f(to_eye.x(), to_eye.y(), to_eye.z(), 0));
  glBindVertexArray(mesh_array_.name());
  for (const auto& range : meshes_->ranges()) {
    const auto node = static_cast<std::size_t>(range.node);
    if (colours[node][3] <= 0) continue;
    mesh_.set("T_world_node", T_world_node[node].matrix().cast<float>().eval());
    mesh_.set("colour", Eigen::Vector4f(colours[node]));
    glDrawElementsBaseVertex(GL_TRIANGLES, range.index_count, GL_UNSIGNED_INT,
                             reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t)),
                             range.base_vertex);
  }
}

void DrawPass::draw_lines(const Drawing& drawing, const Eye& eye, const Eigen::Matrix4f& clip) {
  std::vector<LineCorner> corners;
  for (const Drawing::Line& line : drawing.lines) {
    const auto corner = [&](bool far, float side) {
      return LineCorner{far ? line.to : line.from,
                        far ? line.from : line.to,
                        line.colour,
                        {far ? -side : side, line.width_px * kFiner}};
    };
    corners.insert(corners.end(), {corner(false, -1), corner(false, 1), corner(true, 1), corner(false, -1),
                                   corner(true, 1), corner(true, -1)});
  }
  fill(lines_, line_array_, corners, "lines");
  line_.use();
  line_.set("clip_from_world", clip);
  line_.set("size", Eigen::Vector2f(static_cast<float>(colour_.width()), static_cast<float>(colour_.height())));
  line_.set("nearest", eye.perspective ? 0.02f : 0.0f);
  line_.set("nearer", eye.perspective ? 1.002f : 1.0002f);
  glBindVertexArray(line_array_.name());
  for (const bool behind : {false, true}) {
    line_.set("opacity", behind ? kBehind : 1.0f);
    glDepthFunc(behind ? GL_LESS : GL_GEQUAL);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
  }
  glDepthFunc(GL_GREATER);
}

void DrawPass::draw_glass(const Drawing& drawing, const Eigen::Matrix4f& clip) {
  fill(corners_, glass_array_, drawing.glass, "glass");
  glass_.use();
  glass_.set("clip_from_world", clip);
  glBindVertexArray(glass_array_.name());
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(drawing.glass.size()));
}

cv::Mat DrawPass::operator()(const Eye& eye, int width, int height, std::span<const Pose> T_world_node,
                             std::span<const Colour> colours, const Drawing& drawing) {
  fit(width, height);
  const Eigen::Matrix4f clip = eye.clip_from_world(width, height);
  const float no_depth = 0;
  glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
  glViewport(0, 0, colour_.width(), colour_.height());
  glClearNamedFramebufferfv(target_.name(), GL_COLOR, 0, kGround);
  glClearNamedFramebufferfv(target_.name(), GL_DEPTH, 0, &no_depth);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  draw_meshes(eye, clip, T_world_node, colours);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  draw_glass(drawing, clip);
  draw_lines(drawing, eye, clip);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
  glBlitNamedFramebuffer(target_.name(), small_target_.name(), 0, 0, colour_.width(), colour_.height(), 0, 0, width,
                         height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
  cv::Mat rgba(height, width, CV_8UC4), out;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, small_target_.name());
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  cv::cvtColor(rgba, out, cv::COLOR_RGBA2BGR);
  return out;
}

}  // namespace foresight
