// What images saw of the pages, and which of them the pages have their colours from.
#include <algorithm>
#include <bit>
#include <cmath>

#include "texture_gpu/chart_atlas.hpp"

namespace foresight {
namespace {

/// A bit for each tile of which a mask has any.
std::uint32_t tiles_of(std::uint32_t mask) {
  std::uint32_t tiles = 0;
  for (unsigned tile = 0; tile < 4; ++tile)
    if (mask >> (2 * tile) & 3u) tiles |= 1u << tile;
  return tiles;
}

constexpr std::uint64_t kImagesToTryAgain = 4;

std::uint32_t written_tiles(const AtlasPage& page) {
  std::uint32_t tiles = 0;
  for (unsigned tile = 0; tile < 4; ++tile)
    if (page.tile_from[tile] >= 0) tiles |= 1u << tile;
  return tiles;
}

/// The mask of these tiles, for all cameras.
std::uint32_t of_tiles(std::uint32_t tiles) {
  std::uint32_t mask = 0;
  for (unsigned tile = 0; tile < 4; ++tile)
    if (tiles >> tile & 1u) mask |= 3u << (2 * tile);
  return mask;
}

}  // namespace

void ChartAtlas::note_seen(std::span<const std::uint32_t> masks, std::int64_t image) {
  pages_in_view_ = 0;
  int tiles = 0;  // of the record's chart
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (i == 0 || records_[i].chart != records_[i - 1].chart) tiles = 0;
    if (!masks[i]) continue;
    tiles += std::popcount(tiles_of(masks[i]));
    AtlasChart& chart = charts_[records_[i].chart];
    if (tiles > chart.most_seen) chart.most_seen = tiles, chart.more_seen_in = image;
    ++pages_in_view_;
    AtlasPage& page = page_of(records_[i]);
    if (page.last_seen < image - 1)
      page.seen_since = image;
    else if (page.seen_since < 0)
      page.seen_since = std::max(page.last_seen, std::int64_t{0});
    page.last_seen = image;
  }
}

std::vector<std::uint32_t> ChartAtlas::not_held(std::span<const std::uint32_t> masks, std::int64_t image) const {
  std::vector<std::uint32_t> out(masks.begin(), masks.end());
  bool has_colours = false;  // of the record's chart
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const AtlasChart& chart = charts_[records_[i].chart];
    if (i == 0 || records_[i].chart != records_[i - 1].chart)
      has_colours = std::ranges::any_of(chart.page, [](const AtlasPage& page) { return page.held != 0; });
    const AtlasPage& page = page_of(records_[i]);
    const bool tries = records_[i].has_turn(image, kImagesToTryAgain) || chart.more_seen_in == image;
    const bool waits = has_colours || !tries;
    const bool carried_over = needs_relevel(chart, page_index(records_[i]));
    out[i] &= ~of_tiles(carried_over ? 0xfu : page.held | (waits ? written_tiles(page) : 0u));
  }
  return out;
}

std::vector<std::uint32_t> ChartAtlas::stale(std::span<const std::uint32_t> masks, std::int64_t image,
                                             std::int64_t since) const {
  const std::int64_t oldest = std::max(image - options_.images_to_rewrite + 1, since);
  std::vector<std::uint32_t> out(masks.begin(), masks.end());
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const AtlasPage& page = page_of(records_[i]);
    const std::uint32_t settled = page.settled & page.held;
    for (unsigned tile = 0; tile < 4; ++tile) {
      const std::int64_t good_from = settled >> tile & 1u ? oldest : image;
      if (page.tile_from[tile] >= good_from) out[i] &= ~of_tiles(1u << tile);
    }
  }
  return out;
}

void ChartAtlas::note_hidden(std::span<const std::uint32_t> masks, std::int64_t image) {
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (!masks[i]) continue;
    AtlasPage& page = page_of(records_[i]);
    page.hidden = static_cast<std::uint8_t>(tiles_of(masks[i]));
    page.hidden_in = image;
  }
}

std::vector<std::uint32_t> ChartAtlas::not_hidden(std::span<const std::uint32_t> masks, std::int64_t image) const {
  std::vector<std::uint32_t> out(masks.begin(), masks.end());
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const AtlasPage& page = page_of(records_[i]);
    if (page.hidden_in == image) out[i] &= ~of_tiles(page.hidden);
  }
  return out;
}

void ChartAtlas::note_holes(const Allocation& done, std::span<const std::uint32_t> holes) {
  for (std::size_t i = 0; i < done.jobs.size(); ++i) {
    AtlasChart& chart = charts_[done.jobs[i].chart];
    AtlasPage& page = chart.page[done.jobs[i].table_index - static_cast<std::uint32_t>(chart.first_page)];
    const std::uint32_t tiles = tiles_of(done.masks[i]);
    std::uint32_t with_news = 0;
    for (unsigned tile = 0; tile < 4; ++tile)
      if (holes[4 * i + tile] & 4u) with_news |= 1u << tile;
    page.settled = static_cast<std::uint8_t>((page.settled & ~tiles) | (tiles & ~with_news));
    page.held = static_cast<std::uint8_t>(page.held | (tiles & with_news));
  }
}

void ChartAtlas::note_coarser(std::size_t record, std::int64_t image) {
  page_of(records_[record]).seen_since = image;
}

/// Where every image is extracted, the old colour's claim ages with each that would have replaced it (extract.comp).
/// Here those are counted that saw the page and were not extracted; and what the same run of images saw, each of them
/// would have replaced.
float ChartAtlas::worse_for(const AtlasPage& page) const {
  if (page.seen_since < 0) return static_cast<float>(options_.worse);
  if (page.written >= page.seen_since) return 0;
  return static_cast<float>(options_.worse * std::exp2(static_cast<double>(page.seen_since - page.last_seen) / 32));
}

void ChartAtlas::note_written(AtlasPage& page, std::uint32_t mask, std::int64_t image, bool carried_over) {
  const std::uint32_t tiles = tiles_of(mask);
  if (carried_over) page.held = 0xf;
  if (!mask) return;
  page.written = image;
  for (unsigned tile = 0; tile < 4; ++tile)
    if (tiles >> tile & 1u) page.tile_from[tile] = image;
}

}  // namespace foresight
