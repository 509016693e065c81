#include "tests/texture_gpu/reference/atlas_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace foresight::reference {
namespace {

std::vector<std::uint32_t> read_words(const gl::BufferTexture& buffer, std::size_t count) {
  std::vector<std::uint32_t> words(count);
  buffer.buffer().read(std::span<std::uint32_t>(words));
  return words;
}

/// Halves to values 0 .. 1.
std::vector<Eigen::Vector4d> read_means(const gl::BufferTexture& buffer, std::size_t count) {
  cv::Mat halves(1, static_cast<int>(count), CV_16FC4), values;
  buffer.buffer().read(std::span(halves.ptr<std::uint64_t>(), count));
  halves.convertTo(values, CV_32F);
  std::vector<Eigen::Vector4d> out;
  for (const cv::Vec4f& v : cv::Mat_<cv::Vec4f>(values)) out.emplace_back(v[0], v[1], v[2], v[3]);
  return out;
}

Texel unpacked(std::uint32_t bits) {
  Texel out;
  for (unsigned c = 0; c < 3; ++c) {
    const double value = std::ldexp(bits >> (8 * c) & 0xff, static_cast<int>(bits >> 24 & 7) - 11);
    out[c] = static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.0)));
  }
  out[3] = static_cast<std::uint8_t>(bits >> 27);
  return out;
}

}  // namespace

AtlasPixels::AtlasPixels(const gl::Texture& colours) {
  for (int level = 0; level < atlas::kLevels; ++level) {
    auto& pixels = levels[static_cast<std::size_t>(level)];
    pixels.resize(
        static_cast<std::size_t>((colours.width() >> level) * (colours.height() >> level) * colours.layers()));
    std::vector<std::uint32_t> bits(pixels.size());
    glGetTextureImage(colours.name(), level, GL_RGBA, GL_UNSIGNED_INT_8_8_8_8_REV,
                      static_cast<GLsizei>(bits.size() * 4), bits.data());
    std::ranges::transform(bits, pixels.begin(), unpacked);
  }
}

std::size_t AtlasPixels::place(std::uint32_t slot, int level, int x, int y) {
  // A single layer may be lower than others: the height counts only where there are several.
  const std::size_t width = atlas::kLayerWidth >> level, height = atlas::kLayerHeight >> level;
  const std::size_t page = atlas::kPage >> level;
  const std::size_t column = slot % 8, row = slot / 8 % 512, layer = slot / 4096;
  return (layer * height + row * page + static_cast<std::size_t>(y)) * width + column * page +
         static_cast<std::size_t>(x);
}

Generation::Generation(const PublishedTextures& published, std::size_t count)
    : display_gain(published.display_gain), sharp(published.sharp) {
  std::vector<Eigen::Vector4f> rows(5 * count);
  published.charts.buffer().read(std::span<Eigen::Vector4f>(rows));
  int pages = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = [&](std::size_t r) -> Eigen::Vector4d { return rows[5 * i + r].cast<double>(); };
    ChartCopy chart;
    chart.origin = row(0).head<3>();
    chart.eu = row(1).head<3>();
    chart.ev = row(2).head<3>();
    chart.eh = row(3).head<3>();
    chart.node = static_cast<int>(row(3).w());
    chart.pages = {static_cast<int>(row(0).w()), static_cast<int>(row(4).z())};
    chart.first_page = static_cast<int>(row(2).w());
    chart.uv0 = row(4).head<2>();
    chart.density = {row(1).w(), row(4).w()};
    pages = chart.first_page + chart.pages.prod();
    charts.push_back(chart);
  }
  table = read_words(published.table, static_cast<std::size_t>(pages));
  coarse = read_means(published.coarse, static_cast<std::size_t>(pages));
  means = read_means(published.means, count);
}

Eigen::Vector4d to_vector(const Texel& t) {
  return {t[0] / 255., t[1] / 255., t[2] / 255., t[3] / 31.};
}

}  // namespace foresight::reference
