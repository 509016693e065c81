#include "texture_gpu/lamp/lamp_watch.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "common/statistics.hpp"
#include "texture_gpu/lamp/round_lamp.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kEvery = 2;       // of the witnesses: half of them tell as well
constexpr std::size_t kLongest = 12;    // records
constexpr int kFewestAgainst = 3;       // of them
constexpr int kFewestPoints = 40;       // in their shadows
constexpr double kGone = 0.2;           // of the darkness that is foretold
constexpr double kWhole = 0.9;          // of the lamp: the middle of a shadow
constexpr std::size_t kFewestLit = 50;  // that tell an image's exposure
constexpr float kNeverLit = std::numeric_limits<float>::quiet_NaN();

/// What all of a lamp, hidden, does to the luma of a surface, logarithm.
double darkness(const Lamp& lamp, const Witness& witness) {
  const double share = facing(witness.normal.cast<double>(), lamp.position - witness.point.cast<double>());
  Eigen::Vector3f factors;
  for (int c = 0; c < 3; ++c) factors[c] = static_cast<float>(std::log(shadow_factor(lamp.strength[c] * share, 1)));
  return luma_of(factors);
}

}  // namespace

void LampWatch::look(const ShadowRays& rays, std::span<const Witness> witnesses, const LampRecord& record,
                     const std::vector<bool>& moving, const Lamp& lamp) {
  static const Disc disc = spiral(ShadowRays::kPacket);
  lit_.resize(witnesses.size(), kNeverLit);
  std::vector<std::size_t> asked;
  std::vector<Eigen::Vector3f> points;  // of these
  for (std::size_t i = 0; i < witnesses.size(); i += kEvery)
    if (record.knows(i) && witnesses[i].normal.dot(lamp.position.cast<float>() - witnesses[i].point) > 0) {
      asked.push_back(i);
      points.push_back(witnesses[i].point);
    }
  const ShadowRays::Posed posed = rays.pose(record.T_world_node, moving);
  const std::vector<bool> shaded = posed.blocked(points, lamp.position);
  std::vector<float> changes;
  for (std::size_t k = 0; k < asked.size(); ++k)
    if (!shaded[k] && !std::isnan(lit_[asked[k]])) changes.push_back(luma_of(record.value(asked[k])) - lit_[asked[k]]);
  const bool goes_on = changes.size() >= kFewestLit;
  const float exposure = goes_on ? median(std::move(changes)) : 0;
  if (!goes_on) lit_.assign(witnesses.size(), kNeverLit);
  std::vector<bool> others = moving;
  others.flip();
  std::optional<ShadowRays::Posed> still;  // once it is asked
  const auto is_hidden_anyway = [&](const Vector3d& p) {
    if (!still) still.emplace(rays.pose(record.T_world_node, others));
    return still->blocked(p, lamp.position, ShadowRays::kContact);
  };
  Shade shade;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const std::size_t i = asked[k];
    const float luma = luma_of(record.value(i)) - exposure;
    const Vector3d p = witnesses[i].point.cast<double>();
    if (!shaded[k]) {
      lit_[i] = luma;
    } else if (!std::isnan(lit_[i]) && hidden_share(posed, p, lamp.position, lamp.radius, disc) >= kWhole &&
               !is_hidden_anyway(p)) {
      const double foretold = darkness(lamp, witnesses[i]);
      ++shade.points;
      shade.darker += (luma - lit_[i]) * foretold;
      shade.foretold += foretold * foretold;
    }
  }
  if (shade.points == 0) return;
  shades_.push_front(shade);
  if (shades_.size() > kLongest) shades_.pop_back();
}

int LampWatch::against() const {
  Shade all;
  int records = 0;
  for (const Shade& shade : shades_) {
    all.points += shade.points;
    all.darker += shade.darker;
    all.foretold += shade.foretold;
    if (++records < kFewestAgainst || all.points < kFewestPoints) continue;
    return all.darker < kGone * all.foretold ? records : 0;
  }
  return 0;
}

}  // namespace foresight
