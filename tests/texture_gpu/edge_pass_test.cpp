// blocks.comp, edge_tiles.comp, near_edges.comp and uncertain.comp against brute force.
#include "texture_gpu/edge_pass.hpp"

#include "scene/primitives.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/texture_gpu/pass_bench.hpp"

namespace foresight::edge_pass_test {
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
  EXPECT_GT(wanted, 100);
  EXPECT_LT(borderline, all / 50);
  // The preselection should only skip tiles where the exact test finds nothing.
  // It compares whole blocks with half of the tolerance: a few edges in a thousand are lost,
  // with a pixel on each side.
  EXPECT_LE(lost, std::max(3.0, 0.011 * wanted)) << "of " << wanted;
  EXPECT_EQ(invented, 0) << "of " << wanted;
}

INSTANTIATE_TEST_SUITE_P(Lenses, EdgesOfLenses, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

TEST_F(EdgePassTest, MarginsOfAllSizesAgreeWithTheExactTest) {
  for (double margin : {0.0, 0.5, 1.0, 1.2, 2.0, 4.5, 9.0}) {
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

// Of the box only the outermost pixels may be seen elsewhere: the margin belongs to what lies behind it.
TEST_F(EdgePassTest, OfTheNearSideOfAnEdgeOnlyTheOutermostPixelsAreUncertain) {
  const auto scene = small_scene();
  const reference::Camera camera = look(scene, small_lens("pinhole"), usual_view());
  const reference::RayCaster caster(*scene, state_of(*scene));
  const auto picture = reference::draw_face(camera.faces, 0, usual_view(), caster);
  const auto on_box = [&](std::size_t i) {
    return picture.surface[i] >= 3 && picture.surface[i] < 15;
  };  // after the table's two triangles
  int near_side = 0, far_side = 0, marked = 0, outermost = 0, marked_outermost = 0, said_to_be_far = 0,
      said_to_be_near = 0;
  for (int y = 5; y < picture.height - 5; ++y)
    for (int x = 5; x < picture.width - 5; ++x) {
      const auto i = static_cast<std::size_t>(y * picture.width + x);
      bool at_edge = false, all_behind = true, is_outermost = false;
      for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -4; dx <= 4; ++dx) {
          const auto k = static_cast<std::size_t>((y + dy) * picture.width + x + dx);
          at_edge |= on_box(k) != on_box(i);
          is_outermost |= std::abs(dx) + std::abs(dy) == 1 && !on_box(k);
          all_behind &= on_box(k) || picture.inverse_z[k] < 0.95 * picture.inverse_z[i];
        }
      if (!at_edge) continue;
      if (on_box(i) && all_behind) {
        ++(is_outermost ? outermost : near_side);
        (is_outermost ? marked_outermost : marked) += camera.uncertain[0][i] != 0;
        said_to_be_far += camera.uncertain[0][i] == 2;
      }
      far_side += !on_box(i) && camera.uncertain[0][i] == 2;
      said_to_be_near += !on_box(i) && camera.uncertain[0][i] == 1;
    }
  EXPECT_GT(near_side, 100);
  EXPECT_GT(outermost, 40);
  EXPECT_GT(marked_outermost, 0.8 * outermost);
  EXPECT_LE(marked, 4) << "where its top folds away behind a step of its slanted outline";
  EXPECT_GT(far_side, 100);
  EXPECT_LE(said_to_be_far, 4) << "the same";
  EXPECT_LE(said_to_be_near, 4) << "of the board behind it";
}

/// A solid, its centre `height` above a table of 2 m.
std::shared_ptr<const SceneModel> above_table(Mesh solid, double height) {
  Pose T_world_solid = Pose::Identity();
  T_world_solid.translation().z() = height;
  return std::make_shared<SceneModel>(
      std::vector<Node>{{"table", plane_scene(2, 2)->nodes()[0].mesh, -1, Pose::Identity()},
                        {"solid", std::move(solid), -1, T_world_solid}});
}

/// Which of the two is seen at each pixel of a pinhole: 0 nothing, 1 the table, 2 the solid.
std::vector<int> seen_nodes(const SceneModel& scene, const reference::Camera& camera, const Pose& T_world_camera) {
  const reference::RayCaster caster(scene, state_of(scene));
  const auto picture = reference::draw_face(camera.faces, 0, T_world_camera, caster);
  std::vector<int> out;
  for (unsigned triangle : picture.surface) out.push_back(triangle == 0 ? 0 : triangle <= 2 ? 1 : 2);
  return out;
}

// Where a box stands on a table, both surfaces meet: nothing hides there, whatever the angle.
TEST_F(EdgePassTest, AConcaveCreaseIsCertain) {
  const auto scene = above_table(make_box({0.3, 0.3, 0.3}), 0.15);
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(-0.9, 0, 0.9), {-1.2, 0.1, 0.4}, {-0.7, -0.5, 0.5}, {-0.3, 0, 1.3}}) {
    const Pose T_world_camera = look_at(eye, {0, 0, 0.1});
    const reference::Camera camera = look(scene, small_lens("pinhole"), T_world_camera);
    const auto nodes = seen_nodes(*scene, camera, T_world_camera);
    int creases = 0, uncertain = 0, others = 0;
    for (int y = 6; y < 114; ++y)
      for (int x = 6; x < 154; ++x) {
        const auto at = [&](int dx, int dy) { return static_cast<std::size_t>((y + dy) * 160 + x + dx); };
        others += camera.uncertain[0][at(0, 0)] != 0;
        // The box above the table, and nothing else within the margin to both sides.
        if (nodes[at(0, 0)] != 2 || nodes[at(0, 1)] != 1) continue;
        bool straight = true;
        for (int d = -5; d <= 5; ++d) straight = straight && nodes[at(d, -3)] == 2 && nodes[at(d, 4)] == 1;
        if (!straight) continue;
        ++creases;
        for (int d = -3; d <= 4; ++d) uncertain += camera.uncertain[0][at(0, d)] != 0;
      }
    EXPECT_GT(creases, 10) << eye.transpose();
    EXPECT_EQ(uncertain, 0) << eye.transpose();
    EXPECT_GT(others, 30) << "its silhouettes are uncertain";
  }
}

/// How much of the far side within the margin is marked, on all sides of a solid above the table, of
/// the solid's outermost pixels, and of those within.
struct Margins {
  int far = 0, missed = 0, outermost = 0, outermost_marked = 0, inner_marked = 0;
};
Margins margins(const reference::Camera& camera, const std::vector<int>& nodes, double margin) {
  Margins out;
  const int reach = static_cast<int>(margin);
  for (int y = reach; y < camera.faces.height - reach; ++y)
    for (int x = reach; x < camera.faces.width - reach; ++x) {
      const auto at = [&](int dx, int dy) { return static_cast<std::size_t>((y + dy) * camera.faces.width + x + dx); };
      bool beside = false;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx)
          beside = beside || (dx * dx + dy * dy <= margin * margin && nodes[at(dx, dy)] == 2);
      const bool marked = camera.uncertain[0][at(0, 0)] != 0;
      if (nodes[at(0, 0)] == 2) {
        const bool outermost =
            nodes[at(1, 0)] == 1 || nodes[at(-1, 0)] == 1 || nodes[at(0, 1)] == 1 || nodes[at(0, -1)] == 1;
        out.outermost += outermost;
        (outermost ? out.outermost_marked : out.inner_marked) += marked;
      }
      if (nodes[at(0, 0)] != 1 || !beside) continue;
      ++out.far;
      out.missed += !marked;
    }
  return out;
}

// A silhouette hides what a shift of the image would show: on all four sides, however thin the solid
// is, at whatever angle the far surface is seen, and where the near surface curves away.
TEST_F(EdgePassTest, SilhouettesAreMarkedAllAround) {
  struct Case {
    const char* name;
    Mesh solid;
    double height;
    Eigen::Vector3d eye;
  };
  constexpr double kMargin = 3;
  const Eigen::Vector3d above(-0.2, 0.02, 1.3), slanted(-1.0, -0.4, 0.7), grazing(-0.95, 0.1, 0.36);
  const std::vector<Case> cases{{"plate", make_box({0.3, 0.2, 0.02}), 0.25, above},
                                {"plate, slanted", make_box({0.3, 0.2, 0.02}), 0.25, slanted},
                                {"plate, grazing", make_box({0.2, 0.2, 0.02}), 0.12, grazing},
                                {"tilted box", make_box({0.2, 0.2, 0.2}), 0.4, slanted},
                                {"one pixel", make_box({0.6, 0.008, 0.008}), 0.25, above},
                                {"two pixels", make_box({0.018, 0.5, 0.01}), 0.25, above},
                                {"three pixels", make_box({0.5, 0.026, 0.02}), 0.25, slanted},
                                {"one pixel, grazing", make_box({0.008, 0.4, 0.008}), 0.12, grazing},
                                {"sphere", make_sphere(0.12), 0.3, slanted},
                                {"sphere, low", make_sphere(0.06), 0.12, above},
                                {"cylinder", make_cylinder(0.05, 0.3), 0.3, slanted},
                                {"cylinder from above", make_cylinder(0.1, 0.1), 0.2, above}};
  for (const Case& c : cases) {
    const auto scene = above_table(c.solid, c.height);
    const Pose T_world_camera = look_at(c.eye, {0, 0, 0.1});
    const reference::Camera camera =
        look(scene, small_lens("pinhole"), T_world_camera, {.memory_bytes = kMemory, .margin_px = kMargin});
    const Margins found = margins(camera, seen_nodes(*scene, camera, T_world_camera), kMargin);
    EXPECT_GT(found.far, 60) << c.name;
    EXPECT_EQ(found.missed, 0) << c.name << ", of " << found.far;
    // Faces that fold away behind the edge, and curved ones, lie behind the near surface, too.
    EXPECT_LE(found.inner_marked, found.far / 8) << c.name;
    const auto named = [&](const char* word) { return std::string_view(c.name).find(word) != std::string_view::npos; };
    if (named("one pixel")) {
      EXPECT_EQ(found.outermost_marked, 0) << c.name << ": all of it would lose its colours";
    } else if (!named("pixels")) {
      EXPECT_GT(found.outermost_marked, 0.8 * found.outermost) << c.name;
    }
  }
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
}  // namespace foresight::edge_pass_test
