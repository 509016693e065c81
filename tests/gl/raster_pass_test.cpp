#include "gl/raster_pass.hpp"

#include "scene/primitives.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"

namespace foresight::gl::raster_pass_test {
namespace {

struct Drawn {
  std::vector<float> depth;
  std::vector<GLuint> surface;
};

Drawn read(const FaceImages& images) {
  const auto pixels = static_cast<std::size_t>(images.faces.width * images.faces.height * images.faces.count);
  Drawn out{std::vector<float>(pixels), std::vector<GLuint>(images.surface ? pixels : 0)};
  glGetTextureImage(images.depth.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(pixels * 4),
                    out.depth.data());
  if (images.surface)
    glGetTextureImage(images.surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(pixels * 4),
                      out.surface.data());
  return out;
}

using RasterPassTest = HeadlessTest;
class RasterAgainstRays : public HeadlessTest, public testing::WithParamInterface<const char*> {};

// Rasterisers snap vertices to 1/256 px: a pixel centre that near to an edge may fall on either
// side. With some hundred pixels of edges that is about one pixel in a thousand.
constexpr double kEdgeShare = 0.002;

TEST_P(RasterAgainstRays, Agree) {
  const auto scene = small_scene();
  const SceneState state = state_of(*scene, 0.07);
  const Lens lens = small_lens(GetParam());
  const FaceImages images(faces_for(lens, 4), true);
  const RasterPass raster(std::make_shared<SceneBuffers>(*scene), true);
  raster(usual_view(), state, images);
  const Drawn drawn = read(images);
  const reference::RayCaster caster(*scene, state);
  std::size_t at = 0, other_surface = 0, with_model = 0;
  double worst = 0;
  for (int face = 0; face < images.faces.count; ++face) {
    const auto picture = reference::draw_face(images.faces, face, usual_view(), caster);
    for (std::size_t i = 0; i < picture.surface.size(); ++i, ++at) {
      with_model += picture.surface[i] != 0;
      if (drawn.surface[at] != picture.surface[i]) {
        ++other_surface;
        continue;
      }
      const double inverse_z = drawn.depth[at] / kNearPlane;
      if (picture.surface[i])
        worst = std::max(worst, std::abs(inverse_z / picture.inverse_z[i] - 1));
      else
        ASSERT_EQ(drawn.depth[at], 0);
    }
  }
  EXPECT_GT(with_model, 2500u);
  EXPECT_LE(static_cast<double>(other_surface), kEdgeShare * static_cast<double>(at));
  // As vertices are moved by up to 1/512 px, depth is by that share of what it changes from pixel to pixel: some
  // hundredths on these small pictures of slanted surfaces. 2e-4 of the depth is 0.2 mm at one metre.
  EXPECT_LT(worst, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Lenses, RasterAgainstRays, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

TEST_F(RasterPassTest, DepthOnlyAndWithSurfaceAreTheSame) {
  const auto scene = small_scene();
  const auto buffers = std::make_shared<SceneBuffers>(*scene);
  const SceneState state = state_of(*scene);
  const Faces faces = faces_for(small_lens("pinhole"), 4);
  const FaceImages with(faces, true), without(faces, false);
  RasterPass(buffers, true)(usual_view(), state, with);
  RasterPass(buffers, false)(usual_view(), state, without);
  EXPECT_EQ(read(with).depth, read(without).depth);
}

TEST_F(RasterPassTest, MatchesTheGoldenDepth) {
  const auto scene = small_scene();
  const FaceImages images(faces_for(small_lens("pinhole"), 4), false);
  RasterPass(std::make_shared<SceneBuffers>(*scene), false)(usual_view(), state_of(*scene), images);
  const Drawn drawn = read(images);
  cv::Mat picture(images.faces.height, images.faces.width, CV_8UC1);
  for (std::size_t i = 0; i < drawn.depth.size(); ++i)
    picture.data[i] = cv::saturate_cast<uchar>(drawn.depth[i] / kNearPlane * 170);  // 1.5 per metre is white
  // One grey value is rounding; edges may move by a pixel centre, see kEdgeShare.
  EXPECT_TRUE(matches_golden(picture, "depth", {0.3, 1, kEdgeShare}));
}

TEST_F(RasterPassTest, PaintsOnlyItsTarget) {
  const auto scene = small_scene();
  const FaceImages images(faces_for(small_lens("pinhole"), 4), true);
  // Sentinel: an image of the same kind beside the target.
  const FaceImages beside(images.faces, true);
  const float sentinel = 0.125f;
  const GLuint surface_sentinel = 77;
  glClearTexImage(beside.depth.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, &sentinel);
  glClearTexImage(beside.surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &surface_sentinel);
  const RasterPass raster(std::make_shared<SceneBuffers>(*scene), true);
  raster(usual_view(), state_of(*scene), images);
  const Drawn other = read(beside);
  EXPECT_EQ(std::count(other.depth.begin(), other.depth.end(), sentinel),
            static_cast<std::ptrdiff_t>(other.depth.size()));
  EXPECT_EQ(std::count(other.surface.begin(), other.surface.end(), surface_sentinel),
            static_cast<std::ptrdiff_t>(other.surface.size()));
  GLint framebuffer = -1;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &framebuffer);
  EXPECT_EQ(framebuffer, 0);
  EXPECT_FALSE(glIsEnabled(GL_DEPTH_TEST));
}

/// Of a box of 1 m around the origin, its far side first, the fragments that a camera there sees or overdraws, and the
/// pixels at which it is.
std::pair<GLuint, std::ptrdiff_t> drawn_of_box(const Mesh& mesh, const Pose& T_world_camera) {
  const SceneModel scene({Node{"box", mesh, -1, Pose::Identity()}});
  const FaceImages images(faces_for(small_lens("pinhole"), 4), true);
  const RasterPass raster(std::make_shared<SceneBuffers>(scene), true);
  GLuint query = 0, fragments = 0;
  glGenQueries(1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  raster(T_world_camera, {{}, StateStatus::exact, scene.rest_poses()}, images);
  glEndQuery(GL_SAMPLES_PASSED);
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &fragments);
  glDeleteQueries(1, &query);
  const Drawn drawn = read(images);
  return {fragments, std::ranges::count_if(drawn.surface, [](GLuint surface) { return surface != 0; })};
}

Mesh box_from_its_far_side(const Pose& T_world_camera) {
  Mesh mesh = make_box({1, 1, 1});
  const auto distance = [&](const auto& t) {
    const Eigen::Vector3d middle =
        (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]).template cast<double>() / 3;
    return (T_world_camera.inverse() * middle).z();
  };
  std::ranges::sort(mesh.triangles, std::ranges::greater(), distance);
  return mesh;
}

TEST_F(RasterPassTest, OfSolidBodiesOnlyWhatFacesTheCameraIsDrawn) {
  const Pose from = look_at({2, 1.5, 1}, {0, 0, 0});
  const auto [fragments, pixels] = drawn_of_box(box_from_its_far_side(from), from);
  EXPECT_GT(pixels, 1000);
  EXPECT_EQ(fragments, pixels);
  Mesh inside_out = box_from_its_far_side(from);  // no solid: both sides of a triangle are surface
  for (auto& t : inside_out.triangles) std::swap(t[1], t[2]);
  const auto [of_both, same_pixels] = drawn_of_box(inside_out, from);
  EXPECT_GT(of_both, 1.5 * pixels);
  EXPECT_EQ(same_pixels, pixels);
}

TEST_F(RasterPassTest, FromInsideOrTooNearABodyIsDrawnAsAWhole) {
  const Mesh box = make_box({1, 1, 1});
  const Pose inside = look_at({0.1, 0, 0}, {0.2, 1, 0});
  EXPECT_EQ(drawn_of_box(box, inside).second, drawn_of_box(box, inside).first);
  EXPECT_EQ(drawn_of_box(box, inside).second, 160 * 120);
  // Its front is cut away by the near plane: the back is seen through the gap.
  const Pose at_it = look_at({0.505, 0, 0}, {-1, 0.01, 0});
  EXPECT_EQ(drawn_of_box(box, at_it).second, 160 * 120);
}

// A second draw starts from a clean image: nothing of the first is left where there is no model now.
TEST_F(RasterPassTest, ClearsWhatWasThere) {
  const auto scene = small_scene();
  const FaceImages images(faces_for(small_lens("pinhole"), 4), true);
  const RasterPass raster(std::make_shared<SceneBuffers>(*scene), true);
  raster(usual_view(), state_of(*scene), images);
  raster(look_at({0, 0, 1}, {0.1, 0, 2}), state_of(*scene), images);  // away from everything
  const Drawn drawn = read(images);
  EXPECT_EQ(std::count(drawn.depth.begin(), drawn.depth.end(), 0.0f), static_cast<std::ptrdiff_t>(drawn.depth.size()));
  EXPECT_EQ(std::count(drawn.surface.begin(), drawn.surface.end(), 0u),
            static_cast<std::ptrdiff_t>(drawn.surface.size()));
}

}  // namespace
}  // namespace foresight::gl::raster_pass_test
