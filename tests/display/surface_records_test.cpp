#include "display/surface_records.hpp"

#include "tests/display/read_texels.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::surface_records_test {
namespace {

using SurfaceRecordsTest = HeadlessTest;

TEST_F(SurfaceRecordsTest, HoldPlanesAndPatches) {
  const SurfacePatches surface = find_surface_patches(*small_scene(), {});
  const SurfaceRecords records(surface);
  const auto triangles = read_texels(records.triangles(), 2 * surface.corners.size());
  const auto patches = read_texels(records.patches(), 4 * surface.patches.size());
  for (std::size_t t = 0; t < surface.corners.size(); ++t) {
    const auto patch = static_cast<std::size_t>(triangles[2 * t + 1].x());
    EXPECT_EQ(static_cast<int>(patch), surface.patch_of_triangle[t]);
    EXPECT_EQ(triangles[2 * t + 1].y(), surface.patches[patch].node);
    EXPECT_NEAR(triangles[2 * t].head<3>().norm(), 1, 1e-6);
    for (const Eigen::Vector3d& corner : surface.corners[t])
      EXPECT_NEAR(triangles[2 * t].head<3>().dot(corner), triangles[2 * t].w(), 1e-6) << "corners lie on the plane";
  }
  for (std::size_t i = 0; i < surface.patches.size(); ++i) {
    const Patch& p = surface.patches[i];
    EXPECT_LT((patches[4 * i].head<3>() - p.origin).norm(), 1e-6);
    EXPECT_LT((patches[4 * i + 1].head<3>() - p.eu).norm(), 1e-6);
    EXPECT_LT((patches[4 * i + 2].head<3>() - p.ev).norm(), 1e-6);
    EXPECT_EQ(Eigen::Vector2i(static_cast<int>(patches[4 * i].w()), static_cast<int>(patches[4 * i + 1].w())), p.cells);
    EXPECT_EQ(static_cast<int>(patches[4 * i + 2].w()), p.first_chart);
    EXPECT_LT((patches[4 * i + 3].head<2>() - p.cell_size()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace foresight::surface_records_test
