// blocks.comp, edge_tiles.comp and uncertain.comp against brute force.
#include "texture_gpu/edge_pass.hpp"

#include "tests/support/golden.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/texture_gpu/pass_bench.hpp"

namespace foresight {
namespace {

using reference::Answer;

constexpr std::uint64_t kMemory = 6 << 20;

PosedImage without_picture(const SceneState& state, const Lens& lens, const Pose& T_world_camera) {
  return {cv::Mat(lens.height(), lens.width(), CV_8UC3, cv::Scalar::all(90)), state.time, T_world_camera, state};
}

class EdgePassTest : public HeadlessTest {
 protected:
  reference::Camera look(const std::shared_ptr<const SceneModel>& scene, const Lens& lens, const Pose& T_world_camera,
                         TextureOptions options = {.memory_bytes = kMemory}) {
    bench_ = std::make_unique<PassBench>(scene, std::vector{lens}, options);
    bench_->look({without_picture(state_of(*scene), lens, T_world_camera)});
    return bench_->camera(0);
  }
  std::unique_ptr<PassBench> bench_;
};
class EdgesOfLenses : public EdgePassTest, public testing::WithParamInterface<const char*> {};

TEST_P(EdgesOfLenses, BlocksHoldTheExtremesOfTheirPixels) {
  const reference::Camera camera = look(small_scene(), small_lens(GetParam()), usual_view());
  const auto blocks = bench_->blocks(0);
  std::size_t at = 0;
  int dropped = 0, with_model = 0;
  for (std::size_t face = 0; face < camera.depth.size(); ++face) {
    const int columns = (camera.faces.width + 3) / 4;
    const auto expected = reference::depth_blocks(camera.depth[face]);
    for (std::size_t i = 0; i < expected.size(); ++i, ++at) {
      const reference::Block& e = expected[i];
      with_model += e.largest > 0;
      ASSERT_NEAR(blocks[at].y(), e.largest, 1e-6 * e.largest);
      if (e.largest > 0 && blocks[at].x() > 1e29f) {
        // Said to be hidden: then no pixel of the block may be in the image.
        ++dropped;
        for (int k = 0; k < 16; ++k) {
          const int x = static_cast<int>(i) % columns * 4 + k % 4, y = static_cast<int>(i) / columns * 4 + k / 4;
          const Eigen::Vector3d ray((x - camera.faces.cx) / camera.faces.fx, (y - camera.faces.cy) / camera.faces.fy,
                                    1);
          const auto pixel = camera.lens.project(gl::Faces::rotation(static_cast<int>(face)).transpose() * ray);
          ASSERT_FALSE(pixel && pixel->x() > -0.5 && pixel->y() > -0.5 && pixel->x() < camera.lens.width() - 0.5 &&
                       pixel->y() < camera.lens.height() - 0.5);
        }
      } else if (e.largest > 0) {
        ASSERT_NEAR(std::abs(blocks[at].x()), e.least, 1e-6 * e.least);
        ASSERT_EQ(blocks[at].x() < 0, e.has_hole);
      } else {
        ASSERT_TRUE(blocks[at].x() < 0 || blocks[at].x() > 1e29f) << "an empty block hides nothing";
      }
    }
  }
  EXPECT_GT(with_model, 150);
  EXPECT_LT(dropped, with_model) << "the test would compare nothing";
}

TEST_P(EdgesOfLenses, UncertainPixelsAreThoseOfTheExactTest) {
  const reference::Camera camera = look(small_scene(), small_lens(GetParam()), usual_view());
  int wanted = 0, lost = 0, invented = 0, borderline = 0, all = 0;
  for (std::size_t face = 0; face < camera.depth.size(); ++face) {
    const auto expected =
        reference::uncertain_edges(camera.depth[face], bench_->options.margin_px, bench_->options.depth_tolerance);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ++all;
      wanted += expected[i] == Answer::yes;
      borderline += expected[i] == Answer::borderline;
      lost += expected[i] == Answer::yes && !camera.uncertain[face][i];
      invented += expected[i] == Answer::no && camera.uncertain[face][i];
    }
  }
  RecordProperty("wanted", wanted);
  RecordProperty("lost", lost);
  RecordProperty("invented", invented);
  EXPECT_GT(wanted, 150);
  EXPECT_LT(borderline, all / 50);
  // The preselection should only skip tiles where the exact test finds nothing.
  // It compares whole blocks with half of the tolerance: one or two pixels in a thousand are lost
  // where the found one lies at the far end of the margin.
  EXPECT_LE(lost, 0.003 * wanted) << "of " << wanted;
  EXPECT_EQ(invented, 0) << "of " << wanted;
}

INSTANTIATE_TEST_SUITE_P(Lenses, EdgesOfLenses, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

TEST_F(EdgePassTest, MarginsOfAllSizesAgreeWithTheExactTest) {
  for (double margin : {0.0, 0.5, 1.0, 2.0, 4.5, 9.0}) {
    const reference::Camera camera =
        look(small_scene(), small_lens("pinhole"), usual_view(), {.memory_bytes = kMemory, .margin_px = margin});
    const auto expected = reference::uncertain_edges(camera.depth[0], margin, 0.02);
    int wrong = 0, found = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      found += camera.uncertain[0][i] != 0;
      // A margin of zero turns the test off: nothing is uncertain.
      const bool wanted = margin > 0 && expected[i] == Answer::yes;
      wrong += (expected[i] != Answer::borderline || margin == 0) && wanted != (camera.uncertain[0][i] != 0);
    }
    EXPECT_EQ(wrong, 0) << "margin " << margin << ", " << found << " found";
    EXPECT_EQ(found > 0, margin > 0);
  }
}

// 1/z of a plane is linear in its picture: however flat the view, it is no edge.
TEST_F(EdgePassTest, APlaneAtAGrazingAngleIsCertain) {
  for (double height : {0.5, 0.1, 0.03, 0.015})
    for (const char* kind : {"pinhole", "plumb_bob", "wide_fisheye"}) {
      const reference::Camera camera = look(plane_scene(6, 4), small_lens(kind), look_at({-2, 0.1, height}, {1, 0, 0}));
      int seen = 0, uncertain = 0;
      for (std::size_t face = 0; face < camera.depth.size(); ++face)
        for (std::size_t i = 0; i < camera.uncertain[face].size(); ++i) {
          seen += camera.depth[face].inverse_z[i] > 0;
          uncertain += camera.uncertain[face][i] != 0;
        }
      EXPECT_GT(seen, 1500) << kind << " at " << height;
      EXPECT_EQ(uncertain, 0) << kind << " at " << height << " m, of " << seen;
    }
}

// A pixel of the box with nothing nearer around it keeps its colour, however far the surface behind is.
TEST_F(EdgePassTest, TheNearSideOfAnEdgeIsCertain) {
  const auto scene = small_scene();
  const reference::Camera camera = look(scene, small_lens("pinhole"), usual_view());
  const reference::RayCaster caster(*scene, state_of(*scene));
  const auto picture = reference::draw_face(camera.faces, 0, usual_view(), caster);
  const auto on_box = [&](std::size_t i) {
    return picture.surface[i] >= 3 && picture.surface[i] < 15;
  };  // after the table's two triangles
  int near_side = 0, far_side = 0;
  for (int y = 5; y < picture.height - 5; ++y)
    for (int x = 5; x < picture.width - 5; ++x) {
      const auto i = static_cast<std::size_t>(y * picture.width + x);
      bool at_edge = false, all_behind = true;
      for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -4; dx <= 4; ++dx) {
          const auto k = static_cast<std::size_t>((y + dy) * picture.width + x + dx);
          at_edge |= on_box(k) != on_box(i);
          all_behind &= on_box(k) || picture.inverse_z[k] < 0.95 * picture.inverse_z[i];
        }
      if (!at_edge) continue;
      if (on_box(i) && all_behind) {
        ++near_side;
        EXPECT_FALSE(camera.uncertain[0][i]) << "pixel " << x << ", " << y;
      }
      far_side += !on_box(i) && camera.uncertain[0][i];
    }
  EXPECT_GT(near_side, 100);
  EXPECT_GT(far_side, 100);
}

TEST_F(EdgePassTest, MatchesTheGoldenMask) {
  const reference::Camera camera = look(small_scene(), small_lens("pinhole"), usual_view());
  cv::Mat picture(camera.faces.height, camera.faces.width, CV_8UC1);
  for (std::size_t i = 0; i < camera.uncertain[0].size(); ++i)
    picture.data[i] = camera.uncertain[0][i] ? 255 : camera.depth[0].inverse_z[i] > 0 ? 96 : 0;
  // The mask follows the silhouettes: where these move by a pixel centre (1 in 1000), so do up to
  // seven pixels of a margin of three.
  EXPECT_TRUE(matches_golden(picture, "uncertain", {1, 1, 0.01}));
}

}  // namespace
}  // namespace foresight
