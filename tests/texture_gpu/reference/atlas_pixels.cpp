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

Eigen::Vector4d texel_of(const Generation& generation, const AtlasPixels& pixels, const ChartCopy& chart, int level,
                         const Eigen::Vector2i& at) {
  const int side = atlas::kPage >> level;
  if (at.minCoeff() < 0 || at.x() >= side * chart.pages.x() || at.y() >= side * chart.pages.y())
    return Eigen::Vector4d::Zero();
  const int page = chart.first_page + at.y() / side * chart.pages.x() + at.x() / side;
  const std::uint32_t slot = generation.table[static_cast<std::size_t>(page)];
  if (slot == atlas::kNoSlot) return Eigen::Vector4d::Zero();
  return to_vector(pixels.at(slot, level, at.x() % side, at.y() % side));
}

std::optional<Eigen::Vector3d> cubic(const Eigen::Vector2d& at, int level,
                                     const std::function<Eigen::Vector4d(const Eigen::Vector2i&)>& fetch) {
  const auto kernel = [](double d) {
    d = std::abs(d);
    return d < 1 ? 1 + d * d * (-2.5 + 1.5 * d) : d < 2 ? 2 + d * (-4 + d * (2.5 - 0.5 * d)) : 0;
  };
  Eigen::Vector3d sum(0, 0, 0);
  double weights = 0;
  const Eigen::Vector2i base = at.array().floor().cast<int>();
  const Eigen::Vector2i nearest = (at.array() + 0.5).floor().cast<int>();
  for (int y = -1; y <= 2; ++y)
    for (int x = -1; x <= 2; ++x) {
      const bool outer_x = x < 0 || x > 1, outer_y = y < 0 || y > 1;
      if (outer_x && outer_y) continue;
      const Eigen::Vector2i t = base + Eigen::Vector2i(x, y);
      const Eigen::Vector4d c = fetch(Eigen::Vector2i(outer_y ? nearest.x() : t.x(), outer_x ? nearest.y() : t.y()));
      if (c.w() < (level == 0 ? 1.5 / 31 : 0.999)) return std::nullopt;
      const double w = kernel(at.x() - t.x()) * kernel(at.y() - t.y());
      sum += w * c.head<3>();
      weights += w;
    }
  return (sum / weights).eval();
}

}  // namespace foresight::reference
