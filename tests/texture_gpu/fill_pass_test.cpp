// push, coarse, coarse_fill, spread and pull against the same in double precision.
#include "texture_gpu/fill_pass.hpp"

#include "tests/support/headless_test.hpp"
#include "tests/texture_gpu/pass_bench.hpp"
#include "tests/texture_gpu/reference/filling.hpp"

namespace foresight::fill_pass_test {
namespace {

class FillTest : public HeadlessTest {
 protected:
  /// `chart_extent` in metres, 0: as usual, one to four pages a chart.
  void make(double chart_extent = 0) {
    bench_ = std::make_unique<PassBench>(small_scene(), std::vector{lens_}, TextureOptions{.memory_bytes = 12 << 20},
                                         PatchOptions{.chart_extent = chart_extent});
  }
  void extract(const Pose& T_world_camera) {
    bench_->look({posed_photograph(*bench_->scene, state_of(*bench_->scene), lens_, T_world_camera)});
    bench_->cull(), bench_->allocate(), bench_->relevel(), bench_->extract();
  }

  /// All charts as they are before filling. `turn`: of pages on which nothing new was seen, every
  /// eighth is filled anew; -1: all.
  std::vector<reference::FillChart> charts(const reference::AtlasPixels& pixels, int turn = -1) const {
    std::vector<reference::FillChart> out;
    for (std::size_t i = 0; i < bench_->atlas.charts().size(); ++i) {
      const AtlasChart& chart = bench_->atlas.charts()[i];
      const int width = 16 * chart.pages.x(), height = 16 * chart.pages.y();
      reference::FillChart copy{chart.pages, bench_->surface->charts[i].neighbours, {}, {}, {}, {}};
      copy.texels.resize(static_cast<std::size_t>(width * height));
      copy.holes.resize(chart.page.size());
      for (const AtlasPage& page : chart.page) {
        copy.resident.push_back(page.colour != atlas::kNoSlot);
        const int index = chart.first_page + static_cast<int>(copy.changed.size());
        copy.changed.push_back(turn < 0 || (index + turn) % 8 == 0);
      }
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const auto page = static_cast<std::size_t>(y / 16 * chart.pages.x() + x / 16);
          if (!copy.resident[page]) continue;
          const reference::Texel t = pixels.at(chart.page[page].colour, 0, x % 16, y % 16);
          copy.texels[static_cast<std::size_t>(y * width + x)] = t;
          if ((bench_->raw_height(chart, x, y) & ChartRaster::kCore) && t[3] < 2)
            copy.holes[page][static_cast<std::size_t>(y % 16 / 8 * 2 + x % 16 / 8)] = true;
        }
      out.push_back(std::move(copy));
    }
    return out;
  }

  const Lens lens_ = small_lens("pinhole");
  std::unique_ptr<PassBench> bench_;
};

/// How far what the GPU filled is from the reference, in steps of 255, and of 31 for alpha.
struct Difference {
  std::array<double, atlas::kLevels> colour{}, alpha{};
  double coarse = 0;
  int filled = 0;  // texels of level 0
};

class FillOfCharts : public FillTest, public testing::WithParamInterface<double> {
 protected:
  Difference compare(const std::vector<reference::FillChart>& before,
                     const std::vector<reference::FilledChart>& expected) const {
    const reference::AtlasPixels after = bench_->pixels();
    const reference::Generation generation = bench_->generation();
    Difference out;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const AtlasChart& chart = bench_->atlas.charts()[i];
      for (std::size_t page = 0; page < chart.page.size(); ++page) {
        const Eigen::Vector4d coarse = generation.coarse[static_cast<std::size_t>(chart.first_page) + page];
        out.coarse = std::max(out.coarse, 255 * (coarse - expected[i].coarse[page]).cwiseAbs().maxCoeff());
        if (before[i].resident[page]) compare_page(chart, page, expected[i], after, out);
      }
    }
    return out;
  }

  static void compare_page(const AtlasChart& chart, std::size_t page, const reference::FilledChart& expected,
                           const reference::AtlasPixels& after, Difference& out) {
    for (std::size_t level = 0; level < atlas::kLevels; ++level) {
      const int side = 16 >> level, width = side * chart.pages.x();
      for (int k = 0; k < side * side; ++k) {
        const int x = static_cast<int>(page) % chart.pages.x() * side + k % side,
                  y = static_cast<int>(page) / chart.pages.x() * side + k / side;
        const Eigen::Vector4d got =
            reference::to_vector(after.at(chart.page[page].colour, static_cast<int>(level), k % side, k / side));
        const Eigen::Vector4d& want = expected.levels[level][static_cast<std::size_t>(y * width + x)];
        out.alpha[level] = std::max(out.alpha[level], 31 * std::abs(got.w() - want.w()));
        if (want.w() > 0)
          out.colour[level] = std::max(out.colour[level], 255 * (got - want).head<3>().cwiseAbs().maxCoeff());
        out.filled += level == 0 && std::abs(31 * got.w() - 1) < 1e-6;
      }
    }
  }

  // Every level is rounded to eight bits before the next is made of it: half a step each, up to
  // the top and down again.
  static void expect_small(const Difference& d) {
    for (std::size_t level = 0; level < atlas::kLevels; ++level) {
      EXPECT_LT(d.colour[level], 3.5) << "level " << level;
      EXPECT_LE(d.alpha[level], level == 0 ? 0 : 1.01) << "level " << level;
    }
    EXPECT_LT(d.coarse, 3);
    EXPECT_GT(d.filled, 2000);
  }
};

TEST_P(FillOfCharts, EveryLevelIsThatOfTheReference) {
  make(GetParam());
  extract(usual_view());
  const auto before = charts(bench_->pixels());
  const auto expected = reference::fill(before);
  bench_->fill();
  expect_small(compare(before, expected));
  const reference::Generation generation = bench_->generation();
  double worst_mean = 0;
  int handed_on = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Eigen::Vector4d mean = generation.means[i];
    EXPECT_NEAR(mean.w(), expected[i].mean.w(), 1e-6) << "chart " << i;
    if (mean.w() > 0) worst_mean = std::max(worst_mean, 255 * (mean - expected[i].mean).cwiseAbs().maxCoeff());
    handed_on += mean.w() > 0 && mean.w() < 1;
  }
  EXPECT_GT(handed_on, 2);
  EXPECT_LT(worst_mean, 3);
}

// The same view again, darker: nothing new is seen, so that only the pages of this image's turn are filled anew.
TEST_P(FillOfCharts, WhatWasFilledBeforeIsKeptUntilItsTurn) {
  make(GetParam());
  bench_->run({posed_photograph(*bench_->scene, state_of(*bench_->scene), lens_, usual_view())});
  for (int turn = 1; turn < 4; ++turn) {
    bench_->look({posed_photograph(*bench_->scene, state_of(*bench_->scene), lens_, usual_view(), 1 - 0.2 * turn)});
    bench_->cull(), bench_->allocate(), bench_->relevel(), bench_->extract();
    const auto before = charts(bench_->pixels(), turn);
    const auto expected = reference::fill(before);
    bench_->fill();
    expect_small(compare(before, expected));
  }
}

// Charts of a few pages, and of up to ten a side.
INSTANTIATE_TEST_SUITE_P(Extents, FillOfCharts, testing::Values(0.0, 1.5));

TEST_F(FillTest, SeenTexelsAreNeverTouchedAndFilledOnesGiveWay) {
  make();
  extract(usual_view());
  for (const Pose& next : {look_at({0.9, -0.6, 0.7}, {0, 0, 0.1}), usual_view()}) {
    const auto before = charts(bench_->pixels());
    bench_->fill();
    const auto after = charts(bench_->pixels());
    int seen = 0, holes = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      for (std::size_t k = 0; k < before[i].texels.size(); ++k)
        if (before[i].texels[k][3] >= 2) {
          ++seen;
          ASSERT_EQ(after[i].texels[k], before[i].texels[k]);
        } else {
          ASSERT_LT(after[i].texels[k][3], 2) << "a filled texel must not look like a seen one";
          holes += after[i].texels[k][3] == 1;
        }
    EXPECT_GT(seen, 10000);
    EXPECT_GT(holes, 1000);
    extract(next);
  }
  // The second look sees the other sides: what was filled there is seen now.
  bench_->fill();
  int gave_way = 0;
  for (const auto& chart : charts(bench_->pixels()))
    for (const auto& t : chart.texels) gave_way += t[3] >= 2;
  EXPECT_GT(gave_way, 15000);
}

// A page whose holes are all filled already follows the colours around it within eight images.
TEST_F(FillTest, FilledTexelsFollowWithinEightImages) {
  make();
  bench_->run({posed_photograph(*bench_->scene, state_of(*bench_->scene), lens_, usual_view())});
  const auto first = charts(bench_->pixels());
  for (int i = 0; i < 8; ++i)
    bench_->run({posed_photograph(*bench_->scene, state_of(*bench_->scene), lens_, usual_view(), 0.5)});
  const auto last = charts(bench_->pixels());
  int followed = 0, stayed = 0;
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t k = 0; k < first[i].texels.size(); ++k) {
      const reference::Texel &a = first[i].texels[k], &b = last[i].texels[k];
      const auto row = static_cast<std::size_t>(16 * first[i].pages.x()), x = k % row, y = k / row;
      const auto page = y / 16 * static_cast<std::size_t>(first[i].pages.x()) + x / 16;
      if (a[3] != 1 || b[3] != 1 || a[1] < 40 || !last[i].holes[page][y % 16 / 8 * 2 + x % 16 / 8]) continue;
      (b[1] < 0.6 * a[1] ? followed : stayed) += 1;
    }
  EXPECT_GT(followed, 1000);
  EXPECT_LT(stayed, followed / 25) << "pages that no image touched keep theirs";
}

}  // namespace
}  // namespace foresight::fill_pass_test
