// extract.comp, relevel.comp and copy.comp against one texel at a time.
#include "texture_gpu/extract_pass.hpp"

#include "tests/support/headless_test.hpp"
#include "tests/texture_gpu/pass_bench.hpp"

namespace foresight::extract_pass_test {
namespace {

using reference::Answer;

constexpr std::uint64_t kMemory = 12 << 20;
constexpr double kFiner = 1.5;  // than the first camera sees a texel, the second one has to

/// How far the GPU's texels are from the reference.
struct Agreement {
  int seen = 0, unseen = 0, borderline = 0, wrong = 0, kept = 0;
  double colour_sum = 0, colour_worst = 0, code_worst = 0;
  double colour_mean() const { return colour_sum / std::max(1, seen); }
};

class ExtractTest : public HeadlessTest {
 protected:
  void make(const std::vector<std::string>& kinds, TextureOptions options = {.memory_bytes = kMemory}) {
    for (const std::string& kind : kinds) lenses_.push_back(small_lens(kind));
    bench_ = std::make_unique<PassBench>(small_scene(), lenses_, options);
  }

  std::vector<PosedImage> photographs(const std::vector<Pose>& views, double block_x = 0) const {
    std::vector<PosedImage> images;
    for (std::size_t i = 0; i < views.size(); ++i)
      images.push_back(posed_photograph(*bench_->scene, state_of(*bench_->scene, block_x), lenses_[i], views[i]));
    return images;
  }

  /// Extracts `images` and compares every texel of every job. `sample`: colour at a pixel.
  template <typename Sample>
  Agreement compare(const std::vector<PosedImage>& images, double minify_above, Sample&& sample) {
    PassBench& b = *bench_;
    b.look(images);
    std::vector<reference::Camera> cameras;
    for (std::size_t i = 0; i < images.size(); ++i) cameras.push_back(b.camera(i));
    b.cull();
    b.allocate();
    b.relevel();
    const reference::AtlasPixels before = b.pixels();
    b.extract(minify_above);
    const reference::AtlasPixels after = b.pixels();

    Agreement out;
    for (std::size_t j = 0; j < b.allocation.jobs.size(); ++j) {
      const PageJob& job = b.allocation.jobs[j];
      const AtlasChart& chart = b.atlas.charts()[job.chart];
      const Patch& patch = b.patch_of(job.chart);
      const bool turned_away = b.turned_away(job.chart);
      for (int k = 0; k < 256; ++k) {
        const int px = k % 16, py = k / 16, x = 16 * static_cast<int>(job.xy & 0xffff) + px,
                  y = 16 * static_cast<int>(job.xy >> 16) + py;
        const reference::Texel got = after.at(job.new_slot, 0, px, py);
        const reference::Texel old =
            job.old_slot == atlas::kNoSlot ? reference::Texel{} : before.at(job.old_slot, 0, px, py);
        if (!b.raw_height(chart, x, y)) {
          out.wrong += got[3] > 1;  // at most filled
          continue;
        }
        const Eigen::Vector3d p_node = b.texel_point(chart, patch, x, y);
        // The resolution is found once for four texels below each other, at the third one.
        const Eigen::Vector3d p_middle = b.texel_point(chart, patch, x, y / 4 * 4 + 2);
        double best = 0, code = 0;
        Eigen::Vector3d colour(0, 0, 0);
        bool borderline = false;
        for (std::size_t c = 0; c < cameras.size() && !turned_away; ++c) {
          const Pose& T = cameras[c].T_camera_node[static_cast<std::size_t>(patch.node)];
          Eigen::Vector2d pixel;
          const Answer seen = reference::is_seen(cameras[c], T * p_node, b.options.depth_tolerance, pixel);
          borderline |= seen == Answer::borderline;
          if (seen != Answer::yes) continue;
          const Eigen::Matrix2d axes =
              reference::footprint(cameras[c], T * p_middle, T.linear() * patch.eu / chart.raster.density.x(),
                                   T.linear() * patch.ev / chart.raster.density.y());
          const double quality = std::sqrt(std::abs(axes.determinant()));
          borderline |= std::abs(quality - kFiner * best) < 0.01 * quality;
          if (quality <= kFiner * best) continue;
          best = quality;
          code = reference::quality_code(quality);
          colour = sample(cameras[c].image, pixel, axes);
        }
        const auto [fresh, fused] = reference::fuse(old[3], code, b.options.worse, its_turn(job, px, py));
        const double limit = old[3] + std::log2(b.options.worse) * 29 / 8;
        borderline |= code > 0 && old[3] >= 2 && std::abs(code - limit) < 1;
        if (borderline) {
          ++out.borderline;
          continue;
        }
        if (code == 0) {
          ++out.unseen;
          out.wrong += got != old;
        } else if (!fresh) {
          ++out.kept;
          out.wrong += got[0] != old[0] || got[1] != old[1] || got[2] != old[2] || got[3] != static_cast<int>(fused);
        } else {
          ++out.seen;
          out.wrong += got[3] < 2;
          const double off = 255 * (reference::to_vector(got).head<3>() - colour).cwiseAbs().maxCoeff();
          out.colour_sum += off;
          out.colour_worst = std::max(out.colour_worst, off);
          out.code_worst = std::max(out.code_worst, std::abs(got[3] - fused));
        }
      }
    }
    b.fill();
    return out;
  }

  Agreement compare(const std::vector<PosedImage>& images) {
    return compare(images, PassBench::kNever,
                   [](const cv::Mat& image, const Eigen::Vector2d& pixel, const Eigen::Matrix2d&) {
                     return reference::catmull_rom(image, pixel);
                   });
  }

  /// Whether a texel of a page ages with this image.
  bool its_turn(const PageJob& job, int x, int y) const {
    const int column = static_cast<int>(job.height_slot % 8), row = static_cast<int>(job.height_slot / 8 % 512);
    return (16 * column + x + 3 * (16 * row + y) + bench_->image) % 8 == 0;
  }

  std::vector<Lens> lenses_;
  std::unique_ptr<PassBench> bench_;
};

/// Position, depth test, edges, lens, filter and code of every texel of one image, then of a second
/// one that lies beside it. Texture units filter with 8-bit fractions (1/256 px), and colours are
/// rounded to 8 bits: half a step on average. Five taps leave out the kernel's corners, which hold
/// up to 1.6 % of its weight: a few steps where the picture has an edge.
void expect_agreement(const Agreement& a) {
  EXPECT_GT(a.seen, 5000);
  EXPECT_GT(a.unseen, 1000);
  EXPECT_EQ(a.wrong, 0);
  EXPECT_LT(a.borderline, (a.seen + a.unseen) / 20);
  EXPECT_LT(a.colour_mean(), 1.0);
  EXPECT_LT(a.colour_worst, 8);
  EXPECT_LE(a.code_worst, 1);
}

class ExtractOfLenses : public ExtractTest, public testing::WithParamInterface<const char*> {};

TEST_P(ExtractOfLenses, EveryTexelIsThatOfTheReference) {
  make({GetParam()});
  const Agreement first = compare(photographs({usual_view()}));
  expect_agreement(first);
  const Agreement second = compare(photographs({look_at({-0.8, -0.6, 0.7}, {0, 0, 0.1})}, 0.1));
  expect_agreement(second);
}

INSTANTIATE_TEST_SUITE_P(Lenses, ExtractOfLenses, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

TEST_F(ExtractTest, OfTwoCamerasTheFirstWinsUnlessTheOtherIsClearlySharper) {
  make({"pinhole", "plumb_bob"});
  const Agreement a = compare(photographs({usual_view(), look_at({-0.6, 0.55, 0.6}, {0.05, 0, 0.1})}));
  expect_agreement(a);
}

TEST_F(ExtractTest, FacesAndLensesMayDifferInKind) {
  make({"wide_fisheye", "pinhole"});
  const Agreement a = compare(photographs({usual_view(), look_at({-0.6, 0.55, 0.6}, {0.05, 0, 0.1})}));
  expect_agreement(a);
}

TEST_F(ExtractTest, WhatIsClearlyWorseWaitsAndAges) {
  make({"pinhole"}, {.memory_bytes = kMemory, .worse = 0.75});
  compare(photographs({usual_view()}));
  // From farther away: 1.6 times fewer pixels per texel, for some less.
  const Pose far = look_at(Eigen::Vector3d(-1.0, -0.45, 0.8) * 1.6, {0.02, 0, 0.1});
  const Agreement second = compare(photographs({far}));
  EXPECT_GT(second.kept, 5000);
  EXPECT_EQ(second.wrong, 0);
  // Eight images cost the old colour one of 3.6 steps of an octave: after enough of them it gives way.
  int images = 0;
  Agreement last = second;
  while (last.kept > last.seen && images < 40) last = compare(photographs({far})), ++images;
  EXPECT_EQ(last.wrong, 0);
  EXPECT_GT(images, 2);
  EXPECT_LT(images, 30);
}

TEST_F(ExtractTest, TexelsLargerThanPixelsAreMeans) {
  make({"pinhole"}, {.texels_per_metre = 45, .memory_bytes = kMemory});
  // Fine noise: a single sample would be off by tens of steps.
  std::vector<PosedImage> images = photographs({usual_view()});
  cv::Mat noise(images[0].pixels.size(), CV_8UC3);
  cv::theRNG().state = 9;
  cv::randu(noise, 0, 120);
  images[0].pixels += noise;
  const auto mean = [](const cv::Mat& image, const Eigen::Vector2d& pixel, const Eigen::Matrix2d& axes) {
    return reference::mean_over(image, pixel, axes);
  };
  const Agreement a = compare(images, 0, mean);
  EXPECT_GT(a.seen, 1000);
  EXPECT_EQ(a.wrong, 0);
  EXPECT_LE(a.code_worst, 1);
  // Noise of 120 steps has a deviation of 35. Taps of bilinear pixels are a smoother window than the
  // box of the reference, which costs a few steps; a single sample is off by more than twenty.
  EXPECT_LT(a.colour_mean(), 6);
  make({"pinhole"}, {.texels_per_metre = 45, .memory_bytes = kMemory});
  const Agreement sharp = compare(images, PassBench::kNever, mean);
  EXPECT_GT(sharp.colour_mean(), 4 * a.colour_mean()) << "this test would not see aliasing";
}

/// Mean of four bilinear samples in the middles of the quarters of the footprint.
Eigen::Vector3d four_taps(const cv::Mat& image, const Eigen::Vector2d& pixel, const Eigen::Matrix2d& axes) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& tap : {Eigen::Vector2d(1, 1), {1, -1}, {-1, 1}, {-1, -1}}) {
    const Eigen::Vector2d at = pixel + 0.25 * axes * tap, base = at.array().floor(), f = at - base;
    for (int i = 0; i < 4; ++i) {
      const int x = std::clamp(static_cast<int>(base.x()) + (i & 1), 0, image.cols - 1),
                y = std::clamp(static_cast<int>(base.y()) + (i >> 1), 0, image.rows - 1);
      const auto& v = image.at<cv::Vec3b>(y, x);
      sum +=
          0.25 * (i & 1 ? f.x() : 1 - f.x()) * (i >> 1 ? f.y() : 1 - f.y()) * Eigen::Vector3d(v[2], v[1], v[0]) / 255;
    }
  }
  return sum;
}

TEST_F(ExtractTest, TexelsSomewhatLargerThanPixelsTakeFourTaps) {
  make({"pinhole"}, {.texels_per_metre = 65, .memory_bytes = kMemory});
  std::vector<PosedImage> images = photographs({usual_view()});
  cv::Mat noise(images[0].pixels.size(), CV_8UC3);
  cv::theRNG().state = 9;
  cv::randu(noise, 0, 120);
  images[0].pixels += noise;
  // At 65 texels per metre they are 0.9 to 1.8 pixels large, but for a few pages.
  const Agreement a = compare(images, 0.9, [](const cv::Mat& image, const auto& pixel, const auto& axes) {
    return four_taps(image, pixel, axes);
  });
  EXPECT_GT(a.seen, 2000);
  EXPECT_EQ(a.wrong, 0);
  EXPECT_LE(a.code_worst, 1);
  EXPECT_LT(a.colour_mean(), 1.5);  // other ways are off by more than three
}

// Which of the three ways a page's colours are taken follows from its texels' size in pixels.
TEST_F(ExtractTest, TheSizeOfTexelsDecidesHowTheyAreSampled) {
  // A fine chequer: single samples keep its contrast, four taps over two pixels lose it, coarser levels too.
  const auto contrast = [&](double texels_per_metre, double minify_above) {
    lenses_.clear();
    make({"pinhole"}, {.texels_per_metre = texels_per_metre, .memory_bytes = kMemory});
    std::vector<PosedImage> images = photographs({usual_view()});
    for (int y = 0; y < images[0].pixels.rows; ++y)
      for (int x = 0; x < images[0].pixels.cols; ++x)
        images[0].pixels.at<cv::Vec3b>(y, x) = cv::Vec3b::all((x + y) % 2 ? 200 : 50);
    bench_->look(images);
    bench_->cull(), bench_->allocate(), bench_->relevel(), bench_->extract(minify_above);
    const reference::AtlasPixels pixels = bench_->pixels();
    double sum = 0;
    int count = 0;
    for (const PageJob& job : bench_->allocation.jobs)
      for (int k = 0; k < 256; ++k) {
        const reference::Texel t = pixels.at(job.new_slot, 0, k % 16, k / 16);
        if (t[3] >= 2) sum += std::abs(t[0] - 125), ++count;
      }
    EXPECT_GT(count, 500);
    return sum / count;
  };
  const double fine = contrast(0, 1.5), never = contrast(0, PassBench::kNever);
  EXPECT_NEAR(fine, never, 0.05 * never) << "texels of one pixel are sampled as they are";
  EXPECT_GT(fine, 15);
  EXPECT_LT(contrast(50, 1.5), 0.65 * contrast(50, PassBench::kNever)) << "two pixels";
  EXPECT_LT(contrast(20, 1.5), 0.15 * contrast(20, PassBench::kNever)) << "five pixels";
}

TEST_F(ExtractTest, TheToneIsTakenOut) {
  make({"pinhole"});
  const Eigen::Vector3f tone(0.8f, -0.3f, -0.1f);
  std::vector<PosedImage> images = photographs({usual_view()});
  images[0].pixels.setTo(cv::Scalar::all(100));
  bench_->look(images, {tone});
  const reference::Camera camera = bench_->camera(0);
  bench_->cull(), bench_->allocate(), bench_->relevel(), bench_->extract();
  const reference::AtlasPixels pixels = bench_->pixels();
  int compared = 0;
  for (const PageJob& job : bench_->allocation.jobs) {
    const AtlasChart& chart = bench_->atlas.charts()[job.chart];
    const Patch& patch = bench_->patch_of(job.chart);
    for (int k = 0; k < 256; k += 7) {
      const reference::Texel got = pixels.at(job.new_slot, 0, k % 16, k / 16);
      if (got[3] < 2) continue;
      const Eigen::Vector3d p = bench_->texel_point(chart, patch, 16 * static_cast<int>(job.xy & 0xffff) + k % 16,
                                                    16 * static_cast<int>(job.xy >> 16) + k / 16);
      const Eigen::Vector2d pixel =
          *camera.lens.project(camera.T_camera_node[static_cast<std::size_t>(patch.node)] * p);
      const double r2 = (pixel - Eigen::Vector2d(79.5, 59.5)).squaredNorm() / Eigen::Vector2d(79.5, 59.5).squaredNorm();
      ASSERT_NEAR(got[1], 100 * 0.8 * std::exp(r2 * (0.3 + 0.1 * r2)), 1.5);
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
}

// relevel.comp: each new texel is the cubic mean of the old ones around its place where all of them were seen, else the
// bilinear one of those that were.
TEST_F(ExtractTest, ANewResolutionStartsFromTheOldColours) {
  make({"pinhole"});
  bench_->run(photographs({usual_view()}));
  const reference::Generation old = bench_->generation();
  const reference::AtlasPixels before = bench_->pixels();
  bench_->look(photographs({look_at({-0.55, -0.25, 0.45}, {0.02, 0, 0.1})}));
  bench_->cull(), bench_->allocate();
  ASSERT_GT(bench_->allocation.relevel.size(), 50u);
  bench_->relevel();
  const reference::AtlasPixels after = bench_->pixels();
  int compared = 0, cubic = 0, wrong = 0, colourless = 0;
  double worst = 0, worst_code = 0;
  for (const PageJob& job : bench_->allocation.relevel) {
    const AtlasChart& fresh = bench_->atlas.charts()[job.chart];
    const reference::ChartCopy& chart = old.charts[job.chart];
    const Eigen::Vector2d ratio = chart.density.cwiseQuotient(fresh.raster.density);
    if (ratio.minCoeff() > 1.4) continue;  // from a coarser level; the others are plenty
    for (int k = 0; k < 256; ++k) {
      const Eigen::Vector2d uv =
          fresh.raster.uv0 + Eigen::Vector2d(16 * (job.xy & 0xffff) + static_cast<unsigned>(k % 16),
                                             16 * (job.xy >> 16) + static_cast<unsigned>(k / 16))
                                 .cwiseQuotient(fresh.raster.density);
      const Eigen::Vector2d texel = (uv - chart.uv0).cwiseProduct(chart.density);
      const auto fetch = [&](const Eigen::Vector2i& t) { return reference::texel_of(old, before, chart, 0, t); };
      Eigen::Vector4d sum(0, 0, 0, 0);
      double weight = 0;
      reference::bilinear(texel, [&](const Eigen::Vector2i& t, double w) {
        if (const Eigen::Vector4d c = fetch(t); 31 * c.w() > 1.5) sum += w * c, weight += w;
      });
      const reference::Texel got = after.at(job.new_slot, 0, k % 16, k / 16);
      const Eigen::Array2d halves = 2 * texel.array();  // there another row or column is the nearest, or the outermost
      if (std::abs(weight - 0.25) < 1e-3 || (halves - halves.round()).abs().minCoeff() < 2e-3) continue;
      if (weight < 0.25) {
        ++colourless;
        wrong += got != reference::Texel{};
        continue;
      }
      sum /= weight;
      const double code = std::clamp(31 * sum[3] + 0.5 * std::log2(ratio.prod()) / 8 * 29, 2.0, 31.0);
      if (const auto sharp = reference::cubic(texel, 0, fetch)) sum.head<3>() = sharp->cwiseMax(0).cwiseMin(1), ++cubic;
      ++compared;
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(got[static_cast<std::size_t>(c)] - 255 * sum[c]));
      worst_code = std::max(worst_code, std::abs(got[3] - code));
    }
  }
  EXPECT_GT(compared, 5000);
  EXPECT_GT(cubic, 2000);
  EXPECT_GT(colourless, 500);
  EXPECT_EQ(wrong, 0);
  // Both readings are rounded to eight bits, and so is what was written; float places of texels.
  EXPECT_LT(worst, 1.6);
  EXPECT_LT(worst_code, 0.8);
}

// A guard texel floats beside the surface, in front of whatever is behind: it must stay without colour.
TEST_F(ExtractTest, GuardTexelsTakeNoColourFromTheBackground) {
  make({"pinhole"});
  bench_->run(photographs({look_at({-0.7, -0.5, 0.3}, {0.02, 0.05, 0.12})}));
  const reference::AtlasPixels pixels = bench_->pixels();
  int guards = 0, coloured = 0, foreign = 0, core = 0;
  for (const PageJob& job : bench_->allocation.jobs) {
    const Patch& patch = bench_->patch_of(job.chart);
    if (patch.node != kBox) continue;
    const AtlasChart& chart = bench_->atlas.charts()[job.chart];
    for (int k = 0; k < 256; ++k) {
      const std::uint16_t raw = bench_->raw_height(chart, 16 * static_cast<int>(job.xy & 0xffff) + k % 16,
                                                   16 * static_cast<int>(job.xy >> 16) + k / 16);
      const reference::Texel got = pixels.at(job.new_slot, 0, k % 16, k / 16);
      if (!raw || got[3] < 2) {
        guards += raw && !(raw & ChartRaster::kCore);
        continue;
      }
      const bool guard = !(raw & ChartRaster::kCore);
      guards += guard;
      coloured += guard;
      core += !guard;
      // The box is red: three times as much as green. Table, board and block are not.
      // Around its foot no depth tells box and table apart, and filters mix them.
      const Eigen::Vector3d p_box = bench_->texel_point(chart, patch, 16 * static_cast<int>(job.xy & 0xffff) + k % 16,
                                                        16 * static_cast<int>(job.xy >> 16) + k / 16);
      if (at_contact(state_of(*bench_->scene), kBox, p_box, 0.01)) continue;
      foreign += got[0] < 2 * got[1];
    }
  }
  EXPECT_GT(core, 500);
  EXPECT_GT(guards, 200);
  EXPECT_GT(coloured, 0) << "guards within a chart's grid do lie on the surface";
  EXPECT_EQ(foreign, 0) << "of " << core + coloured;
}

// What stands in front leaves nothing on what lies behind it, even where the pose is off by some pixels.
TEST_F(ExtractTest, AnOccluderLeavesNothingBehindItself) {
  for (const auto& [margin, error_px] : {std::pair(3.0, 0.0), {3.0, 2.0}, {6.0, 4.0}, {0.0, 3.0}}) {
    lenses_.clear();
    make({"pinhole"}, {.memory_bytes = kMemory, .margin_px = margin});
    std::vector<PosedImage> images = photographs({usual_view()});
    // The true image, with a pose that is wrong by a small turn about the vertical.
    images[0].T_world_camera.linear() *= Eigen::AngleAxisd(error_px / 130, Eigen::Vector3d::UnitY()).toRotationMatrix();
    bench_->run(images);
    const reference::AtlasPixels pixels = bench_->pixels();
    int table = 0, red = 0;
    for (const PageJob& job : bench_->allocation.jobs) {
      const Patch& patch = bench_->patch_of(job.chart);
      if (patch.node != kTable && patch.node != kBoard) continue;
      const AtlasChart& chart = bench_->atlas.charts()[job.chart];
      const SceneState state = state_of(*bench_->scene);
      for (int k = 0; k < 256; ++k) {
        const reference::Texel got = pixels.at(job.new_slot, 0, k % 16, k / 16);
        if (got[3] < 2) continue;
        // Where the box stands on the table, nearer than the depth's tolerance and the margin's
        // few pixels of 7 mm, no depth tells them apart.
        const Eigen::Vector3d p = bench_->texel_point(chart, patch, 16 * static_cast<int>(job.xy & 0xffff) + k % 16,
                                                      16 * static_cast<int>(job.xy >> 16) + k / 16);
        if (at_contact(state, patch.node, p, 0.05)) continue;
        ++table;
        red += got[0] > 40 && got[0] > 1.5 * got[1];
      }
    }
    EXPECT_GT(table, 3000);
    if (margin > 0)
      EXPECT_EQ(red, 0) << "margin " << margin << ", pose off by " << error_px << " px";
    else
      EXPECT_GT(red, 20) << "without a margin this test must see it";
  }
}

}  // namespace
}  // namespace foresight::extract_pass_test
