#include "texture_gpu/chart_atlas.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kLevelsPerOctave = 4;
constexpr double kNearest = 0.05;      // metres; views from nearer do not ask for more texels
constexpr int kLargestChart = 4096;    // texels along a side
constexpr int kImagesBeforeRise = 10;  // images with half of the memory free before resolutions rise

double density_of(int level) { return std::exp2(level / kLevelsPerOctave); }

/// Texels per metre that give one texel per pixel on the chart, seen from the view; 0: out of view.
double density_in_view(const Chart& chart, int node, const AtlasView& view) {
  const Eigen::Vector3d p = view.T_camera_node[static_cast<std::size_t>(node)] * chart.center;
  const double distance = p.norm(), r = chart.radius;
  const auto& lens = view.lens->parameters();
  const double focal = std::max(lens.fx, lens.fy);
  if (view.faces->count > 1) {
    const double angle = std::atan2(p.head<2>().norm(), p.z());
    if (distance > r && angle - std::asin(r / distance) > view.lens->max_angle()) return 0;
    return focal / std::max({distance - 0.5 * r, 0.25 * r, kNearest});
  }
  if (p.z() + r <= gl::kNearPlane) return 0;
  const auto& f = *view.faces;
  // Signed distances from the four planes through the camera and the borders of the face.
  const auto outside = [&](double x, double z, double focal_px, double border) {
    return (focal_px * x + border * z) / std::hypot(focal_px, border) < -r;
  };
  if (outside(p.x(), p.z(), f.fx, f.cx + 0.5) || outside(-p.x(), p.z(), f.fx, f.width - 0.5 - f.cx) ||
      outside(p.y(), p.z(), f.fy, f.cy + 0.5) || outside(-p.y(), p.z(), f.fy, f.height - 0.5 - f.cy))
    return 0;
  return focal / std::max({p.z() - 0.5 * r, 0.25 * r, kNearest});
}

std::uint32_t pack(int low, int high) { return static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 16; }

void find_page_ranges(AtlasChart& chart) {
  const ChartRaster& r = chart.raster;
  for (int y = 0; y < r.height; ++y) {
    for (int x = 0; x < r.width; ++x) {
      const std::uint16_t raw = r.raw[static_cast<std::size_t>(y) * static_cast<std::size_t>(r.width) + static_cast<std::size_t>(x)];
      if (!raw) continue;
      AtlasPage& page = chart.page[static_cast<std::size_t>((y / atlas::kPage) * chart.pages.x() + x / atlas::kPage)];
      page.low = page.covered ? std::min(page.low, raw) : raw;
      page.high = std::max(page.high, raw);
      ++page.covered;
    }
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
  // Whole layers are reserved; two colour layers for one of heights keep the ratio.
  const std::uint64_t a_page = 2 * atlas::kColourBytes + atlas::kHeightBytes;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(memory_bytes / a_page, 1u << 20));
}

std::uint64_t ChartAtlas::bytes_in_use() const {
  return colours_.used() * atlas::kColourBytes + heights_.used() * atlas::kHeightBytes;
}

int ChartAtlas::wanted_level(int index) const {
  const AtlasChart& chart = charts_[static_cast<std::size_t>(index)];
  const Chart& shape = surface_->charts[static_cast<std::size_t>(index)];
  double density = options_.texels_per_metre > 0 ? options_.texels_per_metre : chart.wanted;
  const double side = (shape.upper - shape.lower).maxCoeff();
  const int most = options_.max_texture > 0 ? std::min(options_.max_texture, kLargestChart) : kLargestChart;
  const int limit = static_cast<int>(std::floor(kLevelsPerOctave * std::log2(most / std::max(side, 1e-9))));
  const int level = static_cast<int>(std::ceil(kLevelsPerOctave * std::log2(density) - 1e-9)) + policy_.bias;
  return std::min(level, limit);
}

void ChartAtlas::drop_page(AtlasPage& page) {
  if (page.height == atlas::kNoSlot) return;
  heights_.give_back(page.height);
  retired_.push_back(page.colour);
  page.height = page.colour = atlas::kNoSlot;
}

void ChartAtlas::set_level(int index, int level) {
  AtlasChart& chart = charts_[static_cast<std::size_t>(index)];
  if (!chart.before && chart.level != AtlasChart::kNoLevel) {
    AtlasChart::Before before{chart.raster.density, chart.raster.uv0, chart.pages, {}};
    before.resident.reserve(chart.page.size());
    for (const AtlasPage& page : chart.page) before.resident.push_back(page.colour != atlas::kNoSlot);
    chart.before = std::move(before);
  }
  for (AtlasPage& page : chart.page) drop_page(page);
  chart.level = level;
  const bool fixed = options_.texels_per_metre > 0 && policy_.bias == 0 && options_.max_texture == 0;
  chart.raster = raster_chart(*surface_, index, fixed ? options_.texels_per_metre : density_of(level));
  chart.pages = {(chart.raster.width + atlas::kPage - 1) / atlas::kPage,
                 (chart.raster.height + atlas::kPage - 1) / atlas::kPage};
  chart.page.assign(static_cast<std::size_t>(chart.pages.prod()), {});
  find_page_ranges(chart);
  layout_changed_ = true;
}

void ChartAtlas::lay_out() {
  page_count_ = 0;
  for (AtlasChart& chart : charts_) {
    chart.first_page = page_count_;
    page_count_ += chart.pages.prod();
  }
}

void ChartAtlas::collect_records() {
  records_.clear();
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const AtlasChart& chart = charts_[i];
    if (!chart.in_view && !chart.before) continue;
    for (int y = 0; y < chart.pages.y(); ++y)
      for (int x = 0; x < chart.pages.x(); ++x) {
        const AtlasPage& page = chart.page[static_cast<std::size_t>(y * chart.pages.x() + x)];
        if (page.covered)
          records_.push_back({static_cast<std::uint32_t>(i), pack(x, y), pack(page.low, page.high), page.height});
      }
  }
}

std::span<const PageRecord> ChartAtlas::plan(std::span<const AtlasView> views, std::int64_t) {
  layout_changed_ = false;
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const Chart& shape = surface_->charts[i];
    AtlasChart& chart = charts_[i];
    if (shape.radius == 0) continue;
    double density = 0;
    const int node = surface_->patches[static_cast<std::size_t>(shape.patch)].node;
    for (const AtlasView& view : views) density = std::max(density, density_in_view(shape, node, view));
    chart.in_view = density > 0;
    if (!chart.in_view) continue;
    chart.wanted = std::max(chart.wanted, density);
    const int level = wanted_level(static_cast<int>(i));
    if (level != chart.level) set_level(static_cast<int>(i), level);
  }
  lay_out();
  collect_records();
  return records_;
}

int ChartAtlas::page_index(const PageRecord& r) const {
  return static_cast<int>(r.xy >> 16) * charts_[r.chart].pages.x() + static_cast<int>(r.xy & 0xffff);
}

AtlasPage& ChartAtlas::page_of(const PageRecord& r) {
  return charts_[r.chart].page[static_cast<std::size_t>(page_index(r))];
}

/// True where the published generation has colours somewhere under the page.
bool ChartAtlas::needs_relevel(const AtlasChart& chart, int page) const {
  if (!chart.before) return false;
  const auto& before = *chart.before;
  const Eigen::Array2d at(page % chart.pages.x(), page / chart.pages.x());
  const Eigen::Array2d lower = (chart.raster.uv0.array() + atlas::kPage * at / chart.raster.density -
                                before.uv0.array()) * before.density / atlas::kPage;
  const Eigen::Array2d upper = lower + before.density / chart.raster.density;
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
  const bool can = std::any_of(charts_.begin(), charts_.end(),
                               [](const AtlasChart& c) { return c.in_view && c.pages.prod() > 1; });
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
    if (masks[i]) page.last_seen = image;
    if (masks[i]) ++visible;
    if (masks[i] && page.height == atlas::kNoSlot) ++visible_new;
  }
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
    PageJob job{r.chart, r.xy, page.colour, fresh, page.height, table_index, page.covered};
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

void ChartAtlas::commit() {
  for (AtlasChart& chart : charts_) chart.before.reset();
  quiet_images_ = heights_.used() * 2 < heights_.capacity() ? quiet_images_ + 1 : 0;
  if (policy_.bias < 0 && quiet_images_ >= kImagesBeforeRise) {
    ++policy_.bias;
    ++policy_.steps_up;
    quiet_images_ = 0;
  }
}

void ChartAtlas::give_back_colours(std::span<const std::uint32_t> slots) {
  for (std::uint32_t slot : slots) colours_.give_back(slot);
}

void ChartAtlas::write_table(std::vector<std::uint32_t>& out) const {
  out.clear();
  out.reserve(static_cast<std::size_t>(page_count_));
  for (const AtlasChart& chart : charts_)
    for (const AtlasPage& page : chart.page) out.push_back(page.colour);
}

void ChartAtlas::write_charts(std::vector<Eigen::Vector4f>& out) const {
  out.clear();
  out.reserve(5 * charts_.size());
  const auto pack4 = [&](const Eigen::Vector3d& v, double w) {
    out.push_back(Eigen::Vector4d(v.x(), v.y(), v.z(), w).cast<float>());
  };
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const AtlasChart& chart = charts_[i];
    const Patch& patch = surface_->patches[static_cast<std::size_t>(surface_->charts[i].patch)];
    const ChartRaster& r = chart.raster;
    const double pitch = r.density > 0 ? 1 / r.density : 0;
    pack4(patch.origin + r.uv0.x() * patch.eu + r.uv0.y() * patch.ev + r.height0 * patch.n, chart.pages.x());
    pack4(patch.eu * pitch, r.density);
    pack4(patch.ev * pitch, chart.first_page);
    pack4(patch.n * r.height_step, patch.node);
    pack4({r.uv0.x(), r.uv0.y(), static_cast<double>(chart.pages.y())}, 0);
  }
}

}  // namespace foresight
