// cull.comp and exposure.comp against one point at a time; agreement.comp with images that lie beside their place.
#include "texture_gpu/survey_pass.hpp"

#include <opencv2/imgproc.hpp>

#include "tests/support/headless_test.hpp"
#include "tests/texture_gpu/pass_bench.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight::survey_pass_test {
namespace {

using reference::Answer;

class SurveyOfLenses : public HeadlessTest, public testing::WithParamInterface<const char*> {
 protected:
  void look(const Pose& T_world_camera, double gain = 1) {
    const Lens lens = small_lens(GetParam());
    if (!bench_)
      bench_ = std::make_unique<PassBench>(small_scene(), std::vector{lens}, TextureOptions{.memory_bytes = 12 << 20});
    bench_->look({posed_photograph(*bench_->scene, state_of(*bench_->scene), lens, T_world_camera, gain)});
  }
  std::unique_ptr<PassBench> bench_;
};

TEST_P(SurveyOfLenses, NoTileWithASeenTexelIsCulled) {
  int seen_tiles = 0, kept = 0, tiles = 0;
  for (const Pose& T_world_camera :
       {usual_view(), look_at({0.5, -0.6, 0.25}, {0, 0, 0.1}), look_at({-0.25, -0.1, 0.2}, {0.05, 0.1, 0.1})}) {
    look(T_world_camera);
    const reference::Camera camera = bench_->camera(0);
    const auto masks = bench_->cull();
    for (std::size_t i = 0; i < masks.size(); ++i) {
      const PageRecord& record = bench_->records[i];
      const AtlasChart& chart = bench_->atlas.charts()[record.chart];
      const Patch& patch = bench_->patch_of(record.chart);
      const Pose& T = camera.T_camera_node[static_cast<std::size_t>(patch.node)];
      const bool turned_away = bench_->turned_away(record.chart);
      for (int tile = 0; tile < 4; ++tile) {
        bool seen = false;
        for (int k = 0; k < 64 && !seen && !turned_away; ++k) {
          const int x = 16 * static_cast<int>(record.xy & 0xffff) + 8 * (tile & 1) + k % 8;
          const int y = 16 * static_cast<int>(record.xy >> 16) + 8 * (tile >> 1) + k / 8;
          if (!bench_->raw_height(chart, x, y)) continue;
          Eigen::Vector2d pixel;
          seen = reference::is_seen(camera, T * bench_->texel_point(chart, patch, x, y),
                                    bench_->options.depth_tolerance, pixel) == Answer::yes;
        }
        const bool bit = (masks[i] >> (2 * tile) & 1) != 0;
        ++tiles;
        kept += bit;
        seen_tiles += seen;
        ASSERT_TRUE(bit || !seen) << "chart " << record.chart << ", tile " << tile;
        ASSERT_FALSE(masks[i] >> (2 * tile + 1) & 1) << "there is no second camera";
      }
    }
    bench_->allocate();
    bench_->relevel();
    bench_->extract();
    bench_->fill();
  }
  EXPECT_GT(seen_tiles, 300);
  // Conservative, but not idle: about a third more than what is seen, and far from all.
  EXPECT_LT(kept, seen_tiles * 1.45);
  EXPECT_LT(kept, tiles * 0.7);
}

TEST_P(SurveyOfLenses, BrightnessIsTheMeanOfThePagesGrid) {
  const Pose close = look_at({-0.45, -0.3, 0.4}, {0.02, 0, 0.1});
  look(close);
  bench_->cull();
  bench_->allocate();
  bench_->relevel();
  bench_->extract();
  bench_->fill();
  look(close, 0.8);
  bench_->cull();
  const reference::Camera camera = bench_->camera(0);
  const auto samples = bench_->survey.brightness(bench_->inputs, bench_->next->charts, bench_->store, bench_->records,
                                                 0, bench_->options.depth_tolerance);
  ASSERT_EQ(samples.size(), bench_->records.size());
  int compared = 0, unseen = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PageRecord& record = bench_->records[i];
    const AtlasChart& chart = bench_->atlas.charts()[record.chart];
    const Patch& patch = bench_->patch_of(record.chart);
    double sum = 0;
    Eigen::Vector2d center(0, 0);
    int count = 0, borderline = 0;
    for (int k = 0; k < 16 && record.height_slot != atlas::kNoSlot; ++k) {
      const int x = 16 * static_cast<int>(record.xy & 0xffff) + 4 * (k & 3) + 2,
                y = 16 * static_cast<int>(record.xy >> 16) + 4 * (k >> 2) + 2;
      if (!bench_->raw_height(chart, x, y)) continue;
      Eigen::Vector2d pixel;
      const Answer seen = reference::is_seen(
          camera, camera.T_camera_node[static_cast<std::size_t>(patch.node)] * bench_->texel_point(chart, patch, x, y),
          bench_->options.depth_tolerance, pixel);
      borderline += seen == Answer::borderline;
      if (seen != Answer::yes) continue;
      // One bilinear sample.
      const int x0 = static_cast<int>(std::floor(pixel.x())), y0 = static_cast<int>(std::floor(pixel.y()));
      const double fx = pixel.x() - x0, fy = pixel.y() - y0;
      for (int j = 0; j < 4; ++j) {
        const auto& v = camera.image.at<cv::Vec3b>(y0 + (j >> 1), x0 + (j & 1));
        sum += (j & 1 ? fx : 1 - fx) * (j >> 1 ? fy : 1 - fy) * (0.114 * v[0] + 0.587 * v[1] + 0.299 * v[2]) / 255;
      }
      center += pixel;
      ++count;
    }
    if (borderline) continue;
    if (count < 12) {
      ++unseen;
      EXPECT_EQ(samples[i].brightness, -1);
      continue;
    }
    ++compared;
    const Eigen::Vector2d half(79.5, 59.5);
    ASSERT_NEAR(samples[i].brightness, sum / count, 0.004) << "one step of 255";
    ASSERT_NEAR(samples[i].radius2, ((center / count - half) / half.norm()).squaredNorm(), 1e-3);
  }
  EXPECT_GT(compared, 10);
  EXPECT_GT(unseen, 20);
  const auto from_tenth =
      bench_->survey.brightness(bench_->inputs, bench_->next->charts, bench_->store,
                                std::span(bench_->records).subspan(10), 0, bench_->options.depth_tolerance);
  ASSERT_EQ(from_tenth.size(), samples.size() - 10);
  for (std::size_t i = 0; i < from_tenth.size(); ++i) EXPECT_EQ(from_tenth[i].brightness, samples[10 + i].brightness);
}

/// Each look at it takes long: whatever is measured by it is to be divided.
class SlowClock final : public Clock {
 public:
  RobotTime now() const noexcept override { return {ns_ += 20'000'000}; }
  void sleep_until(RobotTime) noexcept override {}

 private:
  mutable std::int64_t ns_ = 0;
};

// Camera 1 looks as the image before did, camera 0 as the newest one.
TEST_P(SurveyOfLenses, TellsWhichTilesTheNewestImageMisses) {
  const Lens lens = small_lens(GetParam());
  PassBench b(small_scene(), {lens, lens}, TextureOptions{.memory_bytes = 12 << 20});
  const auto image = [&](const Pose& T, double block_x) {
    return posed_photograph(*b.scene, state_of(*b.scene, block_x), lens, T);
  };
  const std::vector<PosedImage> images{image(look_at({-0.55, -0.95, 0.7}, {0.15, 0, 0.1}), 0.1),
                                       image(usual_view(), 0)};
  b.run(images);
  b.look(images);
  const auto masks = b.cull();
  std::vector<Eigen::Vector4f> geometry;
  b.atlas.write_page_geometry(masks, b.views, geometry);
  const auto missed = b.survey.missed(b.inputs, geometry, b.store, masks, b.options.depth_tolerance, b.options.worse);
  SlowClock clock;
  FrameGate gate(clock);
  const SlicedWork work(&gate, "survey");
  for (int i = 0; i < 3; ++i) {  // what it costs is known from the first time
    EXPECT_EQ(b.survey.cull(b.inputs, b.next->charts, b.options.depth_tolerance, &gate), masks);
    const auto in_slices =
        b.survey.missed(b.inputs, geometry, b.store, masks, b.options.depth_tolerance, b.options.worse, &gate);
    EXPECT_EQ(in_slices.masks, missed.masks);
    EXPECT_EQ(in_slices.coarser, missed.coarser);
    EXPECT_EQ(in_slices.hidden, missed.hidden);
  }
  const reference::Camera newest = b.camera(0), before = b.camera(1);
  ASSERT_EQ(missed.masks.size(), masks.size());
  int listed = 0, hidden = 0, texels_missed = 0, texels_overlooked = 0, texels_of_hidden = 0, texels_shown = 0;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const PageRecord& record = b.records[i];
    const AtlasChart& chart = b.atlas.charts()[record.chart];
    const Patch& patch = b.patch_of(record.chart);
    const auto node = static_cast<std::size_t>(patch.node);
    for (int tile = 0; tile < 4; ++tile) {
      const bool answer = (missed.masks[i] >> (2 * tile) & 3) != 0;
      EXPECT_EQ(missed.masks[i] & ~masks[i], 0u) << "what no camera may see is not asked for";
      const bool is_hidden = (missed.hidden[i] >> (2 * tile) & 3) != 0;
      hidden += is_hidden;
      int lost = 0, worse = 0;
      for (int k = 0; k < 64; ++k) {
        const int x = 16 * static_cast<int>(record.xy & 0xffff) + 8 * (tile & 1) + k % 8;
        const int y = 16 * static_cast<int>(record.xy >> 16) + 8 * (tile >> 1) + k / 8;
        if (!b.raw_height(chart, x, y)) continue;
        const Eigen::Vector3d p = b.texel_point(chart, patch, x, y);
        Eigen::Vector2d then, now;
        const Answer seen_then =
            reference::is_seen(before, before.T_camera_node[node] * p, b.options.depth_tolerance, then);
        const Answer seen_now =
            reference::is_seen(newest, newest.T_camera_node[node] * p, b.options.depth_tolerance, now);
        lost += seen_then == Answer::yes && seen_now == Answer::no;
        texels_of_hidden += is_hidden;
        texels_shown += is_hidden && seen_now == Answer::yes;
        const auto rim = [](const Eigen::Vector2d& at) {
          return std::min({at.x(), at.y(), 159 - at.x(), 119 - at.y(), 6.0});
        };
        worse += seen_then != Answer::no && (seen_now != Answer::yes || rim(now) < rim(then));
      }
      if (!(masks[i] >> (2 * tile) & 3)) continue;
      listed += answer;
      texels_missed += lost;
      if (!answer) texels_overlooked += lost;
      if (answer && std::ranges::find(missed.coarser, i) == missed.coarser.end()) {
        EXPECT_GT(worse, 0) << "chart " << record.chart << ", tile " << tile;
      }
    }
  }
  EXPECT_GT(listed, 20);
  EXPECT_GT(texels_missed, 500);
  EXPECT_GT(hidden, 20);
  EXPECT_LT(texels_shown, texels_of_hidden / 50) << "slivers between the points, of " << texels_of_hidden;
  // Slivers between the points, and of fewer than two of them: silhouettes are long in pictures of 160 x 120 px.
  const bool coarse = std::string(GetParam()) == "wide_fisheye";  // 1.3 degrees a pixel
  EXPECT_LT(texels_overlooked, texels_missed / (coarse ? 3 : 12)) << "of " << texels_missed;
}

// What an image that lies `off_px` beside its place differs from the textures, per gradient.
TEST_P(SurveyOfLenses, AgreementTellsHowFarAnImageLiesBesideItsPlace) {
  look(look_at({-0.45, -0.3, 0.4}, {0.02, 0, 0.1}));
  // As soft as a camera's lens leaves it: the photograph itself has grain between its pixels.
  const PosedImage photograph = bench_->images[0];
  const auto moved = [&](double off_px, double gain) {
    cv::Mat soft, out;
    cv::GaussianBlur(photograph.pixels, soft, {}, 1);
    cv::warpAffine(gain * soft, out, cv::Matx23d(1, 0, off_px, 0, 1, 0), soft.size(), cv::INTER_CUBIC,
                   cv::BORDER_REPLICATE);
    PosedImage image = photograph;
    image.pixels = out;
    return std::vector{image};
  };
  bench_->run(moved(0, 1));
  const auto differs = [&](double off_px, double gain) {
    bench_->look(moved(off_px, gain));
    bench_->cull();
    const auto samples = bench_->survey.agreement(bench_->inputs, bench_->next->charts, bench_->store, bench_->records,
                                                  *bench_->current, bench_->options.depth_tolerance);
    double difference2 = 0, gradient2 = 0;
    int told = 0;
    for (const AgreementSample& sample : samples) {
      if (sample.difference2 < 0) continue;
      ++told;
      difference2 += sample.difference2;
      gradient2 += sample.gradient2;
    }
    EXPECT_GT(told, 10);
    return difference2 / gradient2;
  };
  EXPECT_LT(differs(0, 1), 0.02);
  EXPECT_LT(differs(0, 0.7), 0.03) << "exposure is no misplacement";
  const double half = differs(0.5, 1), one = differs(1, 1);
  // Along one of two axes: 0.125, and up to twice that where the picture is as fine as its pixels.
  EXPECT_GT(half, 0.09);
  EXPECT_LT(half, 0.27);
  EXPECT_NEAR(one / half, 3.5, 1);
}

INSTANTIATE_TEST_SUITE_P(Lenses, SurveyOfLenses, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

}  // namespace
}  // namespace foresight::survey_pass_test
