#include "display/thesis_view.hpp"

#include "display/shaders.hpp"
#include "gl/lens_rays.hpp"
#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

const gl::ShaderSources& sources() {
  static const gl::ShaderSources all = [] {
    gl::ShaderSources s = gl::display_shaders();
    s.insert(thesis::shaders().begin(), thesis::shaders().end());
    return s;
  }();
  return all;
}

/// Row of the affine map from the node's frame to texture coordinates 0 .. 1 along one axis.
Eigen::Vector4f to_coordinate(const Eigen::Vector3d& axis, const Eigen::Vector3d& origin, double length) {
  const Eigen::Vector3d row = axis / length;
  return Eigen::Vector4d(row.x(), row.y(), row.z(), -row.dot(origin)).cast<float>();
}

}  // namespace

ThesisView::ThesisView(const thesis::Pipeline& pipeline, const Lens& lens)
    : pipeline_(pipeline),
      lens_(lens),
      plane_(gl::faces_for(lens, 2)),
      drawn_(thesis::smooth_texture(GL_RGBA8, plane_.width, plane_.height, "thesis view")),
      depth_(GL_DEPTH_COMPONENT32F, plane_.width, plane_.height, 0, 1, "thesis view depth"),
      rays_(gl::make_lens_rays(lens)),
      nothing_(GL_RGBA8, 1, 1, 0, 1, "no texture"),
      camera_(sizeof(gl::CameraBlock), "thesis view camera"),
      framebuffer_(gl::create_framebuffer("thesis view")),
      triangles_(pipeline.polygon_buffers()->create_vertex_array()),
      textured_(gl::Program::graphics(sources(), "textured.vert", "textured.frag")) {
  const gl::CameraBlock block = gl::make_camera_block(lens_, plane_);
  camera_.write(std::span(&block, 1));
  glClearTexImage(nothing_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, drawn_.name(), 0);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  if (lens.has_distortion()) {
    picture_ = gl::Texture(GL_RGBA8, lens.width(), lens.height(), 0, 1, "thesis view through the lens");
    through_lens_ = gl::Program::graphics(sources(), "rectangle.vert", "through_lens.frag");
  }
}

void ThesisView::draw(const Pose& T_world_camera, const SceneState& state) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, plane_.width, plane_.height);
  const float nothing[4] = {}, no_depth = 0;
  glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &no_depth);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  textured_.use();
  textured_.set("face", Eigen::Vector4d(plane_.fx, plane_.fy, plane_.cx, plane_.cy).cast<float>().eval());
  textured_.set("face_size", Eigen::Vector2i(plane_.width, plane_.height).cast<float>().eval());
  glBindVertexArray(triangles_.name());
  const thesis::PolygonTextures& textures = pipeline_.textures();
  const bool filled = pipeline_.options().hole_filling != thesis::HoleFilling::none;
  const Pose T_camera_world = T_world_camera.inverse();
  for (std::size_t i = 0; i < textures.polygons().size(); ++i) {
    const Pose T_camera_node =
        T_camera_world * state.T_world_node[static_cast<std::size_t>(textures.polygons()[i].node)];
    const thesis::PolygonFrame& frame = textures.frame(i);
    const gl::Texture* texture = textures.has_colours(i) ? textures.find(i) : nullptr;
    textured_.set("T_face_node", T_camera_node.matrix().cast<float>().eval());
    textured_.set("to_s", to_coordinate(frame.x, frame.origin, frame.width));
    textured_.set("to_t", to_coordinate(frame.y, frame.origin, frame.height));
    textured_.set("hole_alpha",
                  static_cast<float>(texture && filled ? view_alpha::kFromFill : view_alpha::kBare) / 255.0f);
    glBindTextureUnit(0, (texture ? *texture : nothing_).name());
    pipeline_.polygon_buffers()->draw(i);
  }
  glDisable(GL_DEPTH_TEST);
  if (!picture_) return;
  drawing_.onto(picture_, lens_.width(), lens_.height());
  through_lens_.use();
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera_.name());
  glBindTextureUnit(0, drawn_.name());
  glBindTextureUnit(4, rays_.name());
  drawing_.rectangle();
}

cv::Mat ThesisView::read() const {
  cv::Mat picture(lens_.height(), lens_.width(), CV_8UC4);
  glGetTextureSubImage(picture_ ? picture_.name() : drawn_.name(), 0, 0, 0, 0, picture.cols, picture.rows, 1, GL_BGRA,
                       GL_UNSIGNED_BYTE, static_cast<GLsizei>(picture.total() * 4), picture.data);
  return picture;
}

}  // namespace foresight
