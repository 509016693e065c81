#include "sim/lab.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "sim/head_path.hpp"
#include "sim/motion.hpp"
#include "sim/polygons.hpp"

namespace foresight::sim::lab_test {
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

TEST(Lab, NamesAreUniqueAndTheArmMoves) {
  std::set<std::string> names;
  for (const Part& part : lab().parts) EXPECT_TRUE(names.insert(part.name).second) << part.name;
  EXPECT_EQ(lab().find("stand"), lab().arm);
  for (std::size_t i = 0; i < arm_joints().size(); ++i) {
    const Part& link = lab().parts[static_cast<std::size_t>(lab().arm) + i + 1];
    EXPECT_EQ(link.name, arm_joints()[i].child);
    EXPECT_TRUE(link.moves);
  }
}

TEST(Lab, HasTheSizeOfARealModel) {
  EXPECT_NEAR(polygons_of(lab()).count, 1936, 0.02 * 1936);
}

TEST(Polygons, ABoxHasSixAndAPrismItsSidesAndLids) {
  Lab small;
  small.parts.resize(2);
  add_box(small.parts[0].facets, {0, 0, 0}, {1, 2, 3}, 0, BoxPaint::all(0));
  add_turned(small.parts[1].facets, {{0, 0, 0}, {0.5f, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}}, 7, 1, 2);
  const Polygons polygons = polygons_of(small);
  EXPECT_EQ(polygons.count, 6 + 7 + 2);
  EXPECT_EQ(polygons.of_facet[0], polygons.of_facet[1]);
}

TEST(Motion, OfTheHeadIsSmoothAndInTheRoom) {
  const RoomCheck room(lab());
  for (double t = 0; t < 24; t += 1.0 / 30) {
    const Pose a = T_world_camera_at(t), b = T_world_camera_at(t + 1.0 / 30);
    EXPECT_LT((a.translation() - b.translation()).norm(), 0.04) << t;  // 1.2 m/s
    EXPECT_LT(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle(), 0.07) << t;
    EXPECT_NEAR(a.linear().determinant(), 1, 1e-12);
    const LabState state = lab_state_at(lab(), t);
    EXPECT_EQ(room.fault(a.translation(), state), "") << t;
    EXPECT_EQ(room.fault((a * T_left_right()).translation(), state), "") << t;
  }
}

TEST(RoomCheck, NamesWhatIsWrong) {
  const RoomCheck room(lab());
  const LabState state = lab().at_rest();
  EXPECT_EQ(room.fault({-0.8, 0, 0.5}, state), "");
  EXPECT_EQ(room.fault({3, 0, 0.5}, state), "has left the lab");
  EXPECT_EQ(room.fault({0, 0.1, -0.015}, state), "is inside 'table'");
  EXPECT_EQ(room.fault({0.2, 0.30, 0.1}, state), "is inside 'carton'");
  EXPECT_EQ(room.fault({0.0, 0.7, 0.006}, state), "touches 'table'");
}

}  // namespace
}  // namespace foresight::sim::lab_test
