// The occlusion mask (section 4.2) against ray casting.
#include "texture_gpu/thesis/occlusion.hpp"

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"
#include "tests/thesis/texels.hpp"
#include "texture_gpu/thesis/perspective_texture.hpp"

namespace foresight::thesis::occlusion_test {
namespace {

using Eigen::Vector3d;

class OcclusionTest : public HeadlessTest {};

/// Least distance of a ray's point in the polygon's plane from its edges, in pixels; below 0 outside.
double inside_px(const Polygon& polygon, const Pose& T_camera_node, const Vector3d& ray, double focal, double& depth) {
  const Vector3d n = T_camera_node.linear() * polygon.normal, a = T_camera_node * polygon.corners[0];
  depth = n.dot(a) / n.dot(ray);
  if (depth <= 0) return -1e9;
  const double turn = n.dot(a) < 0 ? -1 : 1;
  double least = 1e9;
  for (std::size_t i = 0; i < polygon.corners.size(); ++i) {
    const Vector3d p = T_camera_node * polygon.corners[i],
                   q = T_camera_node * polygon.corners[(i + 1) % polygon.corners.size()];
    // Of the plane through the eye and the edge.
    least = std::min(least, turn * p.cross(q).normalized().dot(ray.normalized()) * focal);
  }
  return least;
}

TEST_F(OcclusionTest, TheMaskIsThatOfRayCasting) {
  const auto scene = small_scene();
  const SceneState state = state_of(*scene);
  const auto polygons = find_polygons(*scene);
  const auto buffers = std::make_shared<PolygonBuffers>(std::make_shared<gl::SceneBuffers>(*scene), polygons);
  const Lens lens = small_lens("pinhole");
  const Occlusion occlusion(buffers);
  const TexelDrawing drawing;
  CameraFrame frame(lens, buffers->scene());
  const reference::RayCaster caster(*scene, state);
  int visible = 0, hidden = 0, outside = 0, wrong = 0, beside = 0, missed = 0;
  for (const Pose& T_world_camera : {usual_view(), look_at({-0.5, -0.5, 0.25}, {0.1, 0.1, 0.1})}) {
    const PosedImage image = posed_photograph(*scene, state, lens, T_world_camera);
    frame.upload(image);
    frame.load(drawing);
    frame.draw_depth(image, drawing);
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const Pose T_camera_node =
          T_world_camera.inverse() * state.T_world_node[static_cast<std::size_t>(polygons[i].node)];
      if (!bounding_box(polygons[i], T_camera_node, frame.plane())) continue;
      occlusion.mark(frame, i, T_camera_node, false);
      const cv::Mat plain = read_texels(frame.colour(), lens.width(), lens.height());
      frame.reset_alpha(0, 0, lens.width(), lens.height());
      occlusion.mark(frame, i, T_camera_node, true);
      const cv::Mat with_border = read_texels(frame.colour(), lens.width(), lens.height());
      frame.reset_alpha(0, 0, lens.width(), lens.height());
      for (int y = 0; y < lens.height(); ++y)
        for (int x = 0; x < lens.width(); ++x) {
          const Vector3d ray = *lens.unproject({x, y});
          double depth = 0;
          const double inside = inside_px(polygons[i], T_camera_node, ray / ray.z(), lens.parameters().fx, depth);
          const int alpha = plain.at<cv::Vec4b>(y, x)[3];
          if (std::abs(inside) < 0.02) continue;  // on an edge rounding decides
          if (inside < 0) {
            ++outside;
            wrong += alpha != 247;
            // A line of five pixels around it: what lies there is visible or hidden, not outside.
            beside += inside > -1;
            missed += inside > -1 && with_border.at<cv::Vec4b>(y, x)[3] == 247;
            continue;
          }
          const auto hit = caster.cast(T_world_camera.translation(), T_world_camera.linear() * (ray / ray.z()), 0.01);
          if (!hit || hit->edge < 1e-6) continue;                                          // between two triangles
          if (std::abs(depth - hit->t) < 1e-3 * depth && depth - hit->t > 1e-6) continue;  // two surfaces in one
          const bool seen = depth <= hit->t + 1e-6;
          (seen ? visible : hidden) += 1;
          wrong += alpha != (seen ? 255 : 0);
          wrong += with_border.at<cv::Vec4b>(y, x)[3] != alpha;
        }
    }
  }
  EXPECT_GT(visible, 10000);
  EXPECT_GT(hidden, 1000);
  EXPECT_GT(outside, 50000);
  EXPECT_LE(wrong, (visible + hidden) / 1000);
  EXPECT_GT(beside, 1000);
  EXPECT_LE(missed, beside / 20) << "beyond corners: lines have no caps";
}

}  // namespace
}  // namespace foresight::thesis::occlusion_test
