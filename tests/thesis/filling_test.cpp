// Hole filling (section 5.2) against the same on the CPU.
#include "tests/support/headless_test.hpp"
#include "tests/thesis/texels.hpp"
#include "texture_gpu/thesis/pyramid_filling.hpp"
#include "texture_gpu/thesis/shader_filling.hpp"

namespace foresight::thesis::filling_test {
namespace {

using Eigen::Vector2i;
using Eigen::Vector4d;

struct Level {
  Vector2i size;
  std::vector<Vector4d> texels;  // alpha 1: valid
  Vector4d& at(int x, int y) { return texels[static_cast<std::size_t>(y * size.x() + x)]; }
  const Vector4d& at(int x, int y) const { return texels[static_cast<std::size_t>(y * size.x() + x)]; }
};

Level level_of(const cv::Mat& texels) {
  Level out{{texels.cols, texels.rows}, {}};
  for (int y = 0; y < texels.rows; ++y)
    for (int x = 0; x < texels.cols; ++x) {
      const cv::Vec4b& t = texels.at<cv::Vec4b>(y, x);
      out.texels.emplace_back(t[0], t[1], t[2], t[3] > 127);
    }
  return out;
}

/// Equations 5.6 to 5.9.
Level reduced(const Level& finer) {
  Level out{(finer.size / 2).cwiseMax(1), {}};
  const Vector2i taps = finer.size.cwiseQuotient(out.size);
  for (int y = 0; y < out.size.y(); ++y)
    for (int x = 0; x < out.size.x(); ++x) {
      Vector4d sum = Vector4d::Zero();
      for (int j = 0; j < taps.y(); ++j)
        for (int i = 0; i < taps.x(); ++i)
          if (const Vector4d& t = finer.at(x * taps.x() + i, y * taps.y() + j); t.w() > 0) sum += t;
      out.texels.push_back(sum.w() > 0 ? (sum / sum.w()).eval() : Vector4d::Zero().eval());
    }
  return out;
}

/// Invalid texels take the coarser level, interpolated (section 5.2.4).
void expand(const Level& coarser, Level& finer) {
  for (int y = 0; y < finer.size.y(); ++y)
    for (int x = 0; x < finer.size.x(); ++x) {
      Vector4d& own = finer.at(x, y);
      if (own.w() > 0) continue;
      const auto place = [](int i, int fine, int coarse) {
        return std::clamp((i + 0.5) * coarse / fine, 0.5, coarse - 0.5) - 0.5;
      };
      const double u = place(x, finer.size.x(), coarser.size.x()), v = place(y, finer.size.y(), coarser.size.y());
      const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
      const int x1 = std::min(x0 + 1, coarser.size.x() - 1), y1 = std::min(y0 + 1, coarser.size.y() - 1);
      const double fx = u - x0, fy = v - y0;
      own.head<3>() = (1 - fy) * ((1 - fx) * coarser.at(x0, y0) + fx * coarser.at(x1, y0)).head<3>() +
                      fy * ((1 - fx) * coarser.at(x0, y1) + fx * coarser.at(x1, y1)).head<3>();
    }
}

class FillingTest : public HeadlessTest {
 protected:
  static gl::Texture texture_of(const cv::Mat& texels) {
    gl::Texture texture = smooth_texture(GL_RGBA8, texels.cols, texels.rows, "texture to fill");
    write_texels(texture, texels);
    return texture;
  }
};

TEST_F(FillingTest, ThePyramidIsThatOfTheCpu) {
  const TexelDrawing drawing;
  const PyramidFilling fill(128);
  for (const auto& [s, t] : {std::pair(64, 64), {128, 16}, {4, 32}, {1, 8}, {2, 2}, {1, 1}}) {
    const cv::Mat before = blotted_texels(s, t, 3);
    std::vector<Level> levels{level_of(before)};
    while (levels.back().size.maxCoeff() > 1) levels.push_back(reduced(levels.back()));
    for (std::size_t i = levels.size() - 1; i > 0; --i) expand(levels[i], levels[i - 1]);
    const gl::Texture texture = texture_of(before);
    fill(texture, s, t, drawing);
    const cv::Mat after = read_texels(texture, s, t);
    double worst = 0;
    bool any_valid = false;
    for (int y = 0; y < t; ++y)
      for (int x = 0; x < s; ++x) any_valid = any_valid || before.at<cv::Vec4b>(y, x)[3] == 255;
    for (int y = 0; y < t && any_valid; ++y)
      for (int x = 0; x < s; ++x) {
        const cv::Vec4b &was = before.at<cv::Vec4b>(y, x), &is = after.at<cv::Vec4b>(y, x);
        ASSERT_EQ(is[3], was[3]) << "alpha stays";
        if (was[3] == 255) {
          ASSERT_EQ(is, was) << "seen texels stay";
        }
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(is[c] - levels[0].at(x, y)[c]));
      }
    // Eight bits in each of up to seven levels, and eight bits of a renderer's interpolation.
    EXPECT_LT(worst, 5) << s << " x " << t;
  }
}

TEST_F(FillingTest, TheShaderFillsFromTheBorders) {
  const TexelDrawing drawing;
  ShaderFilling fill(64);
  for (const bool two_stages : {false, true}) {
    const cv::Mat before = blotted_texels(64, 32, 4);
    // One pass after the other, in eight bits as the GPU keeps them.
    cv::Mat now = before.clone();
    for (bool changed = true; changed;) {
      changed = false;
      const cv::Mat last = now.clone();
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
          if (last.at<cv::Vec4b>(y, x)[3]) continue;
          Vector4d inner = Vector4d::Zero(), outer = Vector4d::Zero();
          for (int j = -2; j <= 2; ++j)
            for (int i = -2; i <= 2; ++i) {
              if (x + i < 0 || y + j < 0 || x + i >= 64 || y + j >= 32) continue;
              const cv::Vec4b& q = last.at<cv::Vec4b>(y + j, x + i);
              if (q[3]) (std::max(std::abs(i), std::abs(j)) == 2 ? outer : inner) += Vector4d(q[0], q[1], q[2], 1);
            }
          if (inner.w() == 0) continue;
          if (two_stages) inner += outer;
          for (int c = 0; c < 3; ++c)
            now.at<cv::Vec4b>(y, x)[c] = static_cast<uchar>(std::lround(inner[c] / inner.w()));
          now.at<cv::Vec4b>(y, x)[3] = 255;
          changed = true;
        }
    }
    const gl::Texture texture = texture_of(before);
    const int passes = fill(texture, 64, 32, {two_stages, true}, drawing);
    EXPECT_LT(passes, 20) << "ends when nothing changes";
    const cv::Mat after = read_texels(texture, 64, 32);
    int worst = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ(after.at<cv::Vec4b>(y, x)[3], before.at<cv::Vec4b>(y, x)[3]);
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(after.at<cv::Vec4b>(y, x)[c] - now.at<cv::Vec4b>(y, x)[c]));
      }
    EXPECT_LE(worst, 2) << "rounding of halves";
  }
}

// Equation 5.30 bounds the passes; the query only leaves out those that change nothing.
TEST_F(FillingTest, TheQueryChangesNoTexel) {
  const TexelDrawing drawing;
  ShaderFilling fill(64);
  for (unsigned seed : {5u, 6u, 7u})
    for (const bool two_stages : {false, true}) {
      cv::Mat before = blotted_texels(64, 64, seed);
      before(cv::Rect(2, 3, 50, 40)).setTo(cv::Scalar(9, 9, 9, 0));
      const gl::Texture with = texture_of(before), without = texture_of(before);
      const int fewer = fill(with, 64, 64, {two_stages, true}, drawing);
      const int all = fill(without, 64, 64, {two_stages, false}, drawing);
      EXPECT_EQ(all, 63);
      EXPECT_LT(fewer, 40);
      const cv::Mat a = read_texels(with, 64, 64), b = read_texels(without, 64, 64);
      EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
      EXPECT_NE(a.at<cv::Vec4b>(20, 25), before.at<cv::Vec4b>(20, 25)) << "it reaches the middle";
    }
}

}  // namespace
}  // namespace foresight::thesis::filling_test
