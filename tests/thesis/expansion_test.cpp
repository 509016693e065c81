// Growing invalid areas (section 5.1) against brute force.
#include "texture_gpu/thesis/expansion.hpp"

#include "tests/support/headless_test.hpp"
#include "tests/thesis/texels.hpp"

namespace foresight::thesis::expansion_test {
namespace {

constexpr int kWidth = 71, kHeight = 45;  // odd sizes come back from halving, too
constexpr int kOutside = 247;             // kOutsideAlpha in eight bits

class ExpansionTest : public HeadlessTest {
 protected:
  /// Alpha after expansion.
  cv::Mat expand(const cv::Mat& alpha, Expansion method, int iterations) {
    const gl::Faces plane{1, 90, 60, 100, 100, 45, 30};
    const PerspectiveTexture texture(plane);
    const TexelDrawing drawing;
    cv::Mat texels(alpha.size(), CV_8UC4, cv::Scalar(10, 20, 30, 0));
    cv::insertChannel(alpha, texels, 3);
    write_texels(texture.texture(), texels);
    ExpansionPass pass(plane);
    pass(texture, {3, 4, alpha.cols, alpha.rows}, method, iterations, drawing);
    const cv::Mat got = read_texels(texture.texture(), alpha.cols, alpha.rows);
    EXPECT_EQ(got.at<cv::Vec4b>(7, 9)[0], 10) << "colours stay";
    cv::Mat out;
    cv::extractChannel(got, out, 3);
    return out;
  }

  /// A visible area, the outside around it, and blots of what is hidden.
  static cv::Mat mask(bool with_hidden = true) {
    cv::Mat alpha(kHeight, kWidth, CV_8UC1, cv::Scalar(kOutside));
    alpha(cv::Rect(5, 6, 60, 34)).setTo(255);
    if (!with_hidden) return alpha;
    alpha(cv::Rect(20, 15, 6, 3)).setTo(0);
    alpha(cv::Rect(47, 30, 1, 1)).setTo(0);
    alpha(cv::Rect(60, 0, 11, 12)).setTo(0);
    return alpha;
  }
};

TEST_F(ExpansionTest, TheShaderDilatesByARhomb) {
  const cv::Mat before = mask();
  for (int n : {0, 1, 2, 3, 6}) {
    const cv::Mat after = expand(before, Expansion::shader, n);
    int wrong = 0, grown = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        bool invalid = false;
        for (int v = 0; v < kHeight; ++v)
          for (int u = 0; u < kWidth; ++u)
            invalid = invalid || (before.at<uchar>(v, u) == 0 && std::abs(u - x) + std::abs(v - y) <= n);
        const int expected = invalid ? 0 : before.at<uchar>(y, x);
        wrong += after.at<uchar>(y, x) != expected;
        grown += invalid && before.at<uchar>(y, x) != 0;
      }
    EXPECT_EQ(wrong, 0) << n << " iterations";
    EXPECT_EQ(grown > 0, n > 0);
  }
}

TEST_F(ExpansionTest, ScalingGrowsAndNeverShrinks) {
  const cv::Mat before = mask();
  for (const Expansion method : {Expansion::alternating, Expansion::progressive}) {
    int last = cv::countNonZero(before == 0);
    for (int n : {1, 2, 3}) {
      const cv::Mat after = expand(before, method, n);
      EXPECT_EQ(cv::countNonZero((before == 0) & (after != 0)), 0) << "what was invalid stays so";
      // At least one texel around: what bilinear interpolation mixed with an invalid one.
      int not_grown = 0;
      for (int y = 1; y + 1 < kHeight; ++y)
        for (int x = 1; x + 1 < kWidth; ++x)
          if (before.at<uchar>(y, x) == 0)
            for (const auto& [u, v] : {std::pair(x - 1, y), {x + 1, y}, {x, y - 1}, {x, y + 1}})
              not_grown += after.at<uchar>(v, u) != 0;
      EXPECT_EQ(not_grown, 0) << n;
      const int now = cv::countNonZero(after == 0);
      EXPECT_GT(now, last);
      last = now;
    }
    EXPECT_LT(last, kWidth * kHeight * 9 / 10) << "and leaves something";
  }
}

// alpha 31/32 of the outside (section 4.5.3) is above all limits: it does not grow into the polygon.
TEST_F(ExpansionTest, TheOutsideDoesNotGrowIn) {
  for (const Expansion method : {Expansion::alternating, Expansion::progressive, Expansion::shader}) {
    const cv::Mat after = expand(mask(false), method, 3);
    EXPECT_EQ(cv::countNonZero(after == 0), 0);
    EXPECT_EQ(cv::countNonZero(after(cv::Rect(25, 16, 20, 12)) != 255), 0) << "well inside nothing changes";
  }
}

TEST_F(ExpansionTest, SmallTexturesKeepTheirMask) {
  cv::Mat small(ExpansionPass::kSmallest - 1, 40, CV_8UC1, cv::Scalar(255));
  small(cv::Rect(4, 4, 3, 3)).setTo(0);
  for (const Expansion method : {Expansion::alternating, Expansion::progressive, Expansion::shader, Expansion::none})
    EXPECT_EQ(cv::countNonZero(expand(small, method, 3) != small), 0);
}

}  // namespace
}  // namespace foresight::thesis::expansion_test
