#include "gl/level_pass.hpp"

#include "tests/support/fine_scene.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::gl::level_pass_test {
namespace {

struct Drawn {
  std::vector<float> depth;
  std::vector<GLuint> surface;
  std::vector<Eigen::Vector4f> planes;
};

Drawn read(const FaceImages& images) {
  const auto pixels = static_cast<std::size_t>(images.faces.width * images.faces.height * images.faces.count);
  Drawn out{std::vector<float>(pixels), std::vector<GLuint>(pixels), std::vector<Eigen::Vector4f>(pixels)};
  const auto bytes = static_cast<GLsizei>(4 * pixels);
  glGetTextureImage(images.depth.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, bytes, out.depth.data());
  glGetTextureImage(images.surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, bytes, out.surface.data());
  if (images.planes) glGetTextureImage(images.planes.name(), 0, GL_RGBA, GL_FLOAT, 4 * bytes, out.planes.data());
  return out;
}

/// A finely divided block beside a ball, each with parts: its sides, as far as their triangles point.
class LevelPassTest : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    scene_ = fine_scene(6000);
    for (const Node& node : scene_->nodes())
      for (const auto& [a, b, c] : node.mesh.triangles) {
        const auto& v = node.mesh.vertices;
        const Eigen::Vector3f n = (v[b] - v[a]).cross(v[c] - v[a]);
        Eigen::Index axis = 0;
        n.cwiseAbs().maxCoeff(&axis);
        parts_.push_back(static_cast<int>(2 * axis + (n[axis] > 0)));
      }
    levels_ = std::make_shared<const SceneLevels>(*scene_, parts_);
    pass_.emplace(std::make_shared<const LevelBuffers>(*scene_, levels_));
  }
  Drawn draw(const LevelBlend& blend, LevelTransition transition, const char* lens = "pinhole") {
    const FaceImages images(faces_for(small_lens(lens), 4), true, true);
    LevelPlan plan;
    plan.transition = transition;
    plan.blends.assign(scene_->nodes().size(), blend);
    const SceneState state = state_of(*scene_);
    (*pass_)(eye_, state, plan, pass_->seen_from(eye_, state, images.faces), images);
    return read(images);
  }
  /// Of pixels with model on both sides, the largest difference in depth, m; and how many have it on one side only.
  static std::pair<double, int> apart(const Drawn& a, const Drawn& b) {
    std::pair<double, int> out{0, 0};
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
      if ((a.depth[i] == 0) != (b.depth[i] == 0))
        ++out.second;
      else if (a.depth[i] > 0)
        out.first = std::max(out.first, std::abs(kNearPlane / double{a.depth[i]} - kNearPlane / double{b.depth[i]}));
    }
    return out;
  }

  std::shared_ptr<const SceneModel> scene_;
  std::vector<int> parts_;
  std::shared_ptr<const SceneLevels> levels_;
  std::optional<LevelPass> pass_;
  const Pose eye_ = look_at({-1.2, -0.7, 0.9}, {0.1, 0.3, 0.2});
};

TEST_F(LevelPassTest, TheMeshItselfIsWhatTheOtherPassDraws) {
  for (const char* lens : {"pinhole", "wide_fisheye"}) {
    const FaceImages images(faces_for(small_lens(lens), 4), true);
    RasterPass(std::make_shared<SceneBuffers>(*scene_), true)(eye_, state_of(*scene_), images);
    const Drawn expected = read(images), got = draw({}, LevelTransition::geomorph, lens);
    EXPECT_EQ(expected.depth, got.depth) << lens;
    // Vertices come in another order, which decides nothing but equal depths.
    std::size_t other = 0, seen = 0;
    for (std::size_t i = 0; i < got.surface.size(); ++i) {
      seen += got.surface[i] != 0;
      other += got.surface[i] != expected.surface[i];
    }
    EXPECT_GT(seen, 400u) << lens;
    EXPECT_LE(other, 1 + seen / 500) << lens;
  }
}

// Shells of distance share the pixels with model of what they are parts of, at a level as in full.
TEST_F(LevelPassTest, PartsOfAViewMakeUpTheWhole) {
  for (const int level : {0, 2}) {
    pass_->draw_part(std::nullopt);
    const Drawn whole = draw({level, 0}, LevelTransition::hard);
    const double border = 1.4;
    pass_->draw_part(ViewPart{.farthest = border});
    const Drawn near = draw({level, 0}, LevelTransition::hard);
    pass_->draw_part(ViewPart{.nearest = border});
    const Drawn far = draw({level, 0}, LevelTransition::hard);
    int of_near = 0, of_far = 0;
    for (std::size_t i = 0; i < whole.depth.size(); ++i) {
      if (whole.depth[i] == 0) continue;
      const bool is_near = kNearPlane / double{whole.depth[i]} < border;
      (is_near ? of_near : of_far) += 1;
      ASSERT_EQ((is_near ? near : far).surface[i], whole.surface[i]) << "pixel " << i << ", level " << level;
      ASSERT_EQ((is_near ? near : far).planes[i], whole.planes[i]) << "pixel " << i << ", level " << level;
      EXPECT_TRUE(!is_near || far.depth[i] < whole.depth[i]) << "pixel " << i << ": only what lies behind";
    }
    EXPECT_GT(of_near, 300);
    EXPECT_GT(of_far, 300);
  }
}

TEST_F(LevelPassTest, PlanesAreThoseOfTheTrianglesSeen) {
  const Drawn got = draw({}, LevelTransition::hard);
  std::vector<std::array<Eigen::Vector3f, 3>> corners;
  for (const Node& node : scene_->nodes())
    for (const auto& [a, b, c] : node.mesh.triangles)
      corners.push_back({node.mesh.vertices[a], node.mesh.vertices[b], node.mesh.vertices[c]});
  int seen = 0, off = 0;
  for (std::size_t i = 0; i < got.surface.size(); ++i) {
    if (got.surface[i] == 0) continue;
    ++seen;
    const auto& c = corners[got.surface[i] - 1];
    const Eigen::Vector3f n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    const Eigen::Vector4f plane = got.planes[i];
    EXPECT_NEAR(plane.head<3>().norm(), 1, 1e-5);
    // All that is asked of it: the surface point, at the triangle's middle within a twentieth of a millimetre.
    off += std::abs(plane.head<3>().dot((c[0] + c[1] + c[2]) / 3) - plane.w()) > 5e-5f ||
           std::abs(plane.head<3>().dot(n)) < 0.99f;
  }
  EXPECT_GT(seen, 1500);
  EXPECT_LE(off, seen / 200) << "at triangles of a pixel's size or seen from the side";
}

TEST_F(LevelPassTest, CoarserLevelsAreWithinTheirErrorAndKeepTheirParts) {
  const Drawn full = draw({}, LevelTransition::hard);
  const auto part = [&](GLuint surface) { return parts_[surface - 1]; };
  for (int level = 1; level <= 3; ++level) {
    const Drawn coarse = draw({level, 0}, LevelTransition::hard);
    double error = 0;
    for (const MeshLevels& node : levels_->nodes())
      error = std::max(error, node.levels[static_cast<std::size_t>(level)].error);
    std::size_t other_part = 0, seen = 0, far = 0;
    for (std::size_t i = 0; i < full.surface.size(); ++i) {
      if (full.surface[i] == 0 || coarse.surface[i] == 0) continue;
      ++seen;
      other_part += part(full.surface[i]) != part(coarse.surface[i]);
      // Seen at a slant, depth differs more than surfaces do.
      far += std::abs(kNearPlane / double{full.depth[i]} - kNearPlane / double{coarse.depth[i]}) > 5 * error + 1e-4;
    }
    EXPECT_GT(seen, 1500u);
    EXPECT_LE(other_part, seen / 20) << "level " << level;
    EXPECT_LE(far, seen / 50) << "level " << level << ", error " << error;
  }
}

TEST_F(LevelPassTest, AWayBeginsAndEndsWhereTheLevelsAre) {
  const Drawn from = draw({1, 0}, LevelTransition::geomorph), to = draw({2, 0}, LevelTransition::geomorph);
  const Drawn end = draw({1, 0.9999f}, LevelTransition::geomorph), middle = draw({1, 0.5f}, LevelTransition::geomorph);
  const auto [left, left_rim] = apart(end, to);
  const auto [whole, whole_rim] = apart(from, to);
  const auto [half, half_rim] = apart(middle, to);
  EXPECT_LE(left_rim, 1 + whole_rim / 10);
  EXPECT_LT(left, 0.05 * whole);
  EXPECT_LE(half_rim, whole_rim);
  EXPECT_GT(half, 0);
}

// What one level leaves to the other is all that the other draws: no hole, and each has its share of pixels.
TEST_F(LevelPassTest, FadingLevelsShareThePixels) {
  const Drawn fine = draw({1, 0}, LevelTransition::fade), coarse = draw({2, 0}, LevelTransition::fade);
  for (const float share : {0.25f, 0.5f, 0.75f}) {
    const Drawn both = draw({1, share}, LevelTransition::fade);
    int of_coarse = 0, told_apart = 0;
    for (std::size_t i = 0; i < both.depth.size(); ++i) {
      if (fine.depth[i] == 0 || coarse.depth[i] == 0) continue;
      ASSERT_TRUE(both.depth[i] == fine.depth[i] || both.depth[i] == coarse.depth[i]) << "pixel " << i;
      told_apart += fine.depth[i] != coarse.depth[i];
      of_coarse += fine.depth[i] != coarse.depth[i] && both.depth[i] == coarse.depth[i];
    }
    EXPECT_GT(told_apart, 1000);
    EXPECT_NEAR(static_cast<double>(of_coarse) / told_apart, share, 0.05);
  }
}

}  // namespace
}  // namespace foresight::gl::level_pass_test
