// What is out of view or behind walls is not drawn, and nobody can tell by the picture.
#include <random>

#include "gl/raster_pass.hpp"
#include "gl/read_texture.hpp"
#include "sim/building.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::gl::culling_test {
namespace {

std::vector<GLuint> surfaces(const FaceImages& images) {
  std::vector<GLuint> out(static_cast<std::size_t>(images.faces.width * images.faces.height * images.faces.count));
  glGetTextureImage(images.surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(4 * out.size()),
                    out.data());
  return out;
}

class CullingTest : public HeadlessTest {
 protected:
  struct Drawn {
    std::vector<GLuint> surfaces;
    std::size_t triangles = 0;
  };
  Drawn draw(RasterPass& raster, RasterPass::LeavesOut what, const Pose& from, const SceneState& state,
             const FaceImages& into) const {
    raster.leave_out(what);
    raster(from, state, into);
    return {surfaces(into), raster.triangles()};
  }
  Pose anywhere(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    std::uniform_real_distribution any(0.0, 1.0);
    std::normal_distribution some(0.0, 1.0);
    Pose out = Pose::Identity();
    out.translation() = low + Eigen::Vector3d(any(random_), any(random_), any(random_)).cwiseProduct(high - low);
    out.linear() =
        Eigen::Quaterniond(some(random_), some(random_), some(random_), some(random_)).normalized().toRotationMatrix();
    return out;
  }
  /// In a room or a doorway, not within a wall.
  static bool in_the_open(const CellGraph& graph, const Eigen::Vector3d& p) {
    const double off = sim::kHalfWall + 2 * kNearPlane;  // closer, a wall is not drawn
    const Eigen::Vector3d wall(off, off, 2 * kNearPlane);
    const auto in_room = [&](const Cell& cell) {
      return Eigen::AlignedBox3d(cell.box.min() + wall, cell.box.max() - wall).contains(p);
    };
    const auto in_doorway = [&](const Portal& portal) {
      Eigen::AlignedBox3d way;
      for (const Eigen::Vector3d& corner : portal.corners) way.extend(corner);
      for (int axis = 0; axis < 2; ++axis)
        if (way.sizes()[axis] == 0) {
          way.min()[axis] -= sim::kHalfWall;
          way.max()[axis] += sim::kHalfWall;
        }
      return way.contains(p);
    };
    return std::ranges::any_of(graph.cells(), in_room) || std::ranges::any_of(graph.portals(), in_doorway);
  }
  Pose anywhere_in(const SceneModel& building) {
    Eigen::AlignedBox3d all;
    for (const Cell& cell : building.cells()->cells()) all.extend(cell.box);
    for (;;)
      if (const Pose out = anywhere(all.min(), all.max()); in_the_open(*building.cells(), out.translation()))
        return out;
  }
  std::mt19937 random_{1};
};

// 1,000 views, a tenth of them from outside: the same triangle at every pixel.
TEST_F(CullingTest, WhatWallsHideIsAtNoPixel) {
  const SceneModel building = sim::make_building({.rooms_x = 4, .rooms_y = 3, .triangles = 12'000});
  RasterPass raster(std::make_shared<SceneBuffers>(building), true);
  const SceneState rest{{}, StateStatus::exact, building.rest_poses()};
  const FaceImages images(faces_for(small_lens("pinhole"), 0), true);
  std::size_t all = 0, in_view = 0, seen = 0;
  for (int i = 0; i < 1000; ++i) {
    const Pose from = i % 10 == 0 ? anywhere({-4, -4, 2.9}, {24, 16, 6}) : anywhere_in(building);
    const Drawn whole = draw(raster, RasterPass::LeavesOut::nothing, from, rest, images);
    const Drawn view = draw(raster, RasterPass::LeavesOut::out_of_view, from, rest, images);
    const Drawn walls = draw(raster, RasterPass::LeavesOut::behind_walls, from, rest, images);
    ASSERT_EQ(whole.surfaces, view.surfaces) << "view " << i;
    ASSERT_EQ(whole.surfaces, walls.surfaces)
        << "view " << i << " from " << from.translation().transpose() << " to " << from.linear().col(2).transpose();
    EXPECT_LE(view.triangles, whole.triangles);
    EXPECT_LE(walls.triangles, view.triangles);
    all += whole.triangles;
    in_view += view.triangles;
    seen += walls.triangles;
  }
  std::printf("drawn: %.1f %% of what is in view, which is %.1f %% of all\n",
              100.0 * static_cast<double>(seen) / static_cast<double>(in_view),
              100.0 * static_cast<double>(in_view) / static_cast<double>(all));
  EXPECT_LT(in_view, all / 2);
  EXPECT_LT(seen, in_view / 2);
}

// What is hidden is found by what was drawn before, of whatever view: at each pixel the same depth is seen, and the
// same triangle but for ties.
TEST_F(CullingTest, WhatIsHiddenIsAtNoPixel) {
  SceneModel building = sim::make_building({.rooms_x = 4, .rooms_y = 3, .triangles = 12'000});
  RasterPass raster(std::make_shared<SceneBuffers>(building), true);
  const SceneState rest{{}, StateStatus::exact, building.rest_poses()};
  const FaceImages images(faces_for(small_lens("pinhole"), 0), true);
  std::size_t portals = 0, hidden = 0, ties = 0, pixels = 0;
  for (int i = 0; i < 300; ++i) {
    const Pose from = i % 10 == 0 ? anywhere({-4, -4, 2.9}, {24, 16, 6}) : anywhere_in(building);
    const Drawn walls = draw(raster, RasterPass::LeavesOut::behind_walls, from, rest, images);
    const cv::Mat depth = read_texture(images.depth);
    for (int time = 0; time < 2; ++time) {  // with what another view showed as its guess, and with its own
      const Drawn rest_of = draw(raster, RasterPass::LeavesOut::hidden, from, rest, images);
      const cv::Mat again = read_texture(images.depth);
      ASSERT_EQ(cv::countNonZero(depth != again), 0) << "view " << i << " from " << from.translation().transpose();
      for (std::size_t p = 0; p < walls.surfaces.size(); ++p) ties += walls.surfaces[p] != rest_of.surfaces[p];
      pixels += walls.surfaces.size();
      EXPECT_LE(rest_of.triangles, walls.triangles);
      if (time == 0) continue;
      portals += walls.triangles;
      hidden += rest_of.triangles;
    }
  }
  std::printf("drawn: %.1f %% of what portals show; %zu ties of %zu pixels\n",
              100.0 * static_cast<double>(hidden) / static_cast<double>(portals), ties, pixels);
  EXPECT_LT(hidden, portals);
  EXPECT_LT(ties, pixels / 1000);
}

// A thing behind another one that moves away is seen at once, though nobody has seen it last time.
TEST_F(CullingTest, WhatComesOutFromBehindIsSeenAtOnce) {
  const auto scene = small_scene();
  RasterPass raster(std::make_shared<SceneBuffers>(*scene), true);
  const FaceImages images(faces_for(small_lens("pinhole"), 0), true);
  for (const double x : {0.0, 0.4, -0.4, 0.1}) {
    const SceneState state = state_of(*scene, x);
    for (const Pose& from : {usual_view(), look_at({0.9, 0.2, 0.15}, {0, 0, 0.1})})
      EXPECT_EQ(draw(raster, RasterPass::LeavesOut::nothing, from, state, images).surfaces,
                draw(raster, RasterPass::LeavesOut::hidden, from, state, images).surfaces)
          << x;
  }
}

TEST_F(CullingTest, AWholeSphereIsSeenThroughDoors) {
  const SceneModel building = sim::make_building({.rooms_x = 3, .rooms_y = 2, .triangles = 3'000, .seed = 2});
  RasterPass raster(std::make_shared<SceneBuffers>(building), true);
  const SceneState rest{{}, StateStatus::exact, building.rest_poses()};
  const FaceImages images(faces_for(small_lens("wide_fisheye"), 2), true);
  ASSERT_EQ(images.faces.count, 6);
  for (int i = 0; i < 60; ++i) {
    const Pose from = anywhere_in(building);
    const auto all = draw(raster, RasterPass::LeavesOut::nothing, from, rest, images).surfaces;
    EXPECT_EQ(all, draw(raster, RasterPass::LeavesOut::behind_walls, from, rest, images).surfaces) << i;
    const auto unhidden = draw(raster, RasterPass::LeavesOut::hidden, from, rest, images).surfaces;
    std::size_t ties = 0;
    for (std::size_t p = 0; p < all.size(); ++p) ties += all[p] != unhidden[p];
    EXPECT_LT(ties, all.size() / 1000) << i;
  }
}

// A thing that was carried into another room is seen there, and so is one that nobody put into a cell.
TEST_F(CullingTest, WhatMovesIsHiddenByNoWall) {
  const SceneModel building = sim::make_building({.rooms_x = 3, .rooms_y = 1, .triangles = 600});
  RasterPass raster(std::make_shared<SceneBuffers>(building), true);
  SceneState state{{}, StateStatus::exact, building.rest_poses()};
  const FaceImages images(faces_for(small_lens("pinhole"), 0), true);
  const int thing = *building.find("room_2_0_thing_0");
  state.T_world_node[static_cast<std::size_t>(thing)].translation() = Eigen::Vector3d(1.5, 2, 1);
  Pose from = look_at({4.5, 2, 1.5}, {1.5, 2, 1.2});
  const Drawn walls = draw(raster, RasterPass::LeavesOut::behind_walls, from, state, images);
  EXPECT_EQ(walls.surfaces, draw(raster, RasterPass::LeavesOut::nothing, from, state, images).surfaces);
  unsigned first = 1;
  for (int i = 0; i < thing; ++i)
    first += static_cast<unsigned>(building.nodes()[static_cast<std::size_t>(i)].mesh.triangles.size());
  const auto last =
      first + static_cast<unsigned>(building.nodes()[static_cast<std::size_t>(thing)].mesh.triangles.size());
  EXPECT_GT(std::ranges::count_if(walls.surfaces, [&](GLuint s) { return s >= first && s < last; }), 50);
}

}  // namespace
}  // namespace foresight::gl::culling_test
