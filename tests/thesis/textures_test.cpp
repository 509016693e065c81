// Normalisation (section 4.3) and fusion (section 4.4), texel by texel.
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/thesis/texels.hpp"
#include "texture_gpu/thesis/fusion.hpp"

namespace foresight::thesis::textures_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

class TexturesTest : public HeadlessTest {
 protected:
  const Polygon square_{0, {{-0.3, -0.2, 0}, {0.3, -0.2, 0}, {0.3, 0.2, 0}, {-0.3, 0.2, 0}}, Vector3d::UnitZ(), {}, {}};
};

TEST_F(TexturesTest, NormalisedTexelsAreSamplesOfTheImage) {
  const TexelDrawing drawing;
  const gl::Faces plane = gl::faces_for(small_lens("pinhole"), 0);
  const PolygonFrame frame = frame_of(square_, 100, 64);
  const PerspectiveTexture perspective(plane);
  const Normalisation normalisation(64);
  int compared = 0, outside = 0;
  double worst = 0;
  for (const Pose& T_world_camera :
       {look_at({-0.7, -0.3, 0.8}, {0, 0, 0}), look_at({-0.4, 0.1, 0.2}, {0.1, 0.3, 0})}) {  // all of it; clipped
    const Pose T_camera_node = T_world_camera.inverse();
    const auto box = bounding_box(square_, T_camera_node, plane);
    ASSERT_TRUE(box);
    // Smooth: a renderer's eight bits of interpolation do not show.
    cv::Mat image(box->height, box->width, CV_8UC4);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        image.at<cv::Vec4b>(y, x) =
            cv::Vec4b(static_cast<uchar>(128 + 100 * std::sin(0.2 * x)),
                      static_cast<uchar>(128 + 100 * std::cos(0.15 * y)), static_cast<uchar>((3 * x + 2 * y) / 4), 255);
    write_texels(perspective.texture(), image);
    normalisation(perspective, *box, frame, T_camera_node, plane, drawing);
    const cv::Mat got = read_texels(normalisation.texture(), frame.s, frame.t);
    for (int j = 0; j < frame.t; ++j)
      for (int i = 0; i < frame.s; ++i) {
        const Vector3d p = T_camera_node * frame.at(i + 0.5, j + 0.5);
        const Vector2d at =
            Vector2d(plane.fx * p.x() / p.z() + plane.cx - box->x, plane.fy * p.y() / p.z() + plane.cy - box->y);
        const double border =
            std::min({at.x() + 0.5, at.y() + 0.5, box->width - 0.5 - at.x(), box->height - 0.5 - at.y()});
        const cv::Vec4b& texel = got.at<cv::Vec4b>(j, i);
        if (std::abs(border) < 0.01) continue;
        if (p.z() <= 0 || border < 0) {
          ++outside;
          ASSERT_EQ(texel[3], 0);
          continue;
        }
        ASSERT_EQ(texel[3], 255);
        if (border < 0.5) continue;
        const int x = std::min(static_cast<int>(at.x()), box->width - 2),
                  y = std::min(static_cast<int>(at.y()), box->height - 2);
        const double fx = at.x() - x, fy = at.y() - y;
        for (int c = 0; c < 3; ++c) {
          const auto v = [&](int u, int w) { return static_cast<double>(image.at<cv::Vec4b>(y + w, x + u)[c]); };
          const double want = (1 - fy) * ((1 - fx) * v(0, 0) + fx * v(1, 0)) + fy * ((1 - fx) * v(0, 1) + fx * v(1, 1));
          worst = std::max(worst, std::abs(texel[c] - want));
        }
        ++compared;
      }
  }
  EXPECT_GT(compared, 3000);
  EXPECT_GT(outside, 200);
  EXPECT_LT(worst, 1.2) << "rounding";
}

// Hidden texels, those near them and those outside stay invalid: more than 31/32 must arrive.
TEST_F(TexturesTest, OnlyWhatIsWhollyVisibleBecomesValid) {
  const TexelDrawing drawing;
  const gl::Faces plane = gl::faces_for(small_lens("pinhole"), 0);
  const PolygonFrame frame = frame_of(square_, 100, 64);
  const PerspectiveTexture perspective(plane);
  const Normalisation normalisation(64);
  const Pose T_camera_node = look_at({-0.7, -0.3, 0.8}, {0, 0, 0}).inverse();
  const auto box = bounding_box(square_, T_camera_node, plane);
  cv::Mat image(box->height, box->width, CV_8UC4, cv::Scalar(50, 60, 70, 255));
  const cv::Rect hidden(30, 20, 9, 7), beyond(50, 10, 12, 12);
  image(hidden).setTo(cv::Scalar(50, 60, 70, 0));
  image(beyond).setTo(cv::Scalar(50, 60, 70, 247));
  write_texels(perspective.texture(), image);
  normalisation(perspective, *box, frame, T_camera_node, plane, drawing);
  const cv::Mat got = read_texels(normalisation.texture(), frame.s, frame.t);
  int valid = 0, invalid = 0, wrong = 0;
  for (int j = 0; j < frame.t; ++j)
    for (int i = 0; i < frame.s; ++i) {
      const Vector3d p = T_camera_node * frame.at(i + 0.5, j + 0.5);
      const double x = plane.fx * p.x() / p.z() + plane.cx - box->x, y = plane.fy * p.y() / p.z() + plane.cy - box->y;
      const auto reach = [&](const cv::Rect& r) {  // largest coordinate distance, px; below 0 within
        return std::max({r.x - x, x - (r.x + r.width - 1), r.y - y, y - (r.y + r.height - 1)});
      };
      const bool is_valid = got.at<cv::Vec4b>(j, i)[3] == 255;
      if (reach(hidden) < 0.75 || reach(beyond) < 0) {
        ++invalid;
        wrong += is_valid;
      } else if (reach(hidden) > 1.1 && reach(beyond) > 1.1) {
        ++valid;
        wrong += !is_valid;
      }
    }
  EXPECT_GT(valid, 500);
  EXPECT_GT(invalid, 50);
  EXPECT_EQ(wrong, 0);
}

TEST_F(TexturesTest, TheNewestValidColourWins) {
  const TexelDrawing drawing;
  PolygonTextures textures({square_, square_}, 100, 64);
  const PolygonFrame& frame = textures.frame(0);
  const Normalisation normalisation(64);
  const Fusion fusion;
  EXPECT_EQ(textures.find(0), nullptr);
  const cv::Mat old = blotted_texels(frame.s, frame.t, 1), fresh = blotted_texels(frame.s, frame.t, 2);
  write_texels(textures.writable(0), old);
  write_texels(normalisation.texture(), fresh);
  fusion(normalisation, 0, textures, drawing);
  const cv::Mat got = read_texels(*textures.find(0), frame.s, frame.t);
  int taken = 0, kept = 0;
  for (int y = 0; y < frame.t; ++y)
    for (int x = 0; x < frame.s; ++x) {
      const bool valid = fresh.at<cv::Vec4b>(y, x)[3] != 0;
      ASSERT_EQ(got.at<cv::Vec4b>(y, x), (valid ? fresh : old).at<cv::Vec4b>(y, x));
      (valid ? taken : kept) += 1;
    }
  EXPECT_GT(taken, 500);
  EXPECT_GT(kept, 20);
  EXPECT_TRUE(textures.has_colours(0));
  // A polygon that was hidden in all images has a texture, but no colours.
  cv::Mat nothing(frame.t, frame.s, CV_8UC4, cv::Scalar(1, 2, 3, 0));
  write_texels(normalisation.texture(), nothing);
  fusion(normalisation, 1, textures, drawing);
  EXPECT_NE(textures.find(1), nullptr);
  EXPECT_FALSE(textures.has_colours(1));
  EXPECT_EQ(textures.bytes(), 2u * 4u * static_cast<unsigned>(frame.s * frame.t));
}

}  // namespace
}  // namespace foresight::thesis::textures_test
