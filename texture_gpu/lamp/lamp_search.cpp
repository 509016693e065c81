#include "texture_gpu/lamp/lamp_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "texture_gpu/lamp/lamp_strength.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kFewestDark = 40;
constexpr std::size_t kMostCoarse = 400;
constexpr int kDirections = 300;
constexpr double kDistance = 3, kOtherDistances[] = {1.5, 10};        // extents of what moves
constexpr std::size_t kWorthOthers = 75;                              // directions that are looked at in these, too
constexpr double kRadii[] = {0, 0.02, 0.04, 0.07, 0.11, 0.16, 0.22};  // of the distance
constexpr double kApart = 0.35;                                       // radians: another direction
constexpr double kWorthSoft = 0.6;  // of the best score with hard shadows: may be the best with soft ones
// To be believed: so much, and so many times what others do; less where the same lamp was believed before.
constexpr double kFewestExplained = 0.4, kClearly = 1.5, kAgain = 1.25;
constexpr double kStillExplains = 0.8;  // of what it did, at least: nothing else is looked for
// Of single images: points in all, and to look all around with. To be believed: so much likelier than no lamp
// (logarithm), and so many times what others explain.
constexpr std::size_t kMostStill = 2000, kCoarseStill = 600;
constexpr double kStillLikelier = 25, kStillClearly = 1.6;
constexpr std::size_t kOthers = 12;  // places in other directions that are looked at with all points
// Another lamp is there where single images are so much likelier with it (logarithm; also as a share of how much
// likelier they are with the first alone), and where it is not much weaker.
constexpr double kSecondLikelier = 10, kSecondShare = 0.25, kSecondStrength = 0.4;
// What moves speaks against it by so many dark observations, or more.
constexpr std::size_t kDarkAgainstSecond = 120;
// Shares that two lamps explain, in sum, when they explain the same: each its own shadows would be 1 at most.
constexpr double kSameShadows = 1.2;

const Disc kPoint;  // a lamp without extent

/// How much likelier values are with such a share of their squared deviations explained, logarithm: as if they were
/// normally distributed, and none told anything of another.
double likelier(std::ptrdiff_t count, double explained) {
  return -0.5 * static_cast<double>(count) * std::log(1 - std::min(explained, 0.999));
}

/// Of the line through zero by which `y` goes best with `x`.
double slope(const VectorXd& x, const VectorXd& y) {
  const double xx = x.squaredNorm();
  return xx > 0 ? x.dot(y) / xx : 0;
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
    double explained = 0, still = 0;  // shares of squared deviations: over time, and from what is around
    double score = 0;                 // how much likelier both are with this lamp than with none, logarithm
  };
  struct Coarse {
    Candidate lamp;
    VectorXd more_hidden;  // of coarse_
  };
  struct Two {
    double explained = 0, strength = 0;  // of the second, as a share of the first
  };
  bool what_moves_may_tell() const { return moving_.dark() >= kFewestDark; }
  VectorXd more_hidden(const Candidate& c, const Disc& disc, const StillShadows& images) const;
  static Two both(const VectorXd& first, const VectorXd& second, const VectorXd& brighter);
  bool there_are_several(const Candidate& best, std::span<const Coarse> all);
  bool throws_no_shadows(double strength, const Candidate& first) const;
  void judge(Candidate& c, const Disc& disc) const;
  void judge_coarsely(Candidate& c, const VectorXd& more) const;
  void judge(Candidate& c, const Disc& disc, std::size_t most, const VectorXd& more, const VectorXd& brighter) const;
  template <class Judge>
  void refine(Candidate& best, int rounds, int tries, double spread, const Disc& disc, const Judge& judge);
  void refine(Candidate& best, int rounds, int tries, double spread, const Disc& disc);
  static bool is_elsewhere(const Candidate& a, const Candidate& b, double apart);
  static void keep_best(std::vector<Candidate>& all, std::size_t most);
  std::vector<Coarse> coarse();
  std::vector<Candidate> fine(std::span<const Coarse> all);
  LampAnswer keep(LampAnswer out) const;
  std::optional<LampAnswer> confirm();
  bool still_holds(const Candidate& best, const LampAnswer& before) const;
  LampStrength strength(const Lamp& lamp) const { return lamp_strength(moving_, single_, lamp.position, lamp.radius); }
  Candidate as_candidate(const Lamp& lamp) const;
  Lamp as_lamp(const Candidate& c) const { return {place(c), c.radius * c.distance, {}}; }
  Vector3d place(const Candidate& c) const { return centre_ + c.distance * c.direction; }

  const LampQuestion& question_;
  std::mt19937 generator_{1};
  const MovingShadows moving_;
  const StillShadows single_, coarse_;  // with all points, and with fewer
  Vector3d centre_;
  double extent_ = 1;
  const Disc soft_ = spiral(ShadowRays::kPacket);
};

LampSearch::LampSearch(const ShadowRays& rays, const LampQuestion& question)
    : question_(question),
      moving_(rays, question.witnesses, question.records, question.moving, generator_),
      single_(rays, question.witnesses, question.records, kMostStill),
      coarse_(rays, question.witnesses, question.records, kCoarseStill) {
  Eigen::AlignedBox3d box;
  for (const LampRecord& record : question.records)
    for (std::size_t i = 0; i < question.moving.size(); ++i)
      if (question.moving[i]) box.extend(record.T_world_node[i].translation());
  centre_ = box.center();
  extent_ = std::max(0.2, box.diagonal().norm());
}

VectorXd LampSearch::more_hidden(const Candidate& c, const Disc& disc, const StillShadows& images) const {
  return images.more_hidden(place(c), c.radius * c.distance, disc);
}

void LampSearch::judge(Candidate& c, const Disc& disc) const {
  judge(c, disc, std::numeric_limits<std::size_t>::max(), more_hidden(c, disc, single_), single_.brighter());
}

/// With a hard shadow.
void LampSearch::judge_coarsely(Candidate& c, const VectorXd& more) const {
  judge(c, kPoint, kMostCoarse, more, coarse_.brighter());
}

/// By so many of the chosen observations at most, and by points of single images. Of the former those that were dark
/// count: the others agree with any lamp whose shadows lie elsewhere.
void LampSearch::judge(Candidate& c, const Disc& disc, std::size_t most, const VectorXd& more,
                       const VectorXd& brighter) const {
  c.explained = moving_.explained(place(c), c.radius * c.distance, disc, most);
  const double xy = more.dot(brighter);
  c.still = xy < 0 ? xy * xy / (more.squaredNorm() * brighter.squaredNorm()) : 0;
  const auto dark = static_cast<std::ptrdiff_t>(moving_.dark(most));
  c.score = likelier(dark, c.explained) + likelier(more.size(), c.still);
}

LampSearch::Candidate LampSearch::as_candidate(const Lamp& lamp) const {
  const Vector3d d = lamp.position - centre_;
  return {d.normalized(), d.norm(), lamp.radius / d.norm()};
}

bool LampSearch::is_elsewhere(const Candidate& a, const Candidate& b, double apart) {
  return a.direction.dot(b.direction) < std::cos(apart);
}

/// The best first.
void LampSearch::keep_best(std::vector<Candidate>& all, std::size_t most) {
  std::ranges::sort(all, std::greater(), &Candidate::score);
  all.resize(std::min(all.size(), most));
}

/// As if each image's light were that of two lamps, and hidden from each point by so much more than around.
LampSearch::Two LampSearch::both(const VectorXd& first, const VectorXd& second, const VectorXd& brighter) {
  const double per = slope(first, second), of_first = slope(first, brighter), all = brighter.squaredNorm();
  const VectorXd rest = second - per * first;
  const double of_second = std::min(0.0, slope(rest, brighter)), with_second = of_first - per * of_second;
  if (!(all > 0)) return {};
  return {.explained = (of_first * of_first * first.squaredNorm() + of_second * of_second * rest.squaredNorm()) / all,
          .strength = with_second < 0 ? of_second / with_second : std::numeric_limits<double>::infinity()};
}

/// A second lamp of such a strength beside the first. What moves would throw shadows of both, and of those of the
/// second the first lamp would explain nothing. Which of the two is the stronger one single images do not tell well.
bool LampSearch::throws_no_shadows(double strength, const Candidate& first) const {
  const double weaker = std::min(strength, 1 / strength);
  return moving_.dark() >= kDarkAgainstSecond && first.explained > 1 / (1 + weaker * weaker);
}

/// Whether single images show shadows of another lamp that is not much weaker.
bool LampSearch::there_are_several(const Candidate& best, std::span<const Coarse> all) {
  if (single_.empty()) return false;
  const VectorXd coarsely = more_hidden(best, soft_, coarse_), x = more_hidden(best, soft_, single_);
  std::vector<Candidate> others;
  for (const Coarse& one : all)
    if (is_elsewhere(one.lamp, best, kApart)) {
      others.push_back(one.lamp);
      others.back().score = both(coarsely, one.more_hidden, coarse_.brighter()).explained;
    }
  keep_best(others, kOthers);
  Two two;
  const auto judge_second = [&](Candidate& c) {
    if (!is_elsewhere(c, best, kApart)) return;
    const Two with = both(x, more_hidden(c, kPoint, single_), single_.brighter());
    c.score = with.explained;
    if (with.explained > two.explained) two = with;
  };
  for (Candidate& c : others) judge_second(c);
  keep_best(others, 2);
  for (Candidate& c : others) refine(c, 2, 12, 0.12, kPoint, judge_second);
  const double alone = likelier(x.size(), best.still), more = likelier(x.size(), two.explained) - alone;
  return more >= kSecondLikelier && more >= kSecondShare * alone && two.strength >= kSecondStrength &&
         !throws_no_shadows(two.strength, best);
}

template <class Judge>
void LampSearch::refine(Candidate& best, int rounds, int tries, double spread, const Disc& disc, const Judge& judge) {
  std::normal_distribution<double> normal;
  judge(best);
  for (int round = 0; round < rounds; ++round, spread /= 2)
    for (int i = 0; i < tries; ++i) {
      Candidate c = best;
      c.direction =
          (c.direction + spread * Vector3d(normal(generator_), normal(generator_), normal(generator_))).normalized();
      c.distance *= std::exp(2 * spread * normal(generator_));
      if (disc.cols() > 0) c.radius = std::clamp(c.radius * std::exp(2 * spread * normal(generator_)), 0.005, 0.4);
      judge(c);
      if (c.score > best.score) best = c;
    }
}

void LampSearch::refine(Candidate& best, int rounds, int tries, double spread, const Disc& disc) {
  refine(best, rounds, tries, spread, disc, [&](Candidate& c) { judge(c, disc); });
}

/// Candidates all around, with hard shadows; the best first.
std::vector<LampSearch::Coarse> LampSearch::coarse() {
  std::vector<Coarse> out;
  const auto add = [&](const Vector3d& direction, double distance) {
    Coarse one{{direction, distance}, {}};
    one.more_hidden = more_hidden(one.lamp, kPoint, coarse_);
    judge_coarsely(one.lamp, one.more_hidden);
    out.push_back(std::move(one));
  };
  const auto sort = [&] { std::ranges::sort(out, std::greater(), [](const Coarse& one) { return one.lamp.score; }); };
  for (int i = 0; i < kDirections; ++i) {  // evenly over the sphere
    const double z = 1 - 2 * (i + 0.5) / kDirections, a = i * 2.39996, r = std::sqrt(1 - z * z);
    add({r * std::cos(a), r * std::sin(a), z}, kDistance * extent_);
  }
  sort();
  for (std::size_t i = 0; i < kWorthOthers; ++i)
    for (const double distance : kOtherDistances) add(Vector3d(out[i].lamp.direction), distance * extent_);
  if (question_.last.lamp) {
    const Candidate known = as_candidate(*question_.last.lamp);
    add(known.direction, known.distance);
  }
  sort();
  return out;
}

/// What was known, unless something speaks against it.
LampAnswer LampSearch::keep(LampAnswer out) const {
  out.lamp = question_.last.lamp;
  out.told_by_what_moves = question_.last.told_by_what_moves;
  if (out.lamp && strength(*out.lamp).is_gone(out.lamp->strength)) out.lamp.reset();
  return out;
}

/// It explains most of what it did, of what tells the lamp, and enough of it.
bool LampSearch::still_holds(const Candidate& best, const LampAnswer& before) const {
  return before.told_by_what_moves ? best.explained >= std::max(kFewestExplained, kStillExplains * before.explained)
                                   : best.still >= kStillExplains * before.still &&
                                         likelier(std::ssize(single_.brighter()), best.still) >= kStillLikelier;
}

/// The last answer, brought up to date; nothing where it no longer holds as it did, or where what moves may tell now.
std::optional<LampAnswer> LampSearch::confirm() {
  LampAnswer out = question_.last;
  if (!out.lamp || out.several || out.told_by_what_moves != what_moves_may_tell()) return std::nullopt;
  Candidate best = as_candidate(*out.lamp);
  refine(best, 3, 8, 0.06, soft_);
  if (!still_holds(best, out)) return std::nullopt;
  const Lamp lamp = as_lamp(best);
  const LampStrength found = strength(lamp);
  if (out.told_by_what_moves && !found.is_told_by_what_moves()) return std::nullopt;
  const Vector3d strength = found.is_told_by_what_moves() ? found.moving : found.still;
  if (!(strength.minCoeff() > 0) || found.is_gone(out.lamp->strength)) return std::nullopt;
  out.lamp = lamp;
  out.lamp->strength = strength;
  out.dark = static_cast<int>(moving_.dark());
  out.explained = best.explained;
  out.still = best.still;
  return out;
}

/// The best, the first of them first with hard shadows and then with soft ones. `all`: the best first.
std::vector<LampSearch::Candidate> LampSearch::fine(std::span<const Coarse> all) {
  std::vector<Candidate> out;
  for (const Coarse& one : all) {
    if (out.size() == 6) break;
    if (std::ranges::all_of(out, [&](const Candidate& c) { return is_elsewhere(c, one.lamp, kApart / 2); }))
      out.push_back(one.lamp);
  }
  for (Candidate& c : out) {
    refine(c, 3, 16, 0.12, kPoint,
           [&](Candidate& tried) { judge_coarsely(tried, more_hidden(tried, kPoint, coarse_)); });
    judge(c, kPoint);
  }
  keep_best(out, out.size());
  const double worth = kWorthSoft * out[0].score;
  for (Candidate& c : std::span(out).first(std::min<std::size_t>(out.size(), 3))) {
    if (c.score < worth) break;
    const Candidate hard = c;
    c.score = -1;
    for (const double radius : kRadii) {
      Candidate soft = hard;
      soft.radius = radius;
      judge(soft, soft_);
      if (soft.score > c.score) c = soft;
    }
  }
  if (question_.last.lamp) judge(out.emplace_back(as_candidate(*question_.last.lamp)), soft_);
  keep_best(out, out.size());
  const auto second = std::ranges::find_if(
      out, [&](const Candidate& c) { return c.score >= worth && is_elsewhere(c, out[0], kApart / 2); });
  if (second != out.end()) refine(*second, 4, 12, 0.06, soft_);
  refine(out[0], 4, 12, 0.06, soft_);
  keep_best(out, out.size());
  return out;
}

LampAnswer LampSearch::answer() {
  if (!question_.all_around)
    if (const std::optional<LampAnswer> confirmed = confirm()) return *confirmed;
  LampAnswer out;
  out.dark = static_cast<int>(moving_.dark());
  const bool moves = what_moves_may_tell();
  if (!moves && (question_.last.told_by_what_moves || single_.empty())) return keep(out);
  const std::vector<Coarse> all = coarse();
  std::vector<Candidate> others = fine(all);
  const Candidate best = others[0];
  out.explained = best.explained;
  out.still = best.still;
  std::size_t looked_at = 0;
  for (const Coarse& one : all) {
    if (!is_elsewhere(one.lamp, best, kApart)) continue;
    out.elsewhere = std::max(out.elsewhere, one.lamp.explained);
    if (++looked_at <= kOthers) judge(others.emplace_back(one.lamp), kPoint);  // of all points
  }
  for (const Candidate& c : others) {
    if (!is_elsewhere(c, best, kApart)) continue;
    out.elsewhere = std::max(out.elsewhere, c.explained);
    out.still_elsewhere = std::max(out.still_elsewhere, c.still);
  }
  out.several = there_are_several(best, all);
  if (out.several) return question_.last.lamp && !question_.last.several ? keep(out) : out;  // one search may err
  const Lamp lamp = as_lamp(best);
  const LampStrength found = strength(lamp);
  const bool explains = moves && out.explained >= kFewestExplained;
  const bool again = question_.last.lamp && !is_elsewhere(best, as_candidate(*question_.last.lamp), kApart);
  const bool clearly = out.explained >= (again ? kAgain : kClearly) * out.elsewhere;
  const bool holds = again && question_.last.told_by_what_moves && out.explained + out.elsewhere > kSameShadows;
  out.told_by_what_moves = explains && (clearly || holds);
  const bool told_by_single_images = !explains && likelier(single_.brighter().size(), out.still) >= kStillLikelier &&
                                     out.still >= (again ? kAgain : kStillClearly) * out.still_elsewhere &&
                                     !found.is_gone(found.still);
  if (!out.told_by_what_moves && !told_by_single_images) return question_.last.told_by_what_moves ? out : keep(out);
  out.lamp = lamp;
  out.lamp->strength = found.is_told_by_what_moves() ? found.moving : found.still;
  if (!(out.lamp->strength.minCoeff() > 0)) {
    out.lamp.reset();
    out.told_by_what_moves = false;
  }
  return out;
}

}  // namespace

LampAnswer find_lamp(const ShadowRays& rays, const LampQuestion& question) {
  return LampSearch(rays, question).answer();
}

}  // namespace foresight
