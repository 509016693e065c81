#include "motion/near_links.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace foresight {
namespace {

constexpr int kFewNodes = 16;       // along an axis, to see how far apart they usually are
constexpr int kMostNodes = 400;     // along an axis
constexpr double kStep = 1;         // of what is kept
constexpr double kUsuallyMore = 3;  // than what is kept
constexpr double kNested = 4e-3;    // m
constexpr float kInside = -1e9F;    // until it is known how deep

}  // namespace

struct NearLinks::Maker {
  NearLinks& table;
  PosedLinks posed;
  std::size_t link, other;
  const TriangleTree &body, &other_body;
  std::vector<double> positions;
  std::array<int, 2> last{-1, -1};  // the nearest triangles, mostly near now too: what is farther need not be looked at

  /// At most `most`.
  double distance(int i, int k, double most) {
    const std::array<int, 2> node{i, k};
    for (std::size_t a = 0; a < 2; ++a)
      if (const Grid& grid = table.grids_[a]; grid.input >= 0)
        positions[static_cast<std::size_t>(grid.input)] = grid.lower + node[a] * grid.step;
    posed.pose(positions);
    const Pose T = posed.T_world_link(link).inverse(Eigen::Isometry) * posed.T_world_link(other);
    if (last[0] >= 0) most = std::min(most, body.between(other_body, T, last).distance);
    const TriangleTree::Nearest nearest = body.nearest(other_body, T, most);
    if (nearest.triangles[0] >= 0) last = nearest.triangles;
    return nearest.distance;
  }
  /// Of half of all nodes.
  double usual(double most) {
    std::vector<double> all;
    for (int k = 0; k < table.grids_[1].nodes; ++k)
      for (int i = 0; i < table.grids_[0].nodes; ++i) all.push_back(distance(i, k, most));
    const auto half = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), half, all.end());
    return *half;
  }
  /// Margins of the nodes from `low` up to, not including, `high`: halves them until all are known to be clear, or
  /// too close, or one is left.
  void make(std::array<int, 2> low, std::array<int, 2> high) {
    std::array<int, 2> middle{};
    double around = 0;  // no node of these is farther from the middle, as the fastest point goes
    for (std::size_t a = 0; a < 2; ++a) {
      middle[a] = (low[a] + high[a]) / 2;
      around += table.grids_[a].way * (middle[a] - low[a]);
    }
    const double kept = table.kept_, found = distance(middle[0], middle[1], 2 * kept + around);
    const bool inside = found + around < kept && (around > 0 || found == 0);
    if (inside || around == 0 || found - around >= kept) {
      const float margin = inside ? kInside : static_cast<float>(found - around - kept);
      for (int k = low[1]; k < high[1]; ++k)
        for (int i = low[0]; i < high[0]; ++i) table.at(i, k) = margin;
      return;
    }
    const auto long_side = [&](std::size_t a) { return table.grids_[a].way * (high[a] - low[a] - 1); };
    const std::size_t a = long_side(1) > long_side(0) ? 1 : 0;
    std::array<int, 2> first_high = high, second_low = low;
    first_high[a] = second_low[a] = middle[a];
    make(low, first_high);
    make(second_low, high);
  }
};

void NearLinks::lay(const std::vector<Axis>& axes, double way, int most_nodes) {
  for (std::size_t a = 0; a < axes.size(); ++a) {
    Grid& grid = grids_[a];
    const Axis& axis = axes[a];
    grid.input = axis.input;
    grid.endless = !std::isfinite(axis.lower) || !std::isfinite(axis.upper);
    grid.lower = grid.endless ? -std::numbers::pi : axis.lower;
    const double range = grid.endless ? 2 * std::numbers::pi : axis.upper - axis.lower;
    const double steps = std::clamp(std::ceil(range * axis.lever / way), 1.0, most_nodes - 1.0);
    grid.nodes = static_cast<int>(steps) + 1;
    grid.step = range / steps;
    grid.way = grid.step * axis.lever;
  }
}

NearLinks::NearLinks(PosedLinks posed, const std::vector<Axis>& axes, std::size_t link, const TriangleTree& body,
                     std::size_t other, const TriangleTree& other_body, double clearance) {
  std::vector<double> at_rest(posed.inputs(), 0);
  Maker maker{*this, std::move(posed), link, other, body, other_body, std::move(at_rest)};
  lay(axes, kStep * clearance, kFewNodes);
  const double usual = maker.usual(kUsuallyMore * clearance);
  if (usual < kNested) return;
  kept_ = std::min(clearance, usual / kUsuallyMore);
  lay(axes, kStep * kept_, kMostNodes);
  table_.resize(static_cast<std::size_t>(grids_[0].nodes * grids_[1].nodes));
  maker.make({0, 0}, {grids_[0].nodes, grids_[1].nodes});
  measure_depths();
}

// Two sweeps, there and back, in ways along the axes.
void NearLinks::measure_depths() {
  const int columns = grids_[0].nodes, rows = grids_[1].nodes;
  std::vector<bool> inside;
  for (const float value : table_) inside.push_back(value == kInside);
  const auto from = [&](int i, int k, int other_i, int other_k, double way) {
    if (other_i < 0 || other_i >= columns || other_k < 0 || other_k >= rows) return;
    if (!inside[static_cast<std::size_t>(k * columns + i)]) return;
    at(i, k) = std::max(at(i, k), std::min(at(other_i, other_k), 0.0F) - static_cast<float>(way));
  };
  for (int k = 0; k < rows; ++k)
    for (int i = 0; i < columns; ++i) {
      from(i, k, i - 1, k, grids_[0].way);
      from(i, k, i, k - 1, grids_[1].way);
    }
  for (int k = rows - 1; k >= 0; --k)
    for (int i = columns - 1; i >= 0; --i) {
      from(i, k, i + 1, k, grids_[0].way);
      from(i, k, i, k + 1, grids_[1].way);
    }
}

double NearLinks::margin(std::span<const double> positions) const noexcept {
  std::array<int, 2> node{};
  std::array<float, 2> beyond{};
  for (std::size_t a = 0; a < 2; ++a) {
    const Grid& grid = grids_[a];
    if (grid.input < 0) continue;
    double position = positions[static_cast<std::size_t>(grid.input)];
    if (!std::isfinite(position)) return std::numeric_limits<double>::quiet_NaN();
    if (grid.endless) position = std::remainder(position, 2 * std::numbers::pi);
    const double steps = std::clamp((position - grid.lower) / grid.step, 0.0, static_cast<double>(grid.nodes - 1));
    node[a] = std::min(static_cast<int>(steps), grid.nodes - 2);
    beyond[a] = static_cast<float>(steps - node[a]);
  }
  const auto along = [&](int k) {
    const float here = at(node[0], k);
    return beyond[0] > 0 ? here + beyond[0] * (at(node[0] + 1, k) - here) : here;
  };
  const float here = along(node[1]);
  return beyond[1] > 0 ? here + beyond[1] * (along(node[1] + 1) - here) : here;
}

}  // namespace foresight
