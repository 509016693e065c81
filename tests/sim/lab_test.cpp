#include "sim/lab.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "sim/motion.hpp"

namespace foresight::sim {
namespace {

const Lab& lab() {
  static const Lab built = make_lab(0.004, 1);
  return built;
}

// The renderer skips facets seen from behind, which is right only for closed solids.
TEST(Lab, SolidsAreClosedAndFaceOutwards) {
  for (const Part& part : lab().parts) {
    if (part.name == "room") continue;  // sheets that face the inside of the room
    const Mesh mesh = mesh_of(part);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    double volume = 0;
    for (const auto& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const auto a = t[k], b = t[(k + 1) % 3];
        balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
      volume += mesh.vertices[t[0]].cast<double>().dot(
                    mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>())) /
                6;
    }
    for (const auto& [edge, sum] : balance)
      ASSERT_EQ(sum, 0) << part.name << ": edge " << edge.first << " - " << edge.second << " is open";
    EXPECT_GT(volume, 0) << part.name;
  }
}

TEST(Lab, NamesAreUniqueAndThePlateMoves) {
  std::set<std::string> names;
  std::size_t triangles = 0;
  for (const Part& part : lab().parts) {
    EXPECT_TRUE(names.insert(part.name).second) << part.name;
    triangles += part.facets.size();
  }
  EXPECT_EQ(lab().parts[lab().plate].name, "plate");
  EXPECT_GT(triangles, 1000u);
  EXPECT_LT(triangles, 5000u);
}

TEST(Motion, IsSmoothAndStaysOverTheTable) {
  for (double t = 0; t < 60; t += 1.0 / 30) {
    const Pose a = T_world_camera_at(t), b = T_world_camera_at(t + 1.0 / 30);
    EXPECT_LT((a.translation() - b.translation()).norm(), 0.03);  // 0.9 m/s
    EXPECT_LT(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle(), 0.05);
    EXPECT_NEAR(a.linear().determinant(), 1, 1e-12);
    EXPECT_GT(a.translation().z(), 0.3);
    const Eigen::Vector3d plate = T_world_plate_at(t).translation();
    EXPECT_LT(std::abs(plate.y()), 0.25);
    EXPECT_LT(plate.x(), -0.15) << "would touch the boxes";
  }
}

}  // namespace
}  // namespace foresight::sim
