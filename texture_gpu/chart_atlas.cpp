#include "texture_gpu/chart_atlas.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kLevelsPerOctave = 4;
constexpr int kLargestChart = 4096;    // texels along a side
constexpr int kImagesBeforeRise = 10;  // images with half of the memory free before resolutions rise

// Changing a chart's resolution copies it, so it waits until a view is closer by more than kRise
// steps, and then leaves some headroom. Only the memory policy makes charts coarser: by whole steps.
constexpr double kRise = 1.0, kHeadroom = 0.25, kFall = 0.8;

Eigen::Vector2d density_of(const Eigen::Vector2i& level) {
  return {std::exp2(level.x() / kLevelsPerOctave), std::exp2(level.y() / kLevelsPerOctave)};
}

std::uint32_t pack(int low, int high) {
  return static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 16;
}

/// What the pages know of the texels on them.
void describe_pages(const SurfacePatches& surface, int index, AtlasChart& chart) {
  const ChartRaster& r = chart.raster;
  const auto width = static_cast<std::size_t>(r.width);
  const auto page_at = [&](int x, int y) -> AtlasPage& {
    return chart.page[static_cast<std::size_t>((y / atlas::kPage) * chart.pages.x() + x / atlas::kPage)];
  };
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x)
      if (r.raw[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]) ++page_at(x, y).covered;
  const std::vector<TilePlane> planes = find_tile_planes(surface, index, r);
  const int across = (r.width + atlas::kTile - 1) / atlas::kTile;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const int x = static_cast<int>(i) % across, y = static_cast<int>(i) / across;
    page_at(x * atlas::kTile, y * atlas::kTile).tiles[static_cast<std::size_t>(y % 2 * 2 + x % 2)] = planes[i];
  }
}

}  // namespace

ChartAtlas::ChartAtlas(std::shared_ptr<const SurfacePatches> surface, const TextureOptions& options)
    : surface_(std::move(surface)),
      options_(options),
      charts_(surface_->charts.size()),
      heights_(page_capacity(options.memory_bytes)),
      colours_(2 * page_capacity(options.memory_bytes)) {}

std::uint32_t ChartAtlas::page_capacity(std::uint64_t memory_bytes) {
  const std::uint64_t a_page = 2 * atlas::kColourBytes + atlas::kHeightBytes;
  const std::uint64_t pages = std::min<std::uint64_t>(memory_bytes / a_page, 1u << 20);
  // What is reserved are whole layers, or whole rows of a single one; two colour slots a page.
  const std::uint64_t step = pages >= atlas::kSlotsPerLayer       ? atlas::kSlotsPerLayer
                             : pages >= atlas::kSlotsPerLayer / 2 ? atlas::kSlotsPerLayer / 2
                                                                  : atlas::kSlotsPerRow;
  return static_cast<std::uint32_t>(pages / step * step);
}

std::uint64_t ChartAtlas::bytes_in_use() const {
  return Slots{colours_.used(), heights_.used()}.bytes();
}

void ChartAtlas::limit(const Slots& slots) {
  colours_.limit(slots.colours);
  heights_.limit(slots.heights);
}

Eigen::Vector2i ChartAtlas::wanted_level(int index) const {
  const AtlasChart& chart = charts_[static_cast<std::size_t>(index)];
  const Chart& shape = surface_->charts[static_cast<std::size_t>(index)];
  const bool limited = options_.max_texture > 0;
  const int most = limited ? std::min(options_.max_texture, kLargestChart) : kLargestChart;
  Eigen::Vector2i level = chart.level;
  for (int i = 0; i < 2; ++i) {
    const double density =
        options_.texels_per_metre > 0 ? std::min(options_.texels_per_metre, chart.wanted[i]) : chart.wanted[i];
    const double side = std::max({1e-9, shape.upper[i] - shape.lower[i], limited ? shape.polygon[i] : 0.0});
    const int limit = static_cast<int>(std::floor(kLevelsPerOctave * std::log2(most / side)));
    const double exact = kLevelsPerOctave * std::log2(density) + policy_.bias;
    const bool fits = exact - chart.level[i] < kRise && exact - chart.level[i] > -kFall && chart.level[i] <= limit;
    if (!fits) level[i] = std::min(static_cast<int>(std::lround(exact + kHeadroom)), limit);
  }
  return level;
}

ChartAtlas::Ball ChartAtlas::ball_around(std::size_t index, int page) const {
  const AtlasChart& chart = charts_[index];
  const Chart& shape = surface_->charts[index];
  const Patch& patch = surface_->patches[static_cast<std::size_t>(shape.patch)];
  const Eigen::Vector2d side = atlas::kPage * chart.raster.density.cwiseInverse(),
                        uv = chart.raster.uv0 + side.cwiseProduct(Eigen::Vector2d(page % chart.pages.x() + 0.5,
                                                                                  page / chart.pages.x() + 0.5));
  const double above = patch.n.dot(shape.center - patch.origin);
  return {static_cast<std::size_t>(patch.node), patch.origin + uv.x() * patch.eu + uv.y() * patch.ev + above * patch.n,
          std::hypot(0.5 * side.norm(), shape.cone > 0 ? shape.radius : 0.0)};
}

void ChartAtlas::drop_page(AtlasPage& page) {
  if (page.height == atlas::kNoSlot) return;
  heights_.give_back(page.height);
  retired_.push_back(page.colour);
  page.height = page.colour = atlas::kNoSlot;
  page.held = 0;
  page.tile_from.fill(-1);
}

/// What `old` pages, laid out as `before`, knew of their brightness, for the pages that now lie there. Without it the
/// gain of an image could not be told when the camera comes closer and many resolutions change at once.
void ChartAtlas::hand_on(const std::vector<AtlasPage>& old, const ChartRaster& before, const Eigen::Vector2i& pages,
                         AtlasChart& chart) {
  if (old.empty()) return;
  for (int y = 0; y < chart.pages.y(); ++y)
    for (int x = 0; x < chart.pages.x(); ++x) {
      const Eigen::Vector2d middle = Eigen::Vector2d(x + 0.5, y + 0.5) * atlas::kPage - Eigen::Vector2d(0.5, 0.5);
      const Eigen::Vector2d uv = chart.raster.uv0 + middle.cwiseQuotient(chart.raster.density);
      const Eigen::Array2d at = ((uv - before.uv0).cwiseProduct(before.density).array() + 0.5) / atlas::kPage;
      const Eigen::Array2i place = at.floor().cast<int>().max(0).min(pages.array() - 1);
      const AtlasPage& from = old[static_cast<std::size_t>(place.y() * pages.x() + place.x())];
      AtlasPage& page = chart.page[static_cast<std::size_t>(y * chart.pages.x() + x)];
      page.last_seen = from.last_seen;
      page.seen_since = from.seen_since;
      page.written = from.written;
      page.exposure = from.exposure;
      // Of another area of the surface: to be renewed with the first image that shows the page.
      page.exposure.rough = true;
    }
}

void ChartAtlas::set_level(int index, const Eigen::Vector2i& level) {
  AtlasChart& chart = charts_[static_cast<std::size_t>(index)];
  if (!chart.before && chart.level.x() != AtlasChart::kNoLevel) {
    AtlasChart::Before before{chart.raster.density, chart.raster.uv0, chart.pages, {}};
    before.resident.reserve(chart.page.size());
    for (const AtlasPage& page : chart.page) before.resident.push_back(page.colour != atlas::kNoSlot);
    chart.before = std::move(before);
  }
  for (AtlasPage& page : chart.page) drop_page(page);
  chart.level = level;
  chart.relevelled = true;
  Eigen::Vector2d density = density_of(level);
  if (options_.texels_per_metre > 0) density = density.cwiseMin(options_.texels_per_metre);  // no step of a level
  const ChartRaster raster_before = std::exchange(chart.raster, raster_chart(*surface_, index, density));
  const Eigen::Vector2i pages_before = chart.pages;
  const std::vector<AtlasPage> page_before = std::move(chart.page);
  chart.pages = {(chart.raster.width + atlas::kPage - 1) / atlas::kPage,
                 (chart.raster.height + atlas::kPage - 1) / atlas::kPage};
  chart.page.assign(static_cast<std::size_t>(chart.pages.prod()), {});
  describe_pages(*surface_, index, chart);
  chart.heights = PackedHeights(std::exchange(chart.raster.raw, {}), chart.raster.width);
  hand_on(page_before, raster_before, pages_before, chart);
}

void ChartAtlas::lay_out() {
  page_count_ = 0;
  for (AtlasChart& chart : charts_) {
    chart.first_page = page_count_;
    page_count_ += chart.pages.prod();
  }
}

void ChartAtlas::collect_records(std::span<const AtlasView> views) {
  records_.clear();
  std::vector<Eigen::Vector3d> eyes;  // u, v, height on the chart's patch
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const AtlasChart& chart = charts_[i];
    if (!chart.in_view && !chart.before) continue;
    const Chart& shape = surface_->charts[i];
    const Patch& patch = surface_->patches[static_cast<std::size_t>(shape.patch)];
    eyes.clear();
    bool may_show_back = false;
    for (const AtlasView& view : views) {
      const Eigen::Vector3d eye = view.T_camera_node[static_cast<std::size_t>(patch.node)].inverse().translation(),
                            s = eye - patch.origin;
      may_show_back = may_show_back || shape.may_show_back(eye);
      eyes.emplace_back(s.dot(patch.eu), s.dot(patch.ev), s.dot(patch.n));
    }
    const ChartRaster& raster = chart.raster;
    const auto seen_from_front = [&](const TilePlane& tile, const Eigen::Vector2d& first_texel) {
      const Eigen::Vector2d uv =
          raster.uv0 + (first_texel.array() + (atlas::kTile - 1) / 2.0).matrix().cwiseQuotient(raster.density);
      return std::any_of(eyes.begin(), eyes.end(), [&](const auto& eye) { return !faces_away(tile, raster, uv, eye); });
    };
    for (int y = 0; y < chart.pages.y(); ++y)
      for (int x = 0; x < chart.pages.x(); ++x) {
        const AtlasPage& page = chart.page[static_cast<std::size_t>(y * chart.pages.x() + x)];
        if (!page.covered) continue;
        PageRecord record{static_cast<std::uint32_t>(i), pack(x, y), page.height, 0, {}};
        bool any = chart.before.has_value();
        for (std::size_t t = 0; t < 4; ++t) {
          TilePlane tile = page.tiles[t];
          const Eigen::Vector2d first(x * atlas::kPage + static_cast<int>(t % 2) * atlas::kTile,
                                      y * atlas::kPage + static_cast<int>(t / 2) * atlas::kTile);
          if (!may_show_back && !seen_from_front(tile, first)) tile.residual = -1;
          any = any || tile.residual >= 0;
          record.tiles[t] = packed(tile, raster);
        }
        if (any) records_.push_back(record);
      }
  }
}

std::span<const PageRecord> ChartAtlas::plan(std::span<const AtlasView> views) {
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const Chart& shape = surface_->charts[i];
    AtlasChart& chart = charts_[i];
    if (shape.radius == 0) continue;
    Eigen::Vector2d density = Eigen::Vector2d::Zero();
    const Patch& patch = surface_->patches[static_cast<std::size_t>(shape.patch)];
    for (const AtlasView& view : views) density = density.cwiseMax(density_in_view(shape, patch, view));
    chart.in_view = density.x() > 0;
    if (!chart.in_view) continue;
    chart.wanted = chart.wanted.cwiseMax(density);
    const Eigen::Vector2i level = wanted_level(static_cast<int>(i));
    if (level != chart.level) set_level(static_cast<int>(i), level);
  }
  lay_out();
  collect_records(views);
  pages_in_view_ = 0;
  return records_;
}

int ChartAtlas::page_index(const PageRecord& r) const {
  return static_cast<int>(r.xy >> 16) * charts_[r.chart].pages.x() + static_cast<int>(r.xy & 0xffff);
}

AtlasPage& ChartAtlas::page_of(const PageRecord& r) {
  return charts_[r.chart].page[static_cast<std::size_t>(page_index(r))];
}

const AtlasPage& ChartAtlas::page_of(const PageRecord& r) const {
  return charts_[r.chart].page[static_cast<std::size_t>(page_index(r))];
}

/// True where the published generation has colours somewhere under the page.
bool ChartAtlas::needs_relevel(const AtlasChart& chart, int page) const {
  if (!chart.before) return false;
  const auto& before = *chart.before;
  const Eigen::Array2d at(page % chart.pages.x(), page / chart.pages.x());
  const Eigen::Array2d ratio = before.density.array() / chart.raster.density.array();
  const Eigen::Array2d lower =
      (chart.raster.uv0 - before.uv0).array() * before.density.array() / atlas::kPage + at * ratio;
  const Eigen::Array2d upper = lower + ratio;
  const Eigen::Array2i from = lower.floor().cast<int>().max(0);
  const Eigen::Array2i to = upper.floor().cast<int>().min(before.pages.array() - 1);
  for (int y = from.y(); y <= to.y(); ++y)
    for (int x = from.x(); x <= to.x(); ++x)
      if (before.resident[static_cast<std::size_t>(y * before.pages.x() + x)]) return true;
  return false;
}

std::size_t ChartAtlas::slots_needed(std::span<const std::uint32_t> masks) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < records_.size(); ++i)
    if (masks[i] || needs_relevel(charts_[records_[i].chart], page_index(records_[i]))) ++count;
  return count;
}

ChartAtlas::Slots ChartAtlas::reach(std::span<const std::uint32_t> masks) const {
  std::size_t heights = 0;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const AtlasChart& chart = charts_[records_[i].chart];
    const int page = page_index(records_[i]);
    const bool placed = chart.page[static_cast<std::size_t>(page)].height != atlas::kNoSlot;
    if (!placed && (masks[i] || needs_relevel(chart, page))) ++heights;
  }
  return {colours_.reach(slots_needed(masks)), heights_.reach(heights)};
}

/// Frees height slots until `needed` are there, by evicting pages that image `image` does not see,
/// those unseen for longest first.
bool ChartAtlas::make_room(std::size_t needed, std::int64_t image) {
  if (heights_.free() >= needed) return true;
  std::vector<std::pair<std::int64_t, AtlasPage*>> old;
  for (AtlasChart& chart : charts_)
    for (AtlasPage& page : chart.page)
      if (page.height != atlas::kNoSlot && page.last_seen < image) old.emplace_back(page.last_seen, &page);
  if (heights_.free() + old.size() < needed) return false;
  std::stable_sort(old.begin(), old.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [seen, page] : old) {
    if (heights_.free() >= needed) break;
    drop_page(*page);
    ++policy_.evicted_pages;
  }
  return true;
}

bool ChartAtlas::lower_resolution() {
  const bool can =
      std::any_of(charts_.begin(), charts_.end(), [](const AtlasChart& c) { return c.in_view && c.pages.prod() > 1; });
  if (!can) return false;
  --policy_.bias;
  ++policy_.steps_down;
  quiet_images_ = 0;
  return true;
}

ChartAtlas::Allocation ChartAtlas::allocate(std::span<const std::uint32_t> masks, std::int64_t image) {
  std::size_t visible = 0, visible_new = 0;
  std::vector<bool> relevel(records_.size());
  for (std::size_t i = 0; i < records_.size(); ++i) {
    relevel[i] = needs_relevel(charts_[records_[i].chart], page_index(records_[i]));
    AtlasPage& page = page_of(records_[i]);
    if (masks[i]) page.last_seen = std::max(page.last_seen, image);
    if (masks[i]) ++visible;
    if (masks[i] && page.height == atlas::kNoSlot) ++visible_new;
  }
  pages_in_view_ = std::max(pages_in_view_, visible);
  Allocation out;
  if (!make_room(visible_new, image) || colours_.free() < visible) {
    if (!lower_resolution())
      throw RuntimeFailure("out of texture memory: the view needs " + std::to_string(visible_new) + " pages, " +
                               std::to_string(heights_.capacity()) + " fit",
                           "give more with --texture-memory-mb");
    out.fits = false;
    return out;
  }
  // Colours of pages out of view are carried over only as far as there is room without eviction.
  std::size_t spare = std::min<std::size_t>(heights_.free() - visible_new,
                                            colours_.free() - std::min<std::size_t>(visible, colours_.free()));
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const PageRecord& r = records_[i];
    AtlasPage& page = page_of(r);
    if (!masks[i]) {
      if (!relevel[i] || page.height != atlas::kNoSlot || spare == 0) continue;
      --spare;
    }
    AtlasChart& chart = charts_[r.chart];
    if (page.height == atlas::kNoSlot) {
      page.height = heights_.take();
      out.new_heights.emplace_back(r.chart, page_index(r));
    }
    const std::uint32_t table_index = static_cast<std::uint32_t>(chart.first_page + page_index(r));
    const std::uint32_t fresh = colours_.take();
    PageJob job{r.chart, r.xy, page.colour, fresh, page.height, table_index, page.covered, worse_for(page)};
    note_written(page, masks[i], image, relevel[i]);
    if (relevel[i]) {
      out.relevel.push_back(job);
      job.old_slot = fresh;  // filled by the re-levelling, not yet published: written in place
    } else if (page.colour != atlas::kNoSlot) {
      out.retired.push_back(page.colour);
    }
    page.colour = fresh;
    out.jobs.push_back(job);
    out.masks.push_back(static_cast<std::uint8_t>(masks[i]));
  }
  out.retired.insert(out.retired.end(), retired_.begin(), retired_.end());
  retired_.clear();
  return out;
}

ChartAtlas::Slots ChartAtlas::reach(std::size_t pages) const {
  return {colours_.reach(pages), heights_.reach(0)};
}

ChartAtlas::Allocation ChartAtlas::renew(std::span<const PagePlace> pages) {
  Allocation out;
  for (const auto& [chart_index, index] : pages) {
    AtlasChart& chart = charts_[chart_index];
    AtlasPage& page = chart.page[static_cast<std::size_t>(index)];
    const auto x = static_cast<std::uint32_t>(index % chart.pages.x()),
               y = static_cast<std::uint32_t>(index / chart.pages.x());
    out.retired.push_back(page.colour);
    out.jobs.push_back({chart_index, x | y << 16, page.colour, colours_.take(), page.height,
                        static_cast<std::uint32_t>(chart.first_page + index), page.covered});
    page.colour = out.jobs.back().new_slot;
  }
  out.masks.resize(pages.size());
  return out;
}

std::span<const PageRecord> ChartAtlas::placed_records() {
  for (PageRecord& record : records_) record.height_slot = page_of(record).height;
  return records_;
}

void ChartAtlas::commit() {
  for (AtlasChart& chart : charts_) {
    chart.before.reset();
    chart.relevelled = false;
  }
  // Pages out of view do not count: they give way.
  quiet_images_ = pages_in_view_ * 2 < heights_.capacity() ? quiet_images_ + 1 : 0;
  if (policy_.bias < 0 && quiet_images_ >= kImagesBeforeRise) {
    ++policy_.bias;
    ++policy_.steps_up;
    quiet_images_ = 0;
  }
}

void ChartAtlas::give_back_colours(std::span<const std::uint32_t> slots) {
  for (std::uint32_t slot : slots) colours_.give_back(slot);
}

}  // namespace foresight
