#include "texture_gpu/lamp/moving_shadows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "common/statistics.hpp"
#include "texture_gpu/lamp/lamp.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kFewestValues = 4;  // of a witness
constexpr double kLit = 0.8;              // quantile of a witness's values: hardly any shadow there
constexpr float kLeastDark = -0.10f, kBrightest = 0.3f, kDeepest = -1.5f;  // logarithms
constexpr std::size_t kMostDark = 400, kMostBright = 400, kMostOthers = 200, kMostShadowed = 3000;
constexpr double kChanges = 0.05;  // share of a lamp
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

std::vector<bool> flipped(std::vector<bool> nodes) {
  nodes.flip();
  return nodes;
}

}  // namespace

MovingShadows::MovingShadows(const ShadowRays& rays, const std::vector<Witness>& witnesses,
                             const std::deque<LampRecord>& records, const std::vector<bool>& moving,
                             std::mt19937& generator)
    : witnesses_(witnesses), records_(records), still_(rays.pose(records.back().T_world_node, flipped(moving))) {
  for (const LampRecord& record : records) moving_.push_back(rays.pose(record.T_world_node, moving));
  all_ = observations();
  std::vector<double> sizes;
  for (const Observation& o : all_)
    if (std::abs(o.luma) < 0.2f) sizes.push_back(o.luma);
  const float bound = std::min(kLeastDark, static_cast<float>(-3 * robust_sigma(sizes)));
  std::vector<bool> was_dark(witnesses.size());
  std::vector<Observation> dark, bright, others;
  for (const Observation& o : all_)
    if (o.luma < bound) was_dark[o.witness] = true;
  for (const Observation& o : all_) (o.luma < bound ? dark : was_dark[o.witness] ? bright : others).push_back(o);
  dark_ = dark.size();
  const auto take = [&](std::vector<Observation>& from, std::size_t most) {
    std::ranges::shuffle(from, generator);
    from.resize(std::min(from.size(), most));
    chosen_.insert(chosen_.end(), from.begin(), from.end());
  };
  take(dark, kMostDark);
  take(bright, kMostBright);
  take(others, kMostOthers);
}

/// Deviations from what each point usually looks like, with each image's own median taken out: its exposure.
std::vector<MovingShadows::Observation> MovingShadows::observations() const {
  const std::size_t count = witnesses_.size();
  std::vector<Observation> out;
  std::vector<Vector3f> lit(count, Vector3f::Constant(kUnknown));
  std::vector<std::size_t> lit_record(count);
  std::vector<Vector3f> offset(records_.size(), Vector3f::Zero());
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<std::pair<float, std::size_t>> values;
      for (std::size_t k = 0; k < records_.size(); ++k)
        if (const Vector3f value = records_[k].value(i) - offset[k]; !value.hasNaN())
          values.emplace_back(luma_of(value), k);
      if (values.size() < kFewestValues) continue;
      const auto at = static_cast<std::ptrdiff_t>(kLit * static_cast<double>(values.size() - 1));
      std::ranges::nth_element(values, values.begin() + at);
      const std::size_t k = values[static_cast<std::size_t>(at)].second;
      lit[i] = records_[k].value(i) - offset[k];
      lit_record[i] = k;
    }
    out.clear();
    for (std::size_t k = 0; k < records_.size(); ++k) {
      std::array<std::vector<float>, 3> channel;
      const std::size_t first = out.size();
      for (std::size_t i = 0; i < count; ++i) {
        const Vector3f deviation = records_[k].value(i) - offset[k] - lit[i];
        if (deviation.hasNaN()) continue;
        out.push_back({k, i, lit_record[i], deviation, luma_of(deviation)});
        for (int c = 0; c < 3; ++c) channel[static_cast<std::size_t>(c)].push_back(deviation[c]);
      }
      Vector3f middle;
      for (int c = 0; c < 3; ++c) middle[c] = median(channel[static_cast<std::size_t>(c)]);
      offset[k] += middle;
      for (std::size_t n = first; n < out.size(); ++n) {
        out[n].deviation -= middle;
        out[n].luma = std::clamp(luma_of(out[n].deviation), kDeepest, kBrightest);
      }
    }
  }
  return out;
}

double MovingShadows::hidden(std::size_t witness, std::size_t record, const Vector3d& lamp, double radius,
                             const Disc& disc) const {
  const Witness& w = witnesses_[witness];
  const Vector3d p = w.point.cast<double>();
  if (w.normal.cast<double>().dot(lamp - p) <= 0) return 0;
  const double share = hidden_share(moving_[record], p, lamp, radius, disc);
  return share > 0 && !still_.blocked(p, lamp, ShadowRays::kContact) ? share : 0;
}

std::size_t MovingShadows::dark(std::size_t most) const {
  return std::min({most, kMostDark, dark_});
}

double MovingShadows::explained(const Vector3d& lamp, double radius, const Disc& disc, std::size_t most) const {
  double sxy = 0, sxx = 0, syy = 0;
  for (const Observation& o : std::span(chosen_).first(std::min(most, chosen_.size()))) {
    const double y = o.luma;
    const double x = hidden(o.witness, o.record, lamp, radius, disc) - hidden(o.witness, o.lit, lamp, radius, disc);
    sxy += x * y, sxx += x * x, syy += y * y;
  }
  return sxy < 0 && syy > 0 ? sxy * sxy / (sxx * syy) : 0;
}

std::vector<MovingShadows::Shadowed> MovingShadows::shadowed(const Vector3d& lamp, double radius, const Disc& coarsely,
                                                             const Disc& finely) const {
  std::vector<Shadowed> out;
  const std::size_t stride = std::max<std::size_t>(1, all_.size() / (10 * kMostShadowed));
  for (std::size_t i = 0; i < all_.size() && out.size() < kMostShadowed; i += stride) {
    const auto& [record, witness, lit, deviation, luma] = all_[i];
    if (hidden(witness, record, lamp, radius, coarsely) == 0 && hidden(witness, lit, lamp, radius, coarsely) == 0)
      continue;
    const double now = hidden(witness, record, lamp, radius, finely),
                 usually = hidden(witness, lit, lamp, radius, finely);
    if (std::abs(now - usually) < kChanges) continue;
    const Witness& w = witnesses_[witness];
    out.push_back({deviation, facing(w.normal.cast<double>(), lamp - w.point.cast<double>()), now, usually});
  }
  return out;
}

}  // namespace foresight
