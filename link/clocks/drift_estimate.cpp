#include "link/clocks/drift_estimate.hpp"

#include <algorithm>
#include <vector>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kStamping = 0.1e6;  // ns: what stamps and scheduling add to a middle
constexpr double kWander = 2e-6;     // a drift changes by this much, with the temperature

double middle(const OffsetAnchor& a) {
  return 0.5 * (a.least + a.most);
}

}  // namespace

DriftInterval drift_of(std::span<const OffsetAnchor> anchors, DriftInterval widest) {
  DriftInterval out = widest;
  if (anchors.size() < 2) return out;
  std::vector<double> widths;
  for (const OffsetAnchor& a : anchors) widths.push_back(a.most - a.least);
  const double narrowest = *std::min_element(widths.begin(), widths.end());
  // Even the narrowest is wider than the ways' least delays: by about as much as the better ones differ.
  const double common = kStamping + quantile(widths, 0.25) - narrowest;
  for (std::size_t j = anchors.size() - 1; j-- > 0;) {
    DriftInterval with = out;
    for (std::size_t k = j + 1; k < anchors.size(); ++k) {
      const double time = anchors[k].at - anchors[j].at;
      if (time <= 0) continue;
      const double doubt = 0.5 * (widths[j] + widths[k]) - narrowest + common;
      const double drift = (middle(anchors[k]) - middle(anchors[j])) / time;
      with.least = std::max(with.least, drift - doubt / time - kWander);
      with.most = std::min(with.most, drift + doubt / time + kWander);
    }
    if (with.least > with.most) break;
    out = with;
  }
  return out;
}

}  // namespace foresight
