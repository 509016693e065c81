// Lines over a view, pixel by pixel where the lens puts them.
#include "display/scene_overlay.hpp"

#include "scene/primitives.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::scene_overlay_test {
namespace {

using Eigen::Vector3d;

TEST(OverlayLines, AreCutIntoShortStrokesThatKnowWhereTheyAre) {
  OverlayLines lines;
  const Vector3d points[] = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.05, 0}};
  lines.polyline(points, {});
  double length = 0;
  for (const OverlayStroke& stroke : lines.strokes()) {
    EXPECT_NEAR(stroke.along, length, 1e-6);
    length += (stroke.b - stroke.a).norm();
    EXPECT_LE((stroke.b - stroke.a).norm(), OverlayLines::kLongestStroke + 1e-6);
  }
  EXPECT_NEAR(length, 0.15, 1e-6);
  EXPECT_TRUE(lines.strokes().front().begins);
  EXPECT_TRUE(lines.strokes().back().ends);
}

TEST(OverlayLines, TakeNoNumbersThatAreNoneAndNotTooMany) {
  OverlayLines lines;
  lines.line({0, 0, std::nan("")}, {0, 0, 1}, {});
  lines.line({0, 0, 0}, {0, 0, 1e30}, {});
  lines.dot({INFINITY, 0, 0}, {});
  lines.arc({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, std::nan(""), {});
  EXPECT_TRUE(lines.empty());
  for (int i = 0; i < 3000; ++i) lines.line({0, 0, 0}, {1, 0, 0}, {});
  EXPECT_EQ(lines.strokes().size(), OverlayLines::kMostStrokes);
}

TEST(OverlayLines, AWireShowsWhereAMeshBends) {
  EXPECT_EQ(wire_of(make_box({1, 1, 1})).edges.size(), 12u);
  EXPECT_EQ(wire_of(make_sphere(1)).edges.size(), 0u);
  EXPECT_EQ(wire_of(make_cylinder(0.1, 1)).edges.size(), 64u) << "its two rims";
}

class SceneOverlayTest : public HeadlessTest {
 protected:
  /// The picture of 2 x 2 px a pixel of the lens, with these lines over grey.
  cv::Mat drawn(const Lens& lens, const OverlayLines& lines, const SceneModel& scene, bool top = true) {
    const gl::FaceImages faces(gl::faces_for(lens, 2), true);
    gl::RasterPass raster(std::make_shared<gl::SceneBuffers>(scene), true);
    raster(usual_view(), state_of(scene), faces);
    const int width = 2 * lens.width(), height = 2 * lens.height();
    gl::Texture texture(GL_RGBA8, width, height, 0, 1, "overlay");
    const TextureTarget target(texture.name(), width, height, -1, top);
    fill(target.whole(), kGround, kGround, kGround);
    SceneOverlay overlay(lens);
    overlay.draw(lines, usual_view(), faces, target.whole());
    cv::Mat out(height, width, CV_8UC4);
    glGetTextureImage(texture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
    return out;
  }
  static constexpr float kGround = 0.4f;  // 102 of 255
};

int bright(const cv::Mat& picture, const Eigen::Vector2d& at) {
  const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
  return picture.at<cv::Vec4b>(y, x)[2];
}

class OverlayOfLenses : public SceneOverlayTest, public testing::WithParamInterface<const char*> {};

// Points along a line that only a lens bends: all of them are on it, where Lens::project() says.
TEST_P(OverlayOfLenses, ALineLiesWhereTheLensPutsItsPoints) {
  const Lens lens = small_lens(GetParam());
  const auto scene = small_scene();
  const Vector3d a(-0.3, -0.25, 0.35), b(0.3, 0.2, 0.35);  // over everything
  OverlayLines lines;
  lines.line(a, b, {{1, 1, 1}, 3});
  for (const bool top : {true, false}) {
    const cv::Mat picture = drawn(lens, lines, *scene, top);
    const ViewTarget whole{0, 0, 0, picture.cols, picture.rows, top};
    int seen = 0;
    for (double share = 0; share <= 1; share += 0.01) {
      auto at = seen_at(a + share * (b - a), lens, usual_view(), whole, picture.rows);
      if (!at) continue;
      ++seen;
      if (!top) at->y() = picture.rows - 1e-9 - at->y();  // as the texture's rows are read
      EXPECT_GT(bright(picture, *at), 240) << share;
    }
    EXPECT_GT(seen, 50);
    EXPECT_GT(cv::countNonZero(picture.reshape(1) == 102), picture.total()) << "the rest is left alone";
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, OverlayOfLenses, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

// Behind the box a line is dotted and dimmer: about half of its pixels, none of them at full brightness.
TEST_F(SceneOverlayTest, WhatTheModelHidesIsDottedAndDimmer) {
  const Lens lens = small_lens("pinhole");
  const auto scene = small_scene();
  const SceneState state = state_of(*scene);
  const Vector3d eye = usual_view().translation();
  const Vector3d box = state.T_world_node[kBox].translation();
  const Vector3d right = usual_view().linear().col(0), behind = (box - eye).normalized();
  const auto share_bright = [&](double depth, int least) {
    const Vector3d middle = box + depth * behind;
    OverlayLines lines;
    lines.line(middle - 0.02 * right, middle + 0.02 * right, {{1, 1, 1}, 3});
    const cv::Mat picture = drawn(lens, lines, *scene);
    int count = 0, all = 0;
    for (double along = -0.018; along <= 0.018; along += 0.0005) {
      const auto at = seen_at(middle + along * right, lens, usual_view(), {0, 0, 0, picture.cols, picture.rows, true},
                              picture.rows);
      if (!at) continue;
      ++all;
      count += bright(picture, *at) > least;
    }
    return count / std::max(1.0, static_cast<double>(all));
  };
  EXPECT_GT(share_bright(-0.4, 240), 0.99) << "in front";
  EXPECT_EQ(share_bright(0.1, 240), 0) << "behind";
  EXPECT_GT(share_bright(0.1, 130), 0.25);
  EXPECT_LT(share_bright(0.1, 130), 0.8);
}

TEST_F(SceneOverlayTest, BearsAnyTargetAndWhatIsBehindTheCamera) {
  const Lens lens = small_lens("plumb_bob");
  const auto scene = small_scene();
  OverlayLines lines;
  const Vector3d eye = usual_view().translation(), forward = usual_view().linear().col(2);
  lines.line(eye - forward, eye + forward, {{1, 1, 1}, 3});
  lines.line(eye - 0.5 * forward, eye - 0.7 * forward, {{1, 1, 1}, 3});
  drawn(lens, lines, *scene);
  const gl::FaceImages faces(gl::faces_for(lens, 2), true);
  gl::Texture texture(GL_RGBA8, 1, 1, 0, 1, "small");
  const TextureTarget target(texture.name(), 1, 1);
  SceneOverlay(lens).draw(lines, usual_view(), faces, target.whole());
  EXPECT_FALSE(seen_at(eye - forward, lens, usual_view(), target.whole(), 1));
}

}  // namespace
}  // namespace foresight::scene_overlay_test
