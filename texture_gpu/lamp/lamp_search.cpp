#include "texture_gpu/lamp/lamp_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "common/statistics.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kFewestValues = 4;  // of a witness
constexpr double kLit = 0.8;              // quantile of a witness's values: hardly any shadow there
constexpr float kLeastDark = -0.10f, kBrightest = 0.3f, kDeepest = -1.5f;  // logarithms
constexpr std::size_t kFewestDark = 40;
constexpr std::size_t kMostDark = 400, kMostBright = 400, kMostOthers = 200, kMostInFit = 3000, kMostCoarse = 400;
constexpr int kDirections = 300;
constexpr double kDistances[] = {1.5, 3, 10};                         // extents of what moves
constexpr double kRadii[] = {0, 0.02, 0.04, 0.07, 0.11, 0.16, 0.22};  // of the distance
constexpr double kApart = 0.35;                                       // radians: another direction
constexpr std::size_t kSoftRays = ShadowRays::kPacket, kFitRays = 3 * ShadowRays::kPacket;
constexpr double kFewestExplained = 0.4, kClearly = 1.5;  // to be believed: so much, and so many times what others do
constexpr double kGoneShare = 0.25;                       // of its strength that is left of a lamp that is off
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

float luma_of(const Vector3f& rgb) {
  return rgb.dot(Vector3f(0.299f, 0.587f, 0.114f));
}

struct Observation {
  std::size_t record = 0, witness = 0;
  std::size_t lit = 0;  // the record that shows the witness as bright as it usually is
  Vector3f deviation;   // of red, green and blue from there, logarithms
  float luma = 0;       // mean of these
};

/// Deviations from what each point usually looks like, with each image's own median taken out: its exposure.
std::vector<Observation> observations(const LampQuestion& question) {
  const auto& records = question.records;
  const std::size_t count = question.witnesses.size();
  std::vector<Observation> out;
  std::vector<Vector3f> lit(count, Vector3f::Constant(kUnknown));
  std::vector<std::size_t> lit_record(count);
  std::vector<Vector3f> offset(records.size(), Vector3f::Zero());
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<std::pair<float, std::size_t>> values;
      for (std::size_t k = 0; k < records.size(); ++k)
        if (const Vector3f value = records[k].log_brightness[i] - offset[k]; !value.hasNaN())
          values.emplace_back(luma_of(value), k);
      if (values.size() < kFewestValues) continue;
      const auto at = static_cast<std::ptrdiff_t>(kLit * static_cast<double>(values.size() - 1));
      std::ranges::nth_element(values, values.begin() + at);
      const std::size_t k = values[static_cast<std::size_t>(at)].second;
      lit[i] = records[k].log_brightness[i] - offset[k];
      lit_record[i] = k;
    }
    out.clear();
    for (std::size_t k = 0; k < records.size(); ++k) {
      std::array<std::vector<float>, 3> channel;
      const std::size_t first = out.size();
      for (std::size_t i = 0; i < count; ++i) {
        const Vector3f deviation = records[k].log_brightness[i] - offset[k] - lit[i];
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

/// Points of the unit disc that stand for all of it; none: a lamp without extent.
using Disc = std::vector<Eigen::Vector2d>;
const Disc kPoint;

/// Vogel's spiral.
Disc spiral(std::size_t points) {
  Disc out;
  for (std::size_t k = 0; k < points; ++k) {
    const double r = std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(points)),
                 a = static_cast<double>(k) * 2.39996;
    out.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  return out;
}

/// What each position of a lamp explains of some observations.
class LampSearch {
 public:
  LampSearch(const ShadowRays& rays, const LampQuestion& question);
  LampAnswer answer();

 private:
  struct Candidate {
    Vector3d direction;
    double distance = 1, radius = 0;  // metres; share of the distance
    double explained = 0;
  };
  struct Strength {
    Vector3d strength = Vector3d::Zero();
    std::size_t shadows = 0;  // observations that it is drawn from
  };
  double hidden(std::size_t witness, std::size_t record, const Vector3d& lamp, double radius, const Disc& disc) const;
  double explained(const Candidate& c, const Disc& disc, std::size_t most) const;
  void refine(Candidate& best, int rounds, int tries, double spread, const Disc& disc);
  std::vector<Candidate> coarse();
  Strength strength(const Vector3d& lamp, double radius) const;
  Vector3d place(const Candidate& c) const { return centre_ + c.distance * c.direction; }

  const LampQuestion& question_;
  std::vector<Observation> all_, chosen_;
  std::size_t dark_ = 0;
  std::vector<ShadowRays::Posed> moving_;  // of each record
  ShadowRays::Posed still_;
  Vector3d centre_;
  double extent_ = 1;
  const Disc soft_ = spiral(kSoftRays), fit_ = spiral(kFitRays);
  std::mt19937 generator_{1};
};

std::vector<bool> flipped(std::vector<bool> nodes) {
  nodes.flip();
  return nodes;
}

LampSearch::LampSearch(const ShadowRays& rays, const LampQuestion& question)
    : question_(question),
      all_(observations(question)),
      still_(rays.pose(question.records.back().T_world_node, flipped(question.moving))) {
  for (const LampRecord& record : question.records) moving_.push_back(rays.pose(record.T_world_node, question.moving));
  std::vector<double> sizes;
  for (const Observation& o : all_)
    if (std::abs(o.luma) < 0.2f) sizes.push_back(o.luma);
  const float bound = std::min(kLeastDark, static_cast<float>(-3 * robust_sigma(sizes)));
  std::vector<bool> was_dark(question.witnesses.size());
  std::vector<Observation> dark, bright, others;
  for (const Observation& o : all_)
    if (o.luma < bound) was_dark[o.witness] = true;
  for (const Observation& o : all_) (o.luma < bound ? dark : was_dark[o.witness] ? bright : others).push_back(o);
  dark_ = dark.size();
  const auto take = [&](std::vector<Observation>& from, std::size_t most) {
    std::ranges::shuffle(from, generator_);
    from.resize(std::min(from.size(), most));
    chosen_.insert(chosen_.end(), from.begin(), from.end());
  };
  take(dark, kMostDark);
  take(bright, kMostBright);
  take(others, kMostOthers);

  Eigen::AlignedBox3d box;
  for (const LampRecord& record : question.records)
    for (std::size_t i = 0; i < question.moving.size(); ++i)
      if (question.moving[i]) box.extend(record.T_world_node[i].translation());
  centre_ = box.center();
  extent_ = std::max(0.2, box.diagonal().norm());
}

double LampSearch::hidden(std::size_t witness, std::size_t record, const Vector3d& lamp, double radius,
                          const Disc& disc) const {
  const Witness& w = question_.witnesses[witness];
  const Vector3d p = w.point.cast<double>(), to_lamp = lamp - p;
  if (w.normal.cast<double>().dot(to_lamp) <= 0) return 0;
  const ShadowRays::Posed& moving = moving_[record];
  const Vector3d right = to_lamp.unitOrthogonal(), up = to_lamp.normalized().cross(right);
  int hits = 0;
  std::array<Vector3d, ShadowRays::kPacket> to;
  for (std::size_t first = 0; first < disc.size(); first += to.size()) {
    for (std::size_t k = 0; k < to.size(); ++k)
      to[k] = lamp + radius * (disc[first + k].x() * right + disc[first + k].y() * up);
    hits += moving.count_blocked(p, to);
  }
  if (disc.empty()) hits = moving.blocked(p, lamp);
  if (hits == 0 || still_.blocked(p, lamp, 5e-3)) return 0;
  return static_cast<double>(hits) / static_cast<double>(std::max<std::size_t>(1, disc.size()));
}

/// Share of the squared deviations that shadows of this lamp take away, at the darkness that suits them best.
double LampSearch::explained(const Candidate& c, const Disc& disc, std::size_t most) const {
  const Vector3d lamp = place(c);
  double sxy = 0, sxx = 0, syy = 0;
  for (const Observation& o : std::span(chosen_).first(std::min(most, chosen_.size()))) {
    const double radius = c.radius * c.distance, y = o.luma;
    const double x = hidden(o.witness, o.record, lamp, radius, disc) - hidden(o.witness, o.lit, lamp, radius, disc);
    sxy += x * y, sxx += x * x, syy += y * y;
  }
  return sxy < 0 && syy > 0 ? sxy * sxy / (sxx * syy) : 0;
}

void LampSearch::refine(Candidate& best, int rounds, int tries, double spread, const Disc& disc) {
  std::normal_distribution<double> normal;
  best.explained = explained(best, disc, chosen_.size());
  for (int round = 0; round < rounds; ++round, spread /= 2)
    for (int i = 0; i < tries; ++i) {
      Candidate c = best;
      c.direction =
          (c.direction + spread * Vector3d(normal(generator_), normal(generator_), normal(generator_))).normalized();
      c.distance *= std::exp(2 * spread * normal(generator_));
      if (!disc.empty()) c.radius = std::clamp(c.radius * std::exp(2 * spread * normal(generator_)), 0.005, 0.4);
      c.explained = explained(c, disc, chosen_.size());
      if (c.explained > best.explained) best = c;
    }
}

/// The best candidates all around, with hard shadows; the best first.
std::vector<LampSearch::Candidate> LampSearch::coarse() {
  std::vector<Candidate> out;
  const auto add = [&](const Vector3d& direction, double distance) {
    Candidate c{direction, distance};
    c.explained = explained(c, kPoint, kMostCoarse);
    out.push_back(c);
  };
  for (int i = 0; i < kDirections; ++i) {  // evenly over the sphere
    const double z = 1 - 2 * (i + 0.5) / kDirections, a = i * 2.39996, r = std::sqrt(1 - z * z);
    for (const double distance : kDistances) add({r * std::cos(a), r * std::sin(a), z}, distance * extent_);
  }
  if (question_.known) {
    const Vector3d d = question_.known->position - centre_;
    add(d.normalized(), d.norm());
  }
  std::ranges::sort(out, std::greater(), &Candidate::explained);
  return out;
}

LampAnswer LampSearch::answer() {
  LampAnswer out;
  out.dark = static_cast<int>(dark_);
  if (dark_ < kFewestDark) {  // nothing new; but where the lamp that is known should have thrown shadows it must have
    out.lamp = question_.known;
    if (!out.lamp) return out;
    const Strength now = strength(out.lamp->position, out.lamp->radius);
    if (now.shadows >= kFewestDark && now.strength.sum() < kGoneShare * out.lamp->strength.sum()) out.lamp.reset();
    return out;
  }
  const auto other = [](const Candidate& a, const Candidate& b, double apart) {
    return a.direction.dot(b.direction) < std::cos(apart);
  };
  const std::vector<Candidate> all = coarse();
  std::vector<Candidate> best;
  for (const Candidate& c : all) {
    if (best.size() == 6) break;
    if (std::ranges::all_of(best, [&](const Candidate& b) { return other(b, c, kApart / 2); })) best.push_back(c);
  }
  for (Candidate& c : best) refine(c, 3, 16, 0.12, kPoint);
  std::ranges::sort(best, std::greater(), &Candidate::explained);
  best.resize(std::min<std::size_t>(best.size(), 3));
  for (Candidate& c : best) {
    const Candidate hard = c;
    c.explained = -1;
    for (const double radius : kRadii) {
      Candidate soft = hard;
      soft.radius = radius;
      soft.explained = explained(soft, soft_, chosen_.size());
      if (soft.explained > c.explained) c = soft;
    }
    refine(c, 4, 12, 0.06, soft_);
  }
  std::ranges::sort(best, std::greater(), &Candidate::explained);
  out.explained = best[0].explained;
  for (const auto& list : {all, best})
    for (const Candidate& c : list)
      if (other(c, best[0], kApart)) out.elsewhere = std::max(out.elsewhere, c.explained);
  if (out.explained < kFewestExplained || out.explained < kClearly * out.elsewhere) return out;
  const Lamp lamp{place(best[0]), best[0].radius * best[0].distance,
                  strength(place(best[0]), best[0].radius * best[0].distance).strength};
  if (lamp.strength.minCoeff() > 0) out.lamp = lamp;
  return out;
}

/// For each channel the one with the least absolute error.
LampSearch::Strength LampSearch::strength(const Vector3d& lamp, double radius) const {
  struct Shadowed {
    Vector3f deviation;
    double facing, hidden, usually;  // (n . l) / d^2; shares of the lamp
  };
  std::vector<Shadowed> shadowed;
  const std::size_t step = std::max<std::size_t>(1, all_.size() / (10 * kMostInFit));
  for (std::size_t i = 0; i < all_.size() && shadowed.size() < kMostInFit; i += step) {
    const double x = hidden(all_[i].witness, all_[i].record, lamp, radius, fit_);
    const double usually = hidden(all_[i].witness, all_[i].lit, lamp, radius, fit_);
    if (std::abs(x - usually) < 0.05) continue;
    const Witness& w = question_.witnesses[all_[i].witness];
    const Vector3d l = lamp - w.point.cast<double>();
    shadowed.push_back({all_[i].deviation, w.normal.cast<double>().dot(l) / std::pow(l.norm(), 3), x, usually});
  }
  Strength out{.shadows = shadowed.size()};
  double mean = 0;
  for (const Shadowed& s : shadowed) mean += s.facing / static_cast<double>(shadowed.size());
  if (!(mean > 0)) return out;
  for (int c = 0; c < 3; ++c) {
    double least = std::numeric_limits<double>::infinity();
    for (double share = 0.02; share < 50; share *= 1.05) {
      double error = 0;
      for (const Shadowed& s : shadowed)
        error += std::abs(s.deviation[c] - std::log(shadow_factor(share * s.facing / mean, s.hidden) /
                                                    shadow_factor(share * s.facing / mean, s.usually)));
      if (error < least) least = error, out.strength[c] = share / mean;
    }
  }
  return out;
}

}  // namespace

LampAnswer find_lamp(const ShadowRays& rays, const LampQuestion& question) {
  return LampSearch(rays, question).answer();
}

}  // namespace foresight
