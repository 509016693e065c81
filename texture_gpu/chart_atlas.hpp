// Which charts have which resolution, and where their pages lie. Pure bookkeeping on the CPU.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "texture_gpu/chart_raster.hpp"
#include "texture_gpu/chart_resolution.hpp"
#include "texture_gpu/options.hpp"
#include "texture_gpu/packed_heights.hpp"
#include "texture_gpu/slot_pool.hpp"
#include "texture_gpu/tile_planes.hpp"

namespace foresight {

/// A page as cull.comp reads it.
struct PageRecord {
  std::uint32_t chart, xy, height_slot, unused = 0;
  std::array<std::array<std::uint32_t, 2>, 4> tiles{};  ///< packed(TilePlane); turned away from all: no surface

  /// Whether it is one of those that are looked after at image number `image`, when each is at every `images`-th.
  bool has_turn(std::int64_t image, std::uint64_t images) const {
    return (chart + xy + (xy >> 16) + static_cast<std::uint64_t>(image)) % images == 0;
  }
};

/// A page to be written, as jobs.glsl reads it.
struct PageJob {
  std::uint32_t chart, xy, old_slot, new_slot;
  std::uint32_t height_slot, table_index, covered;
  float worse = 0;  ///< TextureOptions::worse for it; 0: whatever was seen before, the new image takes its place
};

/// What a page's brightness in new images is compared with (exposure.hpp).
struct PageExposure {
  float log_brightness = 0;        ///< when it was last taken as a reference
  float log_surface = 0;           ///< mean over all such images: log brightness less the image's gain
  float radius2 = 0, radius4 = 0;  ///< means of r^2 and r^4 there, r the distance from the image's centre
  std::int64_t image = -1;         ///< the last of them; -1: none yet
  int count = 0;                   ///< how many, up to a limit
  bool rough = false;              ///< of a somewhat other area of the surface: to be renewed at once
  std::array<float, 2> hue{0, 0};  ///< ExposureSample's logarithms of red and blue, at the first image's white balance:
  int hue_count = 0;               ///< means over so many images of the left camera, up to a limit
};

struct AtlasPage {
  std::uint32_t colour = atlas::kNoSlot;
  std::uint32_t height = atlas::kNoSlot;
  std::array<TilePlane, 4> tiles{};
  std::uint16_t covered = 0;    ///< texels on the surface
  std::uint8_t held = 0;        ///< a bit for each tile: some texel was seen, or has been carried over
  std::int64_t last_seen = -1;  ///< image number
  /// Seen by each image from this one to `last_seen`; of use where images are extracted later than they are seen.
  std::int64_t seen_since = -1;
  std::int64_t written = -1;                              ///< the last image whose colours it has
  std::array<std::int64_t, 4> tile_from{-1, -1, -1, -1};  ///< the same of each tile, at its present resolution
  std::uint8_t settled = 0;                               ///< a bit for each tile: that image showed nothing new of it
  std::int64_t hidden_in = -1;                            ///< an image that shows nothing of some tiles
  std::uint8_t hidden = 0;                                ///< a bit for each of them
  PageExposure exposure;
};

/// A chart at its present resolution.
struct AtlasChart {
  Eigen::Vector2i level{kNoLevel, kNoLevel};  ///< density is 2^(level / 4); kNoLevel: no texels yet
  Eigen::Vector2d wanted{0, 0};               ///< texels per metre along u and v of the closest view so far
  ChartRaster raster;                         ///< without its heights
  PackedHeights heights;                      ///< of the raster
  Eigen::Vector2i pages{0, 0};
  int first_page = 0;  ///< in the page table
  std::vector<AtlasPage> page;
  bool in_view = false;
  int most_seen = 0;               ///< tiles, by one image
  std::int64_t more_seen_in = -1;  ///< the image of these
  /// Set from a change of resolution until commit(): what the published generation still holds.
  struct Before {
    Eigen::Vector2d density{0, 0};
    Eigen::Vector2d uv0{0, 0};
    Eigen::Vector2i pages{0, 0};
    std::vector<bool> resident;
  };
  std::optional<Before> before;
  bool relevelled = true;  ///< the page grid is new since commit()
  static constexpr int kNoLevel = -100000;
};

/// Two-step allocation for each image: plan() decides resolutions and names the pages that may be
/// seen; after the GPU has tested them, allocate() gives slots to those that are.
///
/// Memory policy: pages not in view lose their place first, those unseen for longest before
/// others; if what is in view does not fit, all resolutions fall by steps of 2^(1/4), and rise
/// again when what is in view needs less than half. One thread.
class ChartAtlas {
 public:
  ChartAtlas(std::shared_ptr<const SurfacePatches> surface, const TextureOptions& options);

  /// Resident pages that the memory budget allows, with room for a second generation of each;
  /// 0 where not even one row of pages fits.
  static std::uint32_t page_capacity(std::uint64_t memory_bytes);

  const SurfacePatches& surface() const { return *surface_; }
  const std::vector<AtlasChart>& charts() const { return charts_; }
  int page_count() const { return page_count_; }  ///< length of the page table
  std::uint32_t resident_pages() const { return heights_.used(); }
  std::uint32_t colour_slots_in_use() const { return colours_.used(); }
  std::uint32_t colour_capacity() const { return colours_.capacity(); }
  std::uint32_t height_capacity() const { return heights_.capacity(); }
  std::uint64_t bytes_in_use() const;

  struct Slots {
    std::uint32_t colours = 0, heights = 0;
    std::uint64_t bytes() const { return colours * atlas::kColourBytes + heights * atlas::kHeightBytes; }
  };
  /// All places that allocate() may give for these masks lie below.
  Slots reach(std::span<const std::uint32_t> masks) const;
  /// The GPU cannot hold more: from now on the memory policy makes do with so many places.
  void limit(const Slots& slots);

  /// Chooses each chart's resolution for the views of an image and rasterises what changed. Returns the pages that may
  /// be seen, in table order.
  std::span<const PageRecord> plan(std::span<const AtlasView> views);

  struct Allocation {
    std::vector<PageJob> jobs;        ///< pages to extract, each with a new place for its colours
    std::vector<std::uint8_t> masks;  ///< of each job, as cull.comp gave them
    std::vector<PageJob> relevel;     ///< pages to be filled from the previous generation first
    std::vector<std::pair<std::uint32_t, int>> new_heights;  ///< (chart, page) whose heights the GPU lacks
    std::vector<std::uint32_t> retired;                      ///< colour slots that the previous generation still shows
    bool fits = true;                                        ///< false: resolutions were lowered, plan() again
  };

  /// Image number `image` sees these pages of the last plan(), whether or not they are written now.
  void note_seen(std::span<const std::uint32_t> masks, std::int64_t image);
  /// Of these masks of the last plan(), what has no colours yet. Of tiles that were written, but of which no texel was
  /// seen for certain, those only whose chart has no colours at all, when they have their turn or more of the chart is
  /// seen than ever before.
  std::vector<std::uint32_t> not_held(std::span<const std::uint32_t> masks, std::int64_t image) const;
  /// Of these masks, what image number `image` may tell something about: not what has its colours from it, or from one
  /// of the few before it that showed nothing new, but for those before image `since`. Of what has no colours, the next
  /// image may tell.
  std::vector<std::uint32_t> stale(std::span<const std::uint32_t> masks, std::int64_t image, std::int64_t since) const;
  /// Image number `image` shows nothing of the tiles in these masks of the last plan(), though it might have.
  void note_hidden(std::span<const std::uint32_t> masks, std::int64_t image);
  /// Of these masks, likewise, without tiles of which that is known of image number `image`.
  std::vector<std::uint32_t> not_hidden(std::span<const std::uint32_t> masks, std::int64_t image) const;
  /// What an image showed of these jobs (of an Allocation): of each tile, as holes.glsl notes it.
  void note_holes(const Allocation& done, std::span<const std::uint32_t> holes);
  /// From image number `image` on, a page of the last plan() is seen far more coarsely than before.
  void note_coarser(std::size_t record, std::int64_t image);

  /// `masks`: one per record of the last plan(), zero for what is not to be written. Throws RuntimeFailure where even
  /// the smallest pages do not fit. `fits` false leaves nothing allocated.
  /// Needs one free colour slot for each page with a mask and each page to be re-levelled: at most
  /// slots_needed() of them.
  Allocation allocate(std::span<const std::uint32_t> masks, std::int64_t image);

  struct PagePlace {
    std::uint32_t chart;
    int page;  ///< of the chart
  };
  /// All places that renew() may give for so many pages lie below.
  Slots reach(std::size_t pages) const;
  /// Gives these pages, which have colours, new places for them. Needs a free colour slot for each. `masks` are 0.
  Allocation renew(std::span<const PagePlace> pages);

  /// A ball around what the chart has on the page.
  struct Ball {
    std::size_t node;        ///< in whose frame it is
    Eigen::Vector3d middle;  ///< metres
    double radius;           ///< metres
  };
  Ball ball_around(std::size_t chart, int page) const;

  /// Free colour slots that allocate() needs for these masks.
  std::size_t slots_needed(std::span<const std::uint32_t> masks) const;
  std::uint32_t free_colour_slots() const { return colours_.free(); }

  /// The pages of the last plan() with the height slots that allocate() gave them.
  std::span<const PageRecord> placed_records();

  /// The allocation was published: re-levelling is done.
  void commit();

  void give_back_colours(std::span<const std::uint32_t> slots);

  AtlasPage& page_of(const PageRecord& record);
  const AtlasPage& page_of(const PageRecord& record) const;

  /// For the GPU: per job and view four vec4, the page's corner and texel axes in camera
  /// coordinates (extract.comp).
  void write_job_geometry(std::span<const PageJob> jobs, std::span<const AtlasView> views,
                          std::vector<Eigen::Vector4f>& out) const;

  /// The same for each page of the last plan() that has a mask (missed.comp).
  void write_page_geometry(std::span<const std::uint32_t> masks, std::span<const AtlasView> views,
                           std::vector<Eigen::Vector4f>& out) const;

  /// For the GPU: the page table, and five vec4 per chart (chart_record.glsl).
  void write_table(std::vector<std::uint32_t>& out) const;
  void write_charts(std::vector<Eigen::Vector4f>& out) const;

  /// Actions of the memory policy so far.
  struct Policy {
    std::uint64_t evicted_pages = 0;
    int steps_down = 0, steps_up = 0;
    int bias = 0;  ///< present offset of all levels, <= 0
  };
  const Policy& policy() const { return policy_; }

 private:
  Eigen::Vector2i wanted_level(int chart) const;
  void set_level(int index, const Eigen::Vector2i& level);
  void lay_out();
  void collect_records(std::span<const AtlasView> views);
  bool needs_relevel(const AtlasChart& chart, int page) const;
  float worse_for(const AtlasPage& page) const;
  static void note_written(AtlasPage& page, std::uint32_t mask, std::int64_t image, bool carried_over);
  bool make_room(std::size_t heights_needed, std::int64_t image);
  bool lower_resolution();
  void drop_page(AtlasPage& page);
  static void hand_on(const std::vector<AtlasPage>& old, const ChartRaster& before, const Eigen::Vector2i& pages,
                      AtlasChart& chart);
  int page_index(const PageRecord& r) const;
  void append_geometry(const PageJob& job, std::span<const AtlasView> views, std::vector<Eigen::Vector4f>& out) const;

  std::shared_ptr<const SurfacePatches> surface_;
  TextureOptions options_;
  std::vector<AtlasChart> charts_;
  SlotPool heights_, colours_;
  int page_count_ = 0;
  std::vector<PageRecord> records_;
  std::vector<std::uint32_t> retired_;  // colour slots given up since the last commit
  std::size_t pages_in_view_ = 0;
  int quiet_images_ = 0;
  Policy policy_;
};

}  // namespace foresight
