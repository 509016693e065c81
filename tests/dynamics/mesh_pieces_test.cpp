#include "dynamics/mesh_pieces.hpp"

#include "tests/dynamics/solids.hpp"

namespace foresight::mesh_pieces_test {
namespace {

TEST(MeshPieces, ACrateIsAsManyPiecesAsItHasBoards) {
  const auto pieces = pieces_of(both(box_mesh({1, 1, 0.1f}), box_mesh({0.1f, 1, 1}, {2, 0, 0})));
  ASSERT_EQ(pieces.size(), 2u);
  for (const MeshPiece& piece : pieces) {
    EXPECT_TRUE(piece.convex);
    EXPECT_EQ(piece.ball_radius, 0);
    EXPECT_EQ(piece.mesh.vertices.size(), 8u);
    EXPECT_EQ(piece.mesh.triangles.size(), 12u);
  }
}

TEST(MeshPieces, TellsWhatIsHollowOrOpen) {
  Mesh open = box_mesh({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_FALSE(pieces_of(open)[0].convex);
  Mesh dented = box_mesh({1, 1, 1});  // its top pushed in to the middle
  dented.vertices.push_back({0, 0, 0});
  dented.triangles[2] = {4, 5, 8};
  dented.triangles[3] = {5, 7, 8};
  dented.triangles.push_back({7, 6, 8});
  dented.triangles.push_back({6, 4, 8});
  EXPECT_FALSE(pieces_of(dented)[0].convex);
  EXPECT_TRUE(pieces_of({}).empty());
}

TEST(MeshPieces, KnowsABall) {
  const auto pieces = pieces_of(ball_mesh(0.03f));
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].ball_radius, 0.03, 1e-6);
}

TEST(MeshPieces, TheCentreOfMassIsThatOfTheVolume) {
  const Solid solid = solid_of(both(box_mesh({1, 1, 1}), box_mesh({1, 1, 2}, {3, 0, 0})));
  EXPECT_NEAR(solid.volume, 3, 1e-6);
  EXPECT_TRUE(solid.centre.isApprox(Eigen::Vector3d(2, 0, 0), 1e-6));
  Mesh inside_out = box_mesh({1, 1, 1});
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(solid_of(inside_out).volume, 0);
}

}  // namespace
}  // namespace foresight::mesh_pieces_test
