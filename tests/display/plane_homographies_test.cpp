// Each triangle's corners, as a view sees them, come out where they are before the image's camera.
#include "display/plane_homographies.hpp"

#include "display/surface_records.hpp"
#include "gl/camera_block.hpp"
#include "tests/display/read_texels.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::plane_homographies_test {
namespace {

class PlaneHomographiesTest : public HeadlessTest {
 protected:
  static constexpr GLuint kUnit = 8;

  /// T_node_camera for the view, T_camera_node for the image, as homographies.comp reads them.
  std::vector<Eigen::Vector4d> homographies() const {
    std::vector<Eigen::Vector4f> of_view, of_image;
    for (const Pose& T_world_node : seen_.T_world_node) {
      const Eigen::Matrix4f m = (T_world_node.inverse() * T_world_view_).matrix().cast<float>();
      for (int row = 0; row < 3; ++row) of_view.push_back(m.row(row).transpose());
    }
    gl::append_node_rows(T_world_image_, taken_, of_image);
    gl::BufferTexture view_nodes(GL_RGBA32F, 16, "view nodes"), image_nodes(GL_RGBA32F, 16, "image nodes");
    view_nodes.assign(std::span<const Eigen::Vector4f>(of_view));
    image_nodes.assign(std::span<const Eigen::Vector4f>(of_image));
    const SurfaceRecords records(surface_);
    glBindTextureUnit(0, view_nodes.texture());
    glBindTextureUnit(2, records.triangles());
    glBindTextureUnit(16, image_nodes.texture());
    PlaneHomographies found;
    found.update(records.triangle_count(), kUnit);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    GLint texture = 0;
    glActiveTexture(GL_TEXTURE0 + kUnit);
    glGetIntegerv(GL_TEXTURE_BINDING_BUFFER, &texture);
    glActiveTexture(GL_TEXTURE0);
    return read_texels(static_cast<GLuint>(texture), 3 * records.triangle_count());
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  SurfacePatches surface_ = find_surface_patches(*scene_, {});
  SceneState seen_ = state_of(*scene_, 0.1), taken_ = state_of(*scene_);
  Pose T_world_view_ = usual_view();
  Pose T_world_image_ = usual_view() * Eigen::Translation3d(0.2, -0.1, 0.1) *
                        Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 3).normalized());
};

TEST_F(PlaneHomographiesTest, LeadFromTheViewToTheImage) {
  const auto rows = homographies();
  for (std::size_t t = 0; t < surface_.corners.size(); ++t) {
    const auto node =
        static_cast<std::size_t>(surface_.patches[static_cast<std::size_t>(surface_.patch_of_triangle[t])].node);
    const Pose T_view_node = T_world_view_.inverse() * seen_.T_world_node[node];
    const Pose T_image_node = T_world_image_.inverse() * taken_.T_world_node[node];
    for (const Eigen::Vector3d& corner : surface_.corners[t]) {
      const Eigen::Vector3d p = T_view_node * corner, ray = 3 * p;  // however long
      const Eigen::Vector3d q = T_image_node * corner;
      Eigen::Vector3d turned, m;
      for (int row = 0; row < 3; ++row) {
        const Eigen::Vector4d& r = rows[3 * t + static_cast<std::size_t>(row)];
        turned[row] = r.head<3>().dot(ray);
        m[row] = r.w();
      }
      if (m.norm() > 100) continue;  // seen edge-on: within 1 cm of the view's eye
      EXPECT_LT((turned / m.dot(ray) - q).norm(), 1e-4) << "triangle " << t;
    }
  }
}

TEST_F(PlaneHomographiesTest, TellHowFarThePlaneIsFromBoth) {
  const auto rows = homographies();
  for (std::size_t t = 0; t < surface_.corners.size(); ++t) {
    const auto& c = surface_.corners[t];
    const auto node =
        static_cast<std::size_t>(surface_.patches[static_cast<std::size_t>(surface_.patch_of_triangle[t])].node);
    const auto distance = [&](const Pose& T_camera_node) {
      const Eigen::Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      return std::abs((T_camera_node.linear() * n).dot(T_camera_node * c[0]));
    };
    const double of_view = distance(T_world_view_.inverse() * seen_.T_world_node[node]);
    const double of_image = distance(T_world_image_.inverse() * taken_.T_world_node[node]);
    if (of_view < 0.01) continue;  // edge-on
    Eigen::Matrix3d h;
    for (int row = 0; row < 3; ++row) h.row(row) = rows[3 * t + static_cast<std::size_t>(row)].head<3>().transpose();
    EXPECT_NEAR(std::abs(h.determinant()), of_image / of_view, 1e-3 * (1 + of_image / of_view)) << "triangle " << t;
  }
}

}  // namespace
}  // namespace foresight::plane_homographies_test
