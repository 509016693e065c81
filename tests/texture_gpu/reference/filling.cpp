#include "tests/texture_gpu/reference/filling.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::reference {
namespace {

using Eigen::Vector4d;

constexpr double kFilled = 1.0 / 31, kSeen = 1.5 / 31;
constexpr double kFirm = 0.25;  // share of seen texels from which a page's mean stands for itself
constexpr int kSpreadRounds = 4, kReach = 3;

Vector4d opaque(const Vector4d& c) {
  return {c.x(), c.y(), c.z(), 1};
}

/// Mean of the seen ones among some texels, and their share.
class Mean {
 public:
  void add(const Vector4d& c, double weight) { sum_ += weight * opaque(c); }
  bool empty() const { return sum_.w() == 0; }
  Vector4d over(double count) const {
    Vector4d out = sum_ / sum_.w();
    out.w() = sum_.w() / count;
    return out;
  }

 private:
  Vector4d sum_ = Vector4d::Zero();
};

/// Where nothing was seen, levels 1 to 3 hold what was filled before: level 1 the mean of its texels, the
/// others that of level 1.
Vector4d kept_fill(const FilledChart& chart, int level, int x, int y, int width) {
  const int from = level == 1 ? 0 : 1, side = 1 << (level - from), row = width >> from;
  Mean mean;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const auto at = static_cast<std::size_t>((y * side + j) * row + x * side + i);
      const Vector4d& c = chart.levels[static_cast<std::size_t>(from)][at];
      if (c.w() > 0) mean.add(c, 1);
    }
  if (mean.empty() || level == 4) return Vector4d::Zero();
  Vector4d out = mean.over(1);
  out.w() = kFilled;
  return out;
}

void push(const FillChart& chart, FilledChart& out) {
  const int width = 16 * chart.pages.x(), height = 16 * chart.pages.y();
  for (const Texel& t : chart.texels) out.levels[0].push_back(to_vector(t));
  for (int level = 1; level < atlas::kLevels; ++level) {
    const int side = 1 << level;
    for (int y = 0; y < height / side; ++y)
      for (int x = 0; x < width / side; ++x) {
        Mean mean;
        for (int j = 0; j < side; ++j)
          for (int i = 0; i < side; ++i) {
            const Vector4d& c = out.levels[0][static_cast<std::size_t>((y * side + j) * width + x * side + i)];
            if (c.w() > kSeen) mean.add(c, 1);
          }
        Vector4d c = mean.empty() ? kept_fill(out, level, x, y, width) : mean.over(side * side);
        if (!mean.empty() && level > 1) c.w() = std::max(c.w(), 2.0 / 31);
        out.levels[static_cast<std::size_t>(level)].push_back(c);
      }
  }
}

void find_means(const FillChart& chart, FilledChart& out) {
  const int count = chart.pages.prod();
  Mean mean;
  for (int i = 0; i < count; ++i) {
    const Vector4d& c = out.levels[4][static_cast<std::size_t>(i)];
    out.coarse.push_back(c.w() > 0 ? opaque(c) : Vector4d::Zero().eval());
    if (c.w() > 0) mean.add(c, c.w());
  }
  if (!mean.empty()) out.mean = mean.over(1), out.mean.w() = 1;
  const auto pages = out.levels[4];
  for (int i = 0; i < count; ++i) {
    if (pages[static_cast<std::size_t>(i)].w() >= kFirm) continue;
    Mean around;
    if (out.mean.w() > 0) around.add(out.mean, 1e-4);
    for (int y = 0; y < chart.pages.y(); ++y)
      for (int x = 0; x < chart.pages.x(); ++x) {
        const int dx = x - i % chart.pages.x(), dy = y - i / chart.pages.x();
        const Vector4d& c = pages[static_cast<std::size_t>(y * chart.pages.x() + x)];
        const double d2 = dx * dx + dy * dy;
        if (std::max(std::abs(dx), std::abs(dy)) <= kReach && c.w() > 0) around.add(c, c.w() / (d2 * d2 + 1));
      }
    if (!around.empty()) out.coarse[static_cast<std::size_t>(i)] = opaque(around.over(1));
  }
}

void spread(const std::vector<FillChart>& charts, std::vector<FilledChart>& out) {
  for (int round = 0; round < kSpreadRounds; ++round) {
    std::vector<Vector4d> before;
    for (const FilledChart& chart : out) before.push_back(chart.mean);
    for (std::size_t i = 0; i < charts.size(); ++i) {
      if (before[i].w() == 1) continue;
      Mean mean;
      for (int n : charts[i].neighbours)
        if (const Vector4d& c = before[static_cast<std::size_t>(n)]; c.w() > 0) mean.add(c, c.w() == 1 ? 4 : 1);
      if (!mean.empty()) out[i].mean = mean.over(1), out[i].mean.w() = 0.5;
    }
  }
}

void pull(const FillChart& chart, FilledChart& out) {
  for (int level = 3; level >= 0; --level) {
    const int side = 16 >> level, width = side * chart.pages.x(), height = side * chart.pages.y();
    const auto parent = [&](int x, int y) -> Vector4d {
      if (x < 0 || y < 0 || x >= width / 2 || y >= height / 2) return Vector4d::Zero();
      const int page = y / (side / 2) * chart.pages.x() + x / (side / 2);
      const Vector4d& above =
          out.levels[static_cast<std::size_t>(level + 1)][static_cast<std::size_t>(y * (width / 2) + x)];
      return level < 3 && above.w() > 0 ? above : out.coarse[static_cast<std::size_t>(page)];
    };
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto page = static_cast<std::size_t>(y / side * chart.pages.x() + x / side);
        Vector4d& own = out.levels[static_cast<std::size_t>(level)][static_cast<std::size_t>(y * width + x)];
        const bool has_colour = out.levels[4][page].w() > 0;  // else the display takes the coarse colours
        const auto& holes = chart.holes[page];
        const auto tile = static_cast<std::size_t>(y % side / 8 * 2 + x % side / 8);  // at level 0
        const bool has_hole = level == 0 ? holes[tile] : std::find(holes.begin(), holes.end(), true) != holes.end();
        if (!chart.resident[page] || !chart.changed[page] || !has_hole || !has_colour) continue;
        if (own.w() >= (level == 0 ? kSeen : 0.5)) continue;
        const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
        const int x0 = static_cast<int>(std::floor(u)), y0 = static_cast<int>(std::floor(v));
        Mean mean;
        for (int i = 0; i < 4; ++i) {
          const Vector4d c = parent(x0 + (i & 1), y0 + (i >> 1));
          if (c.w() > 0) mean.add(c, (i & 1 ? u - x0 : 1 - (u - x0)) * (i >> 1 ? v - y0 : 1 - (v - y0)));
        }
        if (mean.empty()) continue;
        const Vector4d above = mean.over(1);
        // What is seen in part keeps its part of the colour: all of it from a half on.
        const double share = level == 0 || own.w() < kSeen ? 0 : 2 * own.w(),
                     alpha = level == 0 ? kFilled : std::max(own.w(), kFilled);
        own = (1 - share) * above + share * own;
        own.w() = alpha;
      }
  }
}

}  // namespace

std::vector<FilledChart> fill(const std::vector<FillChart>& charts) {
  std::vector<FilledChart> out(charts.size());
  for (std::size_t i = 0; i < charts.size(); ++i) {
    push(charts[i], out[i]);
    find_means(charts[i], out[i]);
  }
  spread(charts, out);
  for (std::size_t i = 0; i < charts.size(); ++i) pull(charts[i], out[i]);
  return out;
}

}  // namespace foresight::reference
