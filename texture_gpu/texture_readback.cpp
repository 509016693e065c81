#include "texture_gpu/texture_readback.hpp"

#include <algorithm>
#include <cmath>

#include "gl/context.hpp"
#include "pictures/view_alpha.hpp"
#include "texture_gpu/atlas_layout.hpp"
#include "texture_gpu/texel.hpp"

namespace foresight {
namespace {

constexpr int kFirstSeenCode = 2;

Eigen::Vector2i page_grid(const Eigen::Vector2i& texels) {
  return (texels.array() + atlas::kPage - 1) / atlas::kPage;
}

/// BGR of a colour, eight bits, as a display shows it; `tone`: factors on red, green and blue.
cv::Vec4b shown(const Eigen::Array3f& colour, const Eigen::Array3f& tone, std::uint8_t alpha) {
  const Eigen::Array3f c = 255 * tone * colour;
  const auto bits = [&](int channel) { return cv::saturate_cast<std::uint8_t>(c[channel]); };
  return {bits(2), bits(1), bits(0), alpha};
}

/// BGRA; all 0 where it has no colour.
cv::Vec4b shown(atlas::Texel texel, const Eigen::Array3f& tone) {
  if (texel.code() == 0) return {0, 0, 0, 0};
  return shown(texel.colour(), tone, texel.code() >= kFirstSeenCode ? view_alpha::kFromImage : view_alpha::kFromFill);
}

/// Means of pages or charts.
std::vector<cv::Vec4b> read_means(const gl::BufferTexture& buffer, std::size_t count, const Eigen::Array3f& tone) {
  cv::Mat halves(1, static_cast<int>(count), CV_16FC4), values;
  if (count == 0) return {};
  buffer.buffer().read(std::span(halves.ptr<std::uint64_t>(), count));
  halves.convertTo(values, CV_32F);
  std::vector<cv::Vec4b> out;
  for (const cv::Vec4f& c : cv::Mat_<cv::Vec4f>(values))
    out.push_back(c[3] == 0 ? cv::Vec4b(0, 0, 0, view_alpha::kBare)
                            : shown(Eigen::Array3f(c[0], c[1], c[2]), tone, view_alpha::kFromFill));
  return out;
}

/// Takes away the triangles of texels that a neighbouring chart counts as its own.
void keep_own_cell(ChartTexels& texels) {
  const Patch& patch = texels.patch;
  const Eigen::Array2d cell_size = patch.cell_size();
  const int own = texels.chart - patch.first_chart;
  for (int y = 0; y < texels.height(); ++y)
    for (int x = 0; x < texels.width(); ++x) {
      // The rule by which view.glsl finds the chart of a surface point.
      const Eigen::Array2i cell =
          (texels.uv(x, y).array() / cell_size).floor().cast<int>().max(0).min(patch.cells.array() - 1);
      if (cell.y() * patch.cells.x() + cell.x() != own) texels.triangle[texels.index(x, y)] = -1;
    }
}

}  // namespace

std::optional<Eigen::Vector3d> ChartTexels::point(int x, int y) const {
  const std::uint16_t raw = raster.raw[index(x, y)];
  if (raw == 0) return std::nullopt;
  const Eigen::Vector2d at = uv(x, y);
  const double h = raster.height0 + raster.height_step * ((raw & ~ChartRaster::kCore & 0xffff) - 1);
  return patch.origin + at.x() * patch.eu + at.y() * patch.ev + h * patch.n;
}

TextureReadback::TextureReadback(const PublishedTextures& textures, std::shared_ptr<const SurfacePatches> surface)
    : surface_(std::move(surface)), places_(textures.places) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].density.x() <= 0) continue;
    const int pages = page_grid(chart_size(surface_->charts[i], places_[i].density)).prod();
    count = std::max(count, static_cast<std::size_t>(places_[i].first_page + pages));
  }
  std::vector<std::uint32_t> table(count);
  if (count) textures.table.buffer().read(std::span(table));
  const Eigen::Array3f tone = textures.display_gain * textures.white_balance;
  const auto coarse = read_means(textures.coarse, count, tone);
  means_ = read_means(textures.means, places_.size(), tone);
  for (std::size_t i = 0; i < count; ++i) pages_.push_back({table[i], coarse[i]});

  const gl::Texture& colours = *textures.colours;
  layers_.resize(static_cast<std::size_t>(colours.layers()));
  for (const Page& page : pages_) {
    if (page.slot == atlas::kNoSlot) continue;
    const auto layer = static_cast<int>(page.slot / atlas::kSlotsPerLayer);
    cv::Mat_<cv::Vec4b>& pixels = layers_[static_cast<std::size_t>(layer)];
    if (!pixels.empty()) continue;
    std::vector<atlas::Texel> texels(static_cast<std::size_t>(colours.width() * colours.height()));
    glGetTextureSubImage(colours.name(), 0, 0, 0, layer, colours.width(), colours.height(), 1, GL_RGBA,
                         GL_UNSIGNED_INT_8_8_8_8_REV, static_cast<GLsizei>(texels.size() * sizeof(atlas::Texel)),
                         texels.data());
    pixels.create(colours.height(), colours.width());
    std::ranges::transform(texels, pixels.begin(), [&](atlas::Texel texel) { return shown(texel, tone); });
  }
  gl::check_errors("reading textures back");
}

Eigen::Vector2d TextureReadback::resolution(int index) const {
  const auto i = static_cast<std::size_t>(index);
  if (places_[i].density.x() <= 0) return {0, 0};
  const auto first = pages_.begin() + places_[i].first_page;
  const bool any = std::any_of(first, first + page_grid(chart_size(surface_->charts[i], places_[i].density)).prod(),
                               [](const Page& page) { return page.slot != atlas::kNoSlot; });
  return any ? places_[i].density : Eigen::Vector2d(0, 0);
}

cv::Vec4b TextureReadback::mean(int index) const {
  return means_[static_cast<std::size_t>(index)];
}

std::optional<ChartTexels> TextureReadback::chart(int index) const {
  const ChartPlace& place = places_[static_cast<std::size_t>(index)];
  if (place.density.x() <= 0) return std::nullopt;
  ChartTexels out;
  out.chart = index;
  out.patch = surface_->patches[static_cast<std::size_t>(surface_->charts[static_cast<std::size_t>(index)].patch)];
  out.raster = raster_chart(*surface_, index, place.density);
  out.triangle = triangles_under(*surface_, index, out.raster);
  keep_own_cell(out);

  const Eigen::Vector2i size = page_grid({out.width(), out.height()});
  const Page* pages = pages_.data() + place.first_page;
  out.colours.create(out.height(), out.width(), CV_8UC4);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      cv::Vec4b& colour = out.colours.at<cv::Vec4b>(y, x) = {0, 0, 0, 0};
      if (out.raster.raw[out.index(x, y)] == 0) continue;
      const std::uint32_t slot = pages[y / atlas::kPage * size.x() + x / atlas::kPage].slot;
      if (slot != atlas::kNoSlot) colour = stored(slot, x % atlas::kPage, y % atlas::kPage);
      if (colour[3] == 0) colour = stand_in(index, pages, size, x, y);
    }
  return out;
}

/// A texel of the atlas.
cv::Vec4b TextureReadback::stored(std::uint32_t slot, int x, int y) const {
  const auto column = static_cast<int>(slot % atlas::kSlotsPerRow);
  const auto row = static_cast<int>(slot / atlas::kSlotsPerRow % atlas::kRowsPerLayer);
  return layers_[slot / atlas::kSlotsPerLayer](row * atlas::kPage + y, column * atlas::kPage + x);
}

/// coarse_colour() of lookup.glsl: what a view shows where a chart has no texel of its own.
cv::Vec4b TextureReadback::stand_in(int chart, const Page* pages, const Eigen::Vector2i& size, int x, int y) const {
  const Eigen::Vector2d at = (Eigen::Vector2d(x, y).array() + 0.5) / atlas::kPage - 0.5;
  const Eigen::Vector2d base = at.array().floor(), part = at - base;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Array2i page =
        (base.cast<int>() + Eigen::Vector2i(i & 1, i >> 1)).array().max(0).min(size.array() - 1);
    const cv::Vec4b& c = pages[page.y() * size.x() + page.x()].coarse;
    if (c[3] != view_alpha::kFromFill) continue;
    const double w = (i & 1 ? part.x() : 1 - part.x()) * (i >> 1 ? part.y() : 1 - part.y());
    sum += w * Eigen::Vector3d(c[0], c[1], c[2]);
    weight += w;
  }
  if (weight <= 0) return mean(chart);
  const auto byte = [&](int i) { return static_cast<std::uint8_t>(std::lround(sum[i] / weight)); };
  return {byte(0), byte(1), byte(2), view_alpha::kFromFill};
}

}  // namespace foresight
