#include "texture_gpu/thesis/normalisation.hpp"

namespace foresight::thesis {
namespace {

constexpr std::size_t kMostCorners = 64;  // of normalise.frag

}  // namespace

Normalisation::Normalisation(int max_texture)
    : texture_(smooth_texture(GL_RGBA8, max_texture, max_texture, "new normalised texture")),
      box_(texel_program("normalise.frag", {"POLYGON_ONLY 0"})),
      polygon_(texel_program("normalise.frag", {"POLYGON_ONLY 1"})) {}

void Normalisation::bind(const gl::Program& program, const PerspectiveTexture& perspective, const BoundingBox& box,
                         const PolygonFrame& frame, const Pose& T_camera_node, const gl::Faces& plane) const {
  // (pixel * z, z) = to_pixel * (i, j, 1): a homography of the plane, with i, j as in PolygonFrame::at.
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K << plane.fx, 0, plane.cx, 0, plane.fy, plane.cy, 0, 0, 1;
  Eigen::Matrix4f to_pixel = Eigen::Matrix4f::Identity();
  const Eigen::Matrix3d KR = K * T_camera_node.linear();
  to_pixel.col(0).head<3>() = (KR * frame.x * (frame.width / frame.s)).cast<float>();
  to_pixel.col(1).head<3>() = (KR * frame.y * (frame.height / frame.t)).cast<float>();
  to_pixel.col(2).head<3>() = (K * (T_camera_node * frame.origin)).cast<float>();
  program.use();
  program.set("to_pixel", to_pixel);
  program.set("box", Eigen::Vector4f(static_cast<float>(box.x), static_cast<float>(box.y),
                                     static_cast<float>(box.width), static_cast<float>(box.height)));
  glBindTextureUnit(0, perspective.texture().name());
}

void Normalisation::operator()(const PerspectiveTexture& perspective, const BoundingBox& box, const PolygonFrame& frame,
                               const Pose& T_camera_node, const gl::Faces& plane, const TexelDrawing& drawing) const {
  bind(box_, perspective, box, frame, T_camera_node, plane);
  drawing.onto(texture_, frame.s, frame.t);
  drawing.rectangle();
}

void Normalisation::polygon_only(const PerspectiveTexture& perspective, const BoundingBox& box, const Polygon& polygon,
                                 const PolygonFrame& frame, const Pose& T_camera_node, const gl::Faces& plane,
                                 const TexelDrawing& drawing) const {
  bind(polygon_, perspective, box, frame, T_camera_node, plane);
  std::vector<Eigen::Vector2f> corners;
  for (std::size_t i = 0; i < std::min(polygon.corners.size(), kMostCorners); ++i)
    corners.push_back(frame.texel_of(polygon.corners[i]).cast<float>());
  polygon_.set("corner_count", static_cast<int>(corners.size()));
  glUniform2fv(glGetUniformLocation(polygon_.name(), "corners"), static_cast<GLsizei>(corners.size()),
               corners.front().data());
  drawing.onto(texture_, frame.s, frame.t);
  drawing.rectangle();
}

}  // namespace foresight::thesis
