// The whole core: what is published, what the display still holds, and what memory it takes.
#include "texture_gpu/texture_core.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <set>

#include "tests/support/golden.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/atlas_pixels.hpp"
#include "texture_gpu/chart_raster.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight::texture_core_test {
namespace {

class TextureCoreTest : public HeadlessTest {
 protected:
  void make(TextureOptions options = {.memory_bytes = 12 << 20}) {
    core_.reset();
    latest_ = std::make_unique<LatestTextures>();
    core_ = std::make_unique<TextureCore>(scene_, surface_, lens_, std::nullopt, options, driver_.is_software);
  }
  PosedFrame frame(const Pose& T_world_camera, double block_x = 0, double gain = 1) const {
    return {posed_photograph(*scene_, state_of(*scene_, block_x), lens_, T_world_camera, gain), std::nullopt};
  }
  ExtractionReport process(const PosedFrame& frame) { return core_->process(frame, *latest_); }
  reference::Generation generation(const PublishedTextures& textures) const {
    return {textures, surface_->charts.size()};
  }

  static Pose orbit(int i) { return look_at({-1.0 + 0.06 * i, -0.45 - 0.03 * i, 0.8 - 0.02 * i}, {0.02, 0, 0.1}); }

  /// Level-0 texels of the pages of one node, in the order of its charts (nothing for pages without a slot).
  std::vector<reference::Texel> texels_of(int node, const reference::Generation& g,
                                          const reference::AtlasPixels& pixels) const {
    std::vector<reference::Texel> out;
    for (const reference::ChartCopy& chart : g.charts) {
      if (chart.node != node || chart.density.x() <= 0) continue;
      for (int page = 0; page < chart.pages.prod(); ++page) {
        const std::uint32_t slot = g.table[static_cast<std::size_t>(chart.first_page + page)];
        for (int k = 0; k < 256; ++k)
          out.push_back(slot == atlas::kNoSlot ? reference::Texel{} : pixels.at(slot, 0, k % 16, k / 16));
      }
    }
    return out;
  }

  /// Mean and worst distance of seen texels of `node` from the true paint there, in steps of 255.
  std::pair<double, double> paint_error(int node, int& count) const {
    const TextureLease lease = latest_->acquire();
    const reference::Generation g = generation(*lease);
    const reference::AtlasPixels pixels(*lease->colours);
    double sum = 0, worst = 0;
    count = 0;
    for (std::size_t i = 0; i < g.charts.size(); ++i) {
      const reference::ChartCopy& chart = g.charts[i];
      if (chart.node != node || chart.density.x() <= 0) continue;
      const ChartRaster raster = raster_chart(*surface_, static_cast<int>(i), chart.density);
      for (int y = 0; y < raster.height; ++y)
        for (int x = 0; x < raster.width; ++x) {
          const std::uint16_t raw = raster.raw[static_cast<std::size_t>(y * raster.width + x)];
          const std::uint32_t slot =
              g.table[static_cast<std::size_t>(chart.first_page + y / 16 * chart.pages.x() + x / 16)];
          if (!(raw & ChartRaster::kCore) || slot == atlas::kNoSlot) continue;
          const reference::Texel t = pixels.at(slot, 0, x % 16, y % 16);
          if (t[3] < 2) continue;
          const Eigen::Vector3d p = chart.origin + x * chart.eu + y * chart.ev + ((raw & 0x7fff) - 1) * chart.eh;
          if (at_contact(state_of(*scene_), node, p, 0.03)) continue;
          const double off = (255 * paint(node, p) - Eigen::Vector3d(t[2], t[1], t[0])).cwiseAbs().maxCoeff();
          sum += off;
          worst = std::max(worst, off);
          ++count;
        }
    }
    return {sum / std::max(1, count), worst};
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  Lens lens_ = small_lens("plumb_bob");
  std::unique_ptr<LatestTextures> latest_;
  std::unique_ptr<TextureCore> core_;
};

TEST_F(TextureCoreTest, ReportsWhatItDid) {
  make();
  EXPECT_FALSE(latest_->acquire());
  PosedFrame first = frame(orbit(0));
  first.left.time = RobotTime{42};
  const ExtractionReport report = process(first);
  EXPECT_TRUE(report.published);
  EXPECT_EQ(report.number, 1u);
  EXPECT_EQ(report.newest_image.ns, 42);
  EXPECT_GT(report.pages, 50u);
  EXPECT_GT(report.tiles, report.pages);
  EXPECT_EQ(report.texels_resident, report.pages * 256);
  EXPECT_EQ(report.bytes_in_use, report.pages * (atlas::kColourBytes + atlas::kHeightBytes));
  std::vector<std::string> stages;
  for (const StageCost& cost : report.stages) {
    stages.push_back(cost.name);
    EXPECT_GE(cost.cpu_ms, 0);
    EXPECT_EQ(cost.gpu_ms.has_value(), !driver_.is_software) << "a software renderer has no GPU time";
  }
  EXPECT_THAT(stages, testing::ElementsAre("upload", "depth", "edges", "plan", "prepare", "exposure", "extract", "fill",
                                           "publish"));
  const TextureLease lease = latest_->acquire();
  EXPECT_EQ(lease->number, 1u);
  EXPECT_EQ(lease->newest_image.ns, 42);
  EXPECT_EQ(process(frame(orbit(1))).number, 2u);
}

// The texture belongs to the node: when the block moves, its colours do not change place on it.
TEST_F(TextureCoreTest, TheTextureOfAMovedNodeMovesWithIt) {
  make();
  process(frame(orbit(0)));
  int count = 0;
  for (const auto& [node, name] : {std::pair(kBlock, "block"), {kTable, "table"}, {kBox, "box"}}) {
    const auto [mean, worst] = paint_error(node, count);
    // The photograph's own rounding and one more; waves of 20 cm are smooth at this resolution.
    EXPECT_LT(mean, 3) << name << ", " << count << " texels";
    EXPECT_GT(count, 200) << name;
  }
  for (int i = 1; i <= 5; ++i) process(frame(orbit(0), 0.05 * i));
  const auto [mean, worst] = paint_error(kBlock, count);
  EXPECT_LT(mean, 3) << count << " texels of the moved block";
  EXPECT_GT(count, 200);
}

// Between its steps it is no business of a display's: what runs then is no slice of it.
TEST_F(TextureCoreTest, NoStepLeavesASliceBegun) {
  make();
  MonotonicClock clock;
  FrameGate gate(clock);
  core_->use(&gate);
  LatestImages images;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(core_->look(frame(orbit(i)), images), i > 0) << "the first image is shown by its textures";
    EXPECT_FALSE(gate.in_work()) << "after a look at image " << i;
    EXPECT_TRUE(core_->extract(*latest_).published);
    EXPECT_FALSE(gate.in_work()) << "after extracting image " << i;
  }
  process(frame(orbit(3)));
  EXPECT_FALSE(gate.in_work());
}

// Leases hold their generation bit by bit, while newer ones come and go.
TEST_F(TextureCoreTest, ALeasedGenerationNeverChanges) {
  make();
  process(frame(orbit(0)));
  const auto snapshot = [&](const PublishedTextures& textures) {
    const reference::Generation g = generation(textures);
    const reference::AtlasPixels pixels(*textures.colours);
    std::vector<reference::Texel> texels;
    for (std::uint32_t slot : g.table) {
      if (slot == atlas::kNoSlot) continue;
      for (int level = 0; level < atlas::kLevels; ++level)
        for (int k = 0; k < (256 >> 2 * level); ++k)
          texels.push_back(pixels.at(slot, level, k % (16 >> level), k / (16 >> level)));
    }
    return std::tuple(g.table, g.coarse, g.means, texels);
  };
  const TextureLease held = latest_->acquire();
  const auto before = snapshot(*held);
  ASSERT_GT(std::get<3>(before).size(), 20000u);
  for (int i = 1; i <= 8; ++i) {
    // Nearer and nearer: charts change their resolution and pages their slots.
    ASSERT_TRUE(process(frame(look_at(Eigen::Vector3d(-1.0, -0.45, 0.8) * (1 - 0.07 * i), {0.02, 0, 0.1}), 0.02 * i,
                              1 - 0.05 * i))
                    .published);
    ASSERT_EQ(snapshot(*held), before) << "after " << i << " images";
  }
  EXPECT_EQ(latest_->acquire()->number, 9u);
}

TEST_F(TextureCoreTest, GenerationsAreUsedAgainWhenNobodyHoldsThem) {
  make();
  std::set<const PublishedTextures*> places;
  for (int i = 0; i < 12; ++i) {
    process(frame(orbit(i % 3)));
    places.insert(&*latest_->acquire());
  }
  EXPECT_LE(places.size(), 3u);
}

// Two runs of the same images give the same textures, bit by bit.
TEST_F(TextureCoreTest, IdenticalRunsGiveIdenticalTextures) {
  std::vector<std::pair<std::vector<reference::Texel>, std::vector<Eigen::Vector4d>>> runs;
  for (int run = 0; run < 2; ++run) {
    make();
    for (int i = 0; i < 5; ++i) process(frame(orbit(2 * i), 0.03 * i, 1 + 0.04 * i));
    const TextureLease lease = latest_->acquire();
    const reference::AtlasPixels pixels(*lease->colours);
    const reference::Generation g = generation(*lease);
    std::vector<reference::Texel> all;
    for (int node : {kTable, kBox, kBlock, kBoard}) {
      const auto texels = texels_of(node, g, pixels);
      all.insert(all.end(), texels.begin(), texels.end());
    }
    runs.emplace_back(std::move(all), g.coarse);
  }
  EXPECT_GT(runs[0].first.size(), 20000u);
  EXPECT_TRUE(runs[0] == runs[1]);
}

TEST_F(TextureCoreTest, SmallBudgetsAreKept) {
  constexpr std::uint64_t kTight = 1150 << 10, kSome = 1900 << 10, kPlenty = 30 << 20;
  for (const std::uint64_t budget : {kTight, kSome, kPlenty}) {
    make({.memory_bytes = budget});
    ExtractionReport report;
    std::uint64_t most = 0;
    for (int i = 0; i < 8; ++i) {
      report = process(frame(look_at(Eigen::Vector3d(-1.0 + 0.1 * i, -0.45, 0.8) * (1 - 0.06 * i), {0.02, 0, 0.1})));
      EXPECT_TRUE(report.published);
      most = std::max(most, report.bytes_in_use);
    }
    EXPECT_LE(most, budget);
    EXPECT_LE(report.bytes_reserved, budget);
    EXPECT_LE(most, report.bytes_reserved);
    if (budget < kPlenty) {
      EXPECT_GT(report.bytes_reserved, budget / 2);
    }
    if (budget == kPlenty) {
      EXPECT_LT(report.bytes_reserved, 3 * most) << "what nobody needs is not reserved";
    }
    if (budget == kTight) {
      EXPECT_GT(report.policy.evicted_pages + static_cast<std::uint64_t>(report.policy.steps_down), 0u);
    }
    if (budget == kPlenty) {
      EXPECT_EQ(report.policy.steps_down, 0);
      EXPECT_EQ(report.policy.evicted_pages, 0u);
    }
    int count = 0;
    const auto [mean, worst] = paint_error(kTable, count);
    EXPECT_GT(count, 1000) << budget;
    EXPECT_LT(mean, 6) << "lowered resolutions blur, but show the right thing";
  }
}

TEST_F(TextureCoreTest, AnAbsurdBudgetFailsWithACure) {
  EXPECT_THROW(make({.memory_bytes = 20000}), RuntimeFailure) << "not even one row of pages";
  make({.memory_bytes = 210000});  // one row: fewer pages than charts in view
  try {
    process(frame(orbit(0)));
    FAIL() << "accepted";
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(),
                testing::AllOf(testing::HasSubstr("out of texture memory"), testing::HasSubstr("--texture-memory-mb")));
  }
}

// A display that never gives back its textures stalls the extraction, but does not break it.
TEST_F(TextureCoreTest, DropsAnImageWhereTheDisplayHoldsEverything) {
  make({.memory_bytes = 1900 << 10});
  std::vector<TextureLease> held;
  bool dropped = false;
  for (int i = 0; i < 6 && !dropped; ++i) {
    dropped = !process(frame(orbit(i))).published;
    held.push_back(latest_->acquire());
  }
  EXPECT_TRUE(dropped);
  const std::uint64_t number = held.back()->number;
  held.clear();
  const ExtractionReport report = process(frame(orbit(7)));
  EXPECT_TRUE(report.published);
  EXPECT_EQ(report.number, number + 1);
}

TEST_F(TextureCoreTest, FollowsTheGainOfTheImages) {
  make();
  for (int i = 0; i < 20; ++i) {
    const double gain = 1 + 0.15 * std::sin(0.5 * i);  // against the first image, whose gain is 1
    const ExtractionReport report = process(frame(orbit(i % 4), 0, gain));
    EXPECT_NEAR(std::exp(report.log_gain), gain, 0.01) << "image " << i;
    EXPECT_NEAR(latest_->acquire()->display_gain, std::exp(report.log_gain), 1e-5);
  }
  int count = 0;
  const auto [mean, worst] = paint_error(kTable, count);
  EXPECT_LT(mean, 4) << "textures stay at the first image's exposure";
  make({.memory_bytes = 12 << 20, .even_exposure = false});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(process(frame(orbit(0), 0, 1 - 0.2 * i)).log_gain, 0);
}

// Far more pages than are compared with each image.
TEST_F(TextureCoreTest, KnowsTheGainOfTheSecondLargeImage) {
  Lens::Parameters large;
  large.width = 960, large.height = 720;
  large.fx = 780, large.fy = 790, large.cx = 479, large.cy = 361;
  lens_ = Lens(large);
  make({.memory_bytes = 256 << 20});
  EXPECT_GT(process(frame(orbit(0))).pages, 1500u);
  for (const double gain : {0.8, 0.9, 1.1}) {
    const ExtractionReport report = process(frame(orbit(0), 0, gain));
    EXPECT_NEAR(std::exp(report.log_gain), gain, 0.01);
  }
}

TEST_F(TextureCoreTest, MatchesTheGoldenAtlas) {
  make();
  process(frame(orbit(0)));
  process(frame(orbit(4), 0.05));
  // Two rows of pages of each node, in the order of the page table, independent of their slots.
  const TextureLease lease = latest_->acquire();
  const reference::Generation g = generation(*lease);
  const reference::AtlasPixels pixels(*lease->colours);
  constexpr int kColumns = 10;
  cv::Mat picture(16 * 2 * 4, 16 * kColumns, CV_8UC3, cv::Scalar::all(0));
  for (int node = 0; node < 4; ++node) {
    const auto texels = texels_of(node, g, pixels);
    int place = 0;
    for (std::size_t page = 0; page < texels.size() / 256 && place < 2 * kColumns; ++page) {
      const auto seen = std::count_if(texels.begin() + static_cast<std::ptrdiff_t>(256 * page),
                                      texels.begin() + static_cast<std::ptrdiff_t>(256 * page + 256),
                                      [](const auto& t) { return t[3] >= 2; });
      if (seen < 60) continue;
      for (int k = 0; k < 256; ++k) {
        const reference::Texel& t = texels[256 * page + static_cast<std::size_t>(k)];
        picture.at<cv::Vec3b>(32 * node + 16 * (place / kColumns) + k / 16, 16 * (place % kColumns) + k % 16) = {
            t[2], t[1], t[0]};
      }
      ++place;
    }
    EXPECT_GT(place, 2) << "node " << node;
  }
  // Rounding of colours; texels whose depth test or edge falls on the other side: one in a hundred.
  EXPECT_TRUE(matches_golden(picture, "atlas", {0.5, 6, 0.01}));
}

// What two cameras show about equally well is one camera's, not patches of both.
TEST_F(TextureCoreTest, TheSecondCameraColoursWhatItSeesClearlyFiner) {
  const auto error_with_second_at = [&](double distance) {
    latest_ = std::make_unique<LatestTextures>();
    core_ = std::make_unique<TextureCore>(scene_, surface_, lens_, lens_,
                                          TextureOptions{.memory_bytes = 12 << 20, .even_exposure = false},
                                          driver_.is_software);
    const Eigen::Vector3d eye{-1.0, -0.45, 0.8}, target{0.02, 0, 0.1};
    PosedFrame both = frame(look_at(eye, target));
    both.right = frame(look_at(target + distance * (eye - target), target)).left;
    cv::cvtColor(both.right->pixels, both.right->pixels, cv::COLOR_BGR2RGB);
    process(both);
    int count = 0;
    const double error = paint_error(kBox, count).first;
    EXPECT_GT(count, 100);
    return error;
  };
  EXPECT_LT(error_with_second_at(0.95), 4);
  EXPECT_GT(error_with_second_at(0.5), 12);
}

}  // namespace
}  // namespace foresight::texture_core_test
