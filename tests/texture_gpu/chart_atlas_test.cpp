// The bookkeeping of charts and pages, without a GPU: the masks are made up.
#include "texture_gpu/chart_atlas.hpp"

#include <gmock/gmock.h>

#include <set>

#include "common/error.hpp"
#include "scene/primitives.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::chart_atlas_test {
namespace {

/// An atlas over the small scene that takes every page that may be seen as seen.
class Atlas {
 public:
  explicit Atlas(TextureOptions options = {}, const std::string& lens = "pinhole")
      : scene_(small_scene()),
        lens_(small_lens(lens)),
        faces_(gl::faces_for(lens_, 5)),
        atlas_(std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {})), options) {}

  std::vector<AtlasView> view(const Pose& T_world_camera) const {
    AtlasView view{&lens_, &faces_, {}};
    for (const Pose& T : state_of(*scene_).T_world_node) view.T_camera_node.push_back(T_world_camera.inverse() * T);
    return {view};
  }

  /// One image as TextureCore takes it; what it retires comes back at once.
  ChartAtlas::Allocation take(const Pose& T_world_camera, std::uint32_t mask = 0x55) {
    for (;;) {
      const auto records = atlas_.plan(view(T_world_camera));
      auto out = atlas_.allocate(std::vector<std::uint32_t>(records.size(), mask), image_);
      if (!out.fits) continue;
      atlas_.commit();
      atlas_.give_back_colours(out.retired);
      ++image_;
      return out;
    }
  }

  ChartAtlas* operator->() { return &atlas_; }
  ChartAtlas& operator*() { return atlas_; }
  const Lens& lens() const { return lens_; }

 private:
  std::shared_ptr<const SceneModel> scene_;
  Lens lens_;
  gl::Faces faces_;
  ChartAtlas atlas_;
  std::int64_t image_ = 0;
};

Pose closer(double factor) {
  return look_at(Eigen::Vector3d(-1.0, -0.45, 0.8) * factor, {0.02, 0, 0.1});
}

TEST(ChartAtlas, GivesAboutOneTexelPerPixel) {
  Atlas atlas;
  atlas.take(usual_view());
  const auto views = atlas.view(usual_view());
  int charts = 0;
  for (std::size_t i = 0; i < atlas->charts().size(); ++i) {
    const AtlasChart& chart = atlas->charts()[i];
    const Chart& shape = atlas->surface().charts[i];
    if (!chart.in_view || chart.raster.density.x() <= 0) continue;
    const Patch& patch = atlas->surface().patches[static_cast<std::size_t>(shape.patch)];
    const Pose& T = views[0].T_camera_node[static_cast<std::size_t>(patch.node)];
    // Project a texel's steps at the chart's centre: at least as many texels as pixels, and less
    // than the headroom (a quarter step), the rounding (half a step) and the depth within the chart
    // can make of it: a factor of two. Along the line of sight no less than a quarter of head-on.
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector3d step = (axis == 0 ? patch.eu : patch.ev) / chart.raster.density[axis];
      const auto a = atlas.lens().project(T * shape.center), b = atlas.lens().project(T * (shape.center + step));
      ASSERT_TRUE(a && b);
      EXPECT_LT((*b - *a).norm(), 1.35) << "chart " << i;
      EXPECT_GT((*b - *a).norm(), 0.1) << "chart " << i;
    }
    ++charts;
  }
  EXPECT_GT(charts, 20);
}

TEST(ChartAtlas, ResolutionRisesWithACloserViewAndStaysWhenItLeaves) {
  Atlas atlas;
  atlas.take(usual_view());
  const auto levels = [&] {
    std::vector<Eigen::Vector2i> all;
    for (const AtlasChart& chart : atlas->charts()) all.push_back(chart.level);
    return all;
  };
  const auto first = levels();
  atlas.take(closer(0.97));  // less than one step of 2^(1/4) closer: nothing is copied
  EXPECT_EQ(levels(), first);
  atlas.take(closer(0.5));
  const auto near = levels();
  int risen = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].x() == AtlasChart::kNoLevel) continue;
    EXPECT_TRUE((near[i].array() >= first[i].array()).all());
    risen += near[i] != first[i];
  }
  EXPECT_GT(risen, 10);
  atlas.take(usual_view());
  EXPECT_EQ(levels(), near);
}

TEST(ChartAtlas, TellsHowFarPlacesWillReach) {
  Atlas atlas;
  for (int image = 0; image < 6; ++image) {
    const auto records = atlas->plan(atlas.view(closer(1 - 0.1 * image)));
    const std::vector<std::uint32_t> masks(records.size(), 0x55);
    const ChartAtlas::Slots reach = atlas->reach(masks);
    const auto out = atlas->allocate(masks, image);
    ASSERT_TRUE(out.fits);
    for (const PageJob& job : out.jobs) {
      EXPECT_LT(job.new_slot, reach.colours);
      EXPECT_LT(job.height_slot, reach.heights);
    }
    atlas->commit();
    atlas->give_back_colours(out.retired);
  }
}

TEST(ChartAtlas, MakesDoWithWhatTheGpuHas) {
  Atlas atlas;
  atlas.take(usual_view());
  const std::uint32_t pages = atlas->resident_pages();
  atlas->limit({2 * pages, pages});
  atlas.take(closer(0.4));  // nearer: four times as many texels, were there room
  EXPECT_LE(atlas->resident_pages(), pages);
  EXPECT_GT(atlas->policy().steps_down, 0);
}

TEST(ChartAtlas, DensityIsLimitedAndLargestSizeIsKept) {
  Atlas free;
  free.take(usual_view());
  int at_limit = 0, below = 0;
  Atlas capped({.texels_per_metre = 77});
  capped.take(usual_view());
  for (std::size_t i = 0; i < capped->charts().size(); ++i) {
    const AtlasChart& chart = capped->charts()[i];
    EXPECT_EQ(chart.raster.density.x() > 0, free->charts()[i].raster.density.x() > 0);
    if (chart.raster.density.x() <= 0) continue;
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_LE(chart.raster.density[axis], 77);
      if (chart.wanted[axis] >= 77) {
        EXPECT_GT(chart.raster.density[axis], 77 * std::exp2(-0.25 / 4)) << "a quarter of a step of rounding";
        ++at_limit;
      } else {
        // Seen from farther away than that: as without a limit, where that is below it.
        EXPECT_EQ(chart.raster.density[axis], std::min(77.0, free->charts()[i].raster.density[axis]));
        ++below;
      }
    }
  }
  EXPECT_GT(at_limit, 10);
  // A limit that nothing reaches changes nothing.
  Atlas high({.texels_per_metre = 1e5});
  high.take(usual_view());
  for (std::size_t i = 0; i < high->charts().size(); ++i) EXPECT_EQ(high->charts()[i].level, free->charts()[i].level);
  // One below what the nearest view asks for, one above what the farthest does.
  Atlas between({.texels_per_metre = 130});
  between.take(usual_view());
  for (const AtlasChart& chart : between->charts())
    for (int axis = 0; axis < 2 && chart.raster.density.x() > 0; ++axis) below += chart.raster.density[axis] < 130;
  EXPECT_GT(below, 10);
  Atlas limited({.max_texture = 12});
  limited.take(closer(0.5));
  for (std::size_t i = 0; i < limited->charts().size(); ++i) {
    const AtlasChart& chart = limited->charts()[i];
    const Chart& shape = limited->surface().charts[i];
    EXPECT_LE((shape.upper - shape.lower).cwiseProduct(chart.raster.density).maxCoeff(), 12 + 1e-9);
  }
}

TEST(ChartAtlas, PagesAreCountedAndNeverShared) {
  Atlas atlas;
  for (double factor : {1.0, 0.8, 0.6, 0.6, 0.9}) {
    const auto allocation = atlas.take(closer(factor));
    std::set<std::uint32_t> colours, heights;
    std::size_t resident = 0;
    for (const AtlasChart& chart : atlas->charts())
      for (const AtlasPage& page : chart.page) {
        EXPECT_EQ(page.colour == atlas::kNoSlot, page.height == atlas::kNoSlot);
        if (page.colour == atlas::kNoSlot) continue;
        ++resident;
        EXPECT_TRUE(colours.insert(page.colour).second);
        EXPECT_TRUE(heights.insert(page.height).second);
      }
    EXPECT_EQ(atlas->resident_pages(), resident);
    EXPECT_EQ(atlas->colour_slots_in_use(), resident) << "all that was retired came back";
    EXPECT_EQ(atlas->bytes_in_use(), resident * (atlas::kColourBytes + atlas::kHeightBytes));
    EXPECT_GT(allocation.jobs.size(), 50u);
  }
}

TEST(ChartAtlas, NewColoursNeverGoWhereThePublishedOnesAre) {
  Atlas atlas;
  atlas.take(usual_view());
  std::vector<std::uint32_t> published;
  atlas->write_table(published);
  for (double factor : {1.0, 0.7}) {
    const std::set<std::uint32_t> shown(published.begin(), published.end());
    const auto allocation = atlas.take(closer(factor));
    ASSERT_FALSE(allocation.jobs.empty());
    for (const PageJob& job : allocation.jobs) EXPECT_FALSE(shown.contains(job.new_slot));
    for (std::uint32_t slot : allocation.retired) EXPECT_TRUE(shown.contains(slot));
    atlas->write_table(published);
  }
}

TEST(ChartAtlas, TheTableIsInTheOrderOfTheRecords) {
  Atlas atlas;
  const auto records = atlas->plan(atlas.view(usual_view()));
  ASSERT_FALSE(records.empty());
  std::vector<std::uint32_t> masks(records.size(), 0x01);
  const auto allocation = atlas->allocate(masks, 0);
  std::vector<std::uint32_t> table;
  atlas->write_table(table);
  ASSERT_EQ(table.size(), static_cast<std::size_t>(atlas->page_count()));
  EXPECT_EQ(allocation.jobs.size(), records.size());
  EXPECT_EQ(allocation.new_heights.size(), records.size());
  for (const PageJob& job : allocation.jobs) {
    EXPECT_EQ(table[job.table_index], job.new_slot);
    const AtlasChart& chart = atlas->charts()[job.chart];
    EXPECT_EQ(static_cast<int>(job.table_index),
              chart.first_page + static_cast<int>(job.xy >> 16) * chart.pages.x() + static_cast<int>(job.xy & 0xffff));
  }
}

// What the tiles' planes bound: tile_planes_test.cpp.
TEST(ChartAtlas, RecordsHoldTheTilesThatACameraMaySeeFromTheFront) {
  Atlas atlas;
  const auto views = atlas.view(usual_view());
  int kept = 0, dropped = 0;
  for (const PageRecord& record : atlas->plan(views)) {
    ChartRaster r = atlas->charts()[record.chart].raster;
    r.raw = atlas->charts()[record.chart].heights.unpacked();
    const Chart& shape = atlas->surface().charts[record.chart];
    const Patch& patch = atlas->surface().patches[static_cast<std::size_t>(shape.patch)];
    const Eigen::Vector3d s =
        views[0].T_camera_node[static_cast<std::size_t>(patch.node)].inverse().translation() - patch.origin;
    const Eigen::Vector3d eye(s.dot(patch.eu), s.dot(patch.ev), s.dot(patch.n));
    const auto planes = find_tile_planes(atlas->surface(), static_cast<int>(record.chart), r);
    const int across = (r.width + 7) / 8, down = (r.height + 7) / 8;
    int surfaces = 0;
    for (int tile = 0; tile < 4; ++tile) {
      const int x = 2 * static_cast<int>(record.xy & 0xffff) + tile % 2,
                y = 2 * static_cast<int>(record.xy >> 16) + tile / 2;
      TilePlane plane;
      if (x < across && y < down) plane = planes[static_cast<std::size_t>(y * across + x)];
      const Eigen::Vector2d uv = r.uv0 + Eigen::Vector2d(8 * x + 3.5, 8 * y + 3.5).cwiseQuotient(r.density);
      if (shape.closed() && faces_away(plane, r, uv, eye)) {
        dropped += plane.residual >= 0;
        plane.residual = -1;
      }
      surfaces += plane.residual >= 0;
      ASSERT_EQ(record.tiles[static_cast<std::size_t>(tile)], packed(plane, r));
    }
    EXPECT_GT(surfaces, 0) << "a page without any tile is not asked about";
    kept += surfaces;
  }
  EXPECT_GT(kept, 300);
  EXPECT_EQ(dropped, 0) << "charts of boxes are flat: they face away as a whole, and are not in view then";
}

// A sphere's charts bend around its outline: there single tiles face away.
TEST(ChartAtlas, TilesBehindTheOutlineOfASolidAreDropped) {
  const SceneModel scene({{"sphere", make_sphere(0.3), -1, Pose::Identity()}});
  const Lens lens = small_lens("pinhole");
  const gl::Faces faces = gl::faces_for(lens, 5);
  const auto surface = std::make_shared<SurfacePatches>(find_surface_patches(scene, {}));
  const Pose T_world_camera = look_at({-1, 0, 0.2}, {0, 0, 0});
  const std::vector<AtlasView> views{{&lens, &faces, {T_world_camera.inverse()}}};
  ChartAtlas atlas(surface, {});
  int dropped = 0, kept = 0;
  const auto records = atlas.plan(views);
  for (const PageRecord& record : records)
    for (std::size_t tile = 0; tile < 4; ++tile) {
      const AtlasPage& page = atlas.page_of(record);
      const bool away = record.tiles[tile] == packed({}, atlas.charts()[record.chart].raster);
      kept += !away;
      dropped += away && page.tiles[tile].residual >= 0;
    }
  EXPECT_GT(kept, 100);
  EXPECT_GT(dropped, 10);
  EXPECT_LT(records.size(), static_cast<std::size_t>(atlas.page_count())) << "pages without a tile are not asked about";
}

TEST(ChartAtlas, BacksOfSolidsAndWhatIsOutOfViewAreNotPlanned) {
  Atlas atlas;
  const auto views = atlas.view(usual_view());
  std::set<std::uint32_t> planned;
  for (const PageRecord& record : atlas->plan(views)) planned.insert(record.chart);
  int backs = 0;
  for (std::size_t i = 0; i < atlas->surface().charts.size(); ++i) {
    const Chart& chart = atlas->surface().charts[i];
    const Patch& patch = atlas->surface().patches[static_cast<std::size_t>(chart.patch)];
    const Pose& T = views[0].T_camera_node[static_cast<std::size_t>(patch.node)];
    const bool back = chart.closed() && chart.cone < 1e-3 && (T.linear() * patch.n).dot(T * chart.center) > 0;
    backs += back;
    EXPECT_FALSE(back && planned.contains(static_cast<std::uint32_t>(i)));
  }
  EXPECT_GT(backs, 5);
  EXPECT_TRUE(atlas->plan(atlas.view(look_at({0, 0, 1}, {0.1, 0, 2}))).empty());
}

// A room that was drawn as a box, seen from within: its walls turn their backs.
TEST(ChartAtlas, ASolidIsPlannedFromWithin) {
  const SceneModel scene({{"room", make_box({4, 4, 3}), -1, Pose::Identity()}});
  const Lens lens = small_lens("pinhole");
  const gl::Faces faces = gl::faces_for(lens, 5);
  const auto surface = std::make_shared<SurfacePatches>(find_surface_patches(scene, {}));
  ChartAtlas atlas(surface, {});
  const std::vector<AtlasView> views{{&lens, &faces, {look_at({-1, 0, 0}, {1, 0.3, -0.5}).inverse()}}};
  std::ptrdiff_t tiles = 0;
  for (const PageRecord& record : atlas.plan(views))
    tiles += std::ranges::count_if(
        record.tiles, [&](const auto& tile) { return tile != packed({}, atlas.charts()[record.chart].raster); });
  EXPECT_GT(tiles, 100);
}

constexpr std::uint64_t kPageBytes = 2 * atlas::kColourBytes + atlas::kHeightBytes;

/// Charts that a view shows: no fewer pages will do.
std::uint64_t charts_in_view(const Pose& T_world_camera) {
  Atlas atlas;
  atlas.take(T_world_camera);
  const auto& charts = atlas->charts();
  return static_cast<std::uint64_t>(
      std::count_if(charts.begin(), charts.end(), [](const AtlasChart& c) { return c.in_view; }));
}

// What is in view does not fit: resolutions fall until it does; the budget holds at every moment.
TEST(ChartAtlas, ASmallBudgetLowersTheResolution) {
  const std::uint64_t least = charts_in_view(usual_view());
  const auto whole_rows = [](std::uint64_t pages) { return (pages + 7) / 8 * 8; };  // what is reserved
  for (std::uint64_t pages : {whole_rows(least), whole_rows(2 * least)}) {
    const std::uint64_t budget = pages * kPageBytes;
    Atlas atlas({.memory_bytes = budget});
    EXPECT_EQ(atlas->height_capacity(), pages);
    EXPECT_EQ(atlas->colour_capacity(), 2 * pages);
    for (double factor : {1.0, 0.7, 0.5, 1.0}) {
      const auto allocation = atlas.take(closer(factor));
      EXPECT_FALSE(allocation.jobs.empty());
      EXPECT_LE(atlas->bytes_in_use(), budget);
      EXPECT_LE(atlas->resident_pages(), pages);
    }
    EXPECT_GT(atlas->policy().steps_down, 0);
    EXPECT_EQ(atlas->policy().bias, atlas->policy().steps_up - atlas->policy().steps_down);
  }
}

TEST(ChartAtlas, TheLongestUnseenPagesGoFirst) {
  // Two halves of the table, one after the other, with room for little more than one of them.
  const Pose left = look_at({-0.5, -0.3, 0.35}, {-0.45, -0.25, 0}),
             right = look_at({0.4, -0.4, 0.35}, {0.45, -0.35, 0});
  Atlas measure;
  const std::size_t first = measure.take(left).jobs.size(), both = measure.take(right).jobs.size() + first;
  const std::uint64_t pages = first + (both - first) * 3 / 4 + both / 10;
  ASSERT_LT(pages, both) << "the views overlap too much for this test";
  Atlas atlas({.memory_bytes = pages * kPageBytes});
  atlas.take(left);
  EXPECT_EQ(atlas->policy().evicted_pages, 0u);
  atlas.take(right);
  EXPECT_GT(atlas->policy().evicted_pages, 0u);
  EXPECT_EQ(atlas->policy().steps_down, 0) << "pages out of view go before any resolution falls";
  for (const AtlasChart& chart : atlas->charts())
    for (const AtlasPage& page : chart.page)
      if (page.last_seen == 1) {
        EXPECT_NE(page.colour, atlas::kNoSlot) << "a page in view was evicted";
      }
}

TEST(ChartAtlas, PagesAtAnotherResolutionRememberWhenTheyWereSeen) {
  Atlas atlas;
  atlas.take(usual_view());
  std::vector<Eigen::Vector2i> before;
  for (const AtlasChart& chart : atlas->charts()) before.push_back(chart.level);
  atlas.take(closer(0.5));
  int finer = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const AtlasChart& chart = atlas->charts()[i];
    if (before[i].x() == AtlasChart::kNoLevel || chart.level == before[i]) continue;
    for (const AtlasPage& page : chart.page) {
      if (page.colour == atlas::kNoSlot) continue;
      EXPECT_GE(page.last_seen, 0);
      ++finer;
    }
  }
  EXPECT_GT(finer, 10);
}

TEST(ChartAtlas, ResolutionsRiseAgainWhenHalfIsFree) {
  Atlas atlas({.memory_bytes = (charts_in_view(usual_view()) + 40) * kPageBytes});
  // Everything seems to be seen until the resolution fell; then it turns out that a third is.
  std::uint32_t share = 1;
  for (int tries = 0;; ++tries) {
    const auto records = atlas->plan(atlas.view(closer(0.7)));
    std::vector<std::uint32_t> masks(records.size(), 0);
    for (std::size_t i = 0; i < masks.size(); i += share) masks[i] = 1;
    if (atlas->allocate(masks, 0).fits) break;
    share = 3;
    ASSERT_LT(tries, 100);
  }
  ASSERT_LT(2 * atlas->resident_pages(), atlas->height_capacity());
  const int bias = atlas->policy().bias;
  ASSERT_LT(bias, 0);
  for (int i = 0; i < 9; ++i) atlas->commit();
  EXPECT_EQ(atlas->policy().bias, bias) << "too early: resolutions would swing";
  atlas->commit();
  EXPECT_EQ(atlas->policy().bias, bias + 1);
  EXPECT_EQ(atlas->policy().steps_up, 1);
}

TEST(ChartAtlas, FailsWhereEvenTheSmallestPagesDoNotFit) {
  Atlas atlas({.memory_bytes = 70 * kPageBytes});
  try {
    atlas.take(usual_view());
    FAIL() << "accepted";
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(),
                testing::AllOf(testing::HasSubstr("out of texture memory"), testing::HasSubstr("64 fit"),
                               testing::HasSubstr("--texture-memory-mb")));
  }
}

TEST(ChartAtlas, ACopiedResolutionComesFromThePublishedOne) {
  Atlas atlas;
  atlas.take(usual_view());
  const auto records = atlas->plan(atlas.view(closer(0.5)));
  const std::vector<std::uint32_t> masks(records.size(), 0x55);
  EXPECT_LE(atlas->slots_needed(masks), atlas->free_colour_slots());
  const auto allocation = atlas->allocate(masks, 1);
  ASSERT_TRUE(allocation.fits);
  EXPECT_GT(allocation.relevel.size(), 50u);
  for (const PageJob& job : allocation.jobs) {
    const bool relevelled = std::any_of(allocation.relevel.begin(), allocation.relevel.end(),
                                        [&](const PageJob& r) { return r.new_slot == job.new_slot; });
    EXPECT_EQ(relevelled, job.old_slot == job.new_slot) << "re-levelled pages are extended in place, others are copied";
  }
}

constexpr std::uint32_t kUnseen = 3, kNews = 4;  // holes.glsl

// A pixel may see a tile and no texel of it for certain: beside silhouettes, or of parts a few pixels wide.
TEST(ChartAtlas, TilesOfWhichNothingWasSeenHaveNoColours) {
  Atlas atlas;
  const auto written = [&](std::int64_t image, std::uint32_t holes_of_first, std::uint32_t holes) {
    const std::vector<std::uint32_t> all(atlas->plan(atlas.view(usual_view())).size(), 0x55);
    const auto out = atlas->allocate(all, image);
    std::vector<std::uint32_t> found(4 * out.jobs.size(), holes);
    found[0] = holes_of_first;
    atlas->note_holes(out, found);
    atlas->commit();
    atlas->give_back_colours(out.retired);
    return all;
  };
  const std::vector<std::uint32_t> all = written(0, kUnseen, kUnseen);
  std::vector<int> asked(all.size());
  for (std::int64_t image = 1; image < 9; ++image)
    std::ranges::transform(atlas->not_held(all, image), asked, asked.begin(),
                           [](std::uint32_t mask, int times) { return times + (mask == 0x55 ? 1 : 0); });
  EXPECT_EQ(asked, std::vector<int>(all.size(), 2)) << "charts without any colours are asked for in turn";

  std::vector<std::uint32_t> fewer = all;
  std::ranges::fill(std::span(fewer).first(all.size() / 2), 0);
  const auto asked_for = [&](const std::vector<std::uint32_t>& seen, std::int64_t image) {
    atlas->note_seen(seen, image);
    return std::ranges::count(atlas->not_held(seen, image), std::uint32_t{0x55});
  };
  asked_for(fewer, 9);
  EXPECT_LT(asked_for(fewer, 10), std::ssize(all) / 2) << "no more of them is seen than before";
  EXPECT_GE(asked_for(all, 11), std::ssize(all) / 2) << "what comes into view is not black for long";
  EXPECT_EQ(atlas->stale(all, 11, 0), all) << "each image may be the first to tell their colours";

  written(12, kUnseen, kNews);
  written(13, kUnseen, kUnseen);
  std::vector<std::uint32_t> colourless(all.size(), 0);
  colourless[0] = 0x01;
  EXPECT_EQ(atlas->stale(all, 14, 0), colourless) << "the rest has colours that the image before agrees with";
  for (std::int64_t image = 14; image < 22; ++image)
    EXPECT_EQ(atlas->not_held(all, image), std::vector<std::uint32_t>(all.size(), 0))
        << "a chart that has colours elsewhere is filled from there";
}

// Images that are seen at once, and extracted only when the next one does not show the same.
TEST(ChartAtlas, WhatIsSeenNeedNotBeWritten) {
  Atlas atlas;
  const auto plan = [&] { return atlas->plan(atlas.view(usual_view())).size(); };
  const auto write = [&](std::span<const std::uint32_t> masks, std::int64_t image) {
    auto out = atlas->allocate(masks, image);
    atlas->note_holes(out, std::vector<std::uint32_t>(4 * out.jobs.size(), kNews));
    atlas->commit();
    atlas->give_back_colours(out.retired);
    return out;
  };
  std::vector<std::uint32_t> all(plan(), 0x55);
  EXPECT_EQ(atlas->not_held(all, 0), all);
  std::vector<std::uint32_t> some = all;
  some[0] = 0x01;
  some[1] = 0;
  EXPECT_EQ(write(some, 0).jobs.size(), all.size() - 1);

  ASSERT_EQ(plan(), all.size());
  atlas->note_seen(all, 1);
  std::vector<std::uint32_t> missing(all.size(), 0);
  missing[0] = 0x54;
  missing[1] = 0x55;
  EXPECT_EQ(atlas->not_held(all, 1), missing);
  for (const PageRecord& record : atlas->placed_records()) EXPECT_EQ(atlas->page_of(record).last_seen, 1);

  // Seen by every image since it was written: had all been extracted, each would have taken the place of the one
  // before.
  ASSERT_EQ(plan(), all.size());
  atlas->note_seen(all, 2);
  EXPECT_EQ(write(missing, 2).jobs[0].worse, 0);
  // After an image that did not see them, or from much further off, what is known is not given up for something far
  // coarser, but sooner with each image.
  ASSERT_EQ(plan(), all.size());
  atlas->note_seen(all, 4);
  for (const PageJob& job : write(missing, 4).jobs) EXPECT_FLOAT_EQ(job.worse, 0.3F);
  atlas->note_seen(all, 5);
  atlas->note_coarser(0, 6);
  atlas->note_seen(all, 6);
  for (int image = 7; image <= 38; ++image) atlas->note_seen(all, image);
  const auto out = write(missing, 38);
  EXPECT_FLOAT_EQ(out.jobs[0].worse, 0.15F);
  EXPECT_EQ(out.jobs[1].worse, 0);

  // What an image shows nothing of is known of that image alone.
  std::vector<std::uint32_t> hidden(all.size(), 0), rest = all;
  hidden[0] = 0x11;
  rest[0] = 0x44;
  atlas->note_hidden(hidden, 38);
  EXPECT_EQ(atlas->not_hidden(all, 38), rest);
  EXPECT_EQ(atlas->not_hidden(all, 39), all);
}

}  // namespace
}  // namespace foresight::chart_atlas_test
