#include "prediction/spherical_arm.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace foresight {
namespace {

constexpr double kMissesBy = 9e-4;        // m, and rad from a right angle: "1.57" is one
constexpr double kLimitRounding = 1e-10;  // rad and m
constexpr double kNearlySpherical = 4;    // angles are off by so many times what axes miss each other by

// Where two lines come nearest, and how near; nothing where they are almost parallel.
struct Meeting {
  Eigen::Vector3d point;
  double gap;
};
std::optional<Meeting> meeting(const ArmJoint& a, const ArmJoint& b) {
  const Eigen::Vector3d between = b.point - a.point;
  const double c = a.axis.dot(b.axis), s2 = 1 - c * c;
  if (s2 < 1e-6) return std::nullopt;
  const double along_a = (between.dot(a.axis) - c * between.dot(b.axis)) / s2;
  const double along_b = (c * between.dot(a.axis) - between.dot(b.axis)) / s2;
  const Eigen::Vector3d on_a = a.point + along_a * a.axis, on_b = b.point + along_b * b.axis;
  return Meeting{0.5 * (on_a + on_b), (on_a - on_b).norm()};
}

// Where three axes meet, each perpendicular to the next; and by how much (m, rad) they do not.
struct BallCentre {
  Eigen::Vector3d point;
  double misses_by;
};
std::optional<BallCentre> ball_centre(std::span<const ArmJoint> j) {
  const auto one = meeting(j[0], j[1]), two = meeting(j[1], j[2]);
  if (!one || !two) return std::nullopt;
  const double misses_by = std::max({std::abs(j[0].axis.dot(j[1].axis)), std::abs(j[1].axis.dot(j[2].axis)), one->gap,
                                     two->gap, (one->point - two->point).norm()});
  if (misses_by > kMissesBy) return std::nullopt;
  return BallCentre{0.5 * (one->point + two->point), misses_by};
}

BallJoint ball(std::span<const ArmJoint> j) {
  return BallJoint({j[0].axis, j[1].axis, j[2].axis}, {j[0].lower, j[1].lower, j[2].lower},
                   {j[0].upper, j[1].upper, j[2].upper});
}

Eigen::Matrix3d rotation(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// Unit vectors x, y, z with z given.
Eigen::Matrix3d frame_around(const Eigen::Vector3d& z) {
  Eigen::Matrix3d F;
  F.col(0) = z.unitOrthogonal();
  F.col(1) = z.cross(F.col(0));
  F.col(2) = z;
  return F;
}

}  // namespace

// One of the two ways to bend the elbow, with all that depends on it.
struct SphericalArm::Elbow {
  double q4;
  double margin;  // rad to its own limits and to where the arm is longest or shortest
  Eigen::Vector3d n;
  Eigen::Matrix3d R0, R4, G;
  BallTurn shoulder, wrist;
};

std::optional<SphericalArm> SphericalArm::recognise(const ArmChain& chain) {
  const auto j = chain.joints();
  if (j.size() != 7 || !chain.followers().empty() ||
      std::any_of(j.begin(), j.end(), [](const ArmJoint& joint) { return joint.slides; }))
    return std::nullopt;
  const auto S = ball_centre(j.first(3)), W = ball_centre(j.last(3));
  if (!S || !W) return std::nullopt;
  SphericalArm arm;
  arm.shoulder_ = ball(j.first(3));
  arm.wrist_ = ball(j.last(3));
  arm.S_ = S->point;
  arm.W_at_zero_ = W->point;
  arm.W_in_tip_ = chain.tip_at_zero().inverse() * W->point;
  arm.R_tip_at_zero_ = chain.tip_at_zero().linear();
  arm.a4_ = j[3].axis;
  arm.upper_ = j[3].point - S->point;
  arm.lower_ = W->point - j[3].point;
  arm.lower_limit_ = chain.lower();
  arm.upper_limit_ = chain.upper();
  // |upper + rot(a4, q4) lower|^2
  const double along = arm.upper_.dot(arm.a4_) * arm.lower_.dot(arm.a4_);
  const double cosine = 2 * (arm.upper_.dot(arm.lower_) - along);
  const double sine = 2 * arm.upper_.dot(arm.a4_.cross(arm.lower_));
  arm.swing_ = std::hypot(cosine, sine);
  arm.constant_ = arm.upper_.squaredNorm() + arm.lower_.squaredNorm() + 2 * along;
  arm.q4_longest_ = std::atan2(sine, cosine);
  if (arm.swing_ < 1e-4) return std::nullopt;
  // Of an arm that is only nearly spherical, joints on their limits seem to lie beyond them by about as much.
  arm.rounding_ = kLimitRounding + kNearlySpherical * std::max(S->misses_by, W->misses_by);
  return arm;
}

double SphericalArm::distance_at(double q4) const noexcept {
  return std::sqrt(std::max(constant_ + swing_ * std::cos(q4 - q4_longest_), 0.0));
}

double SphericalArm::elbow_bend(double q4) const noexcept {
  return std::abs(std::sin(q4 - q4_longest_));
}

std::optional<SphericalArm::Elbow> SphericalArm::elbow(const Pose& T, double sign) const noexcept {
  const Eigen::Vector3d to_wrist = T * W_in_tip_ - S_;
  const double distance = to_wrist.norm();
  const double cosine = (distance * distance - constant_) / swing_;
  if (!(std::abs(cosine) < 1 + 1e-6 + 2 * distance * rounding_ / swing_)) return std::nullopt;
  Elbow e;
  const double middle = std::isfinite(lower_limit_[3]) && std::isfinite(upper_limit_[3])
                            ? 0.5 * (lower_limit_[3] + upper_limit_[3])
                            : 0.0;
  e.q4 = nearest_turn(q4_longest_ + sign * std::acos(std::clamp(cosine, -1.0, 1.0)), middle);
  // Straight, the arm hardly feels its elbow: rounding of the target's distance moves it by far more than 1e-10 rad.
  const double clamped = std::clamp(e.q4, lower_limit_[3], upper_limit_[3]);
  if (std::abs(distance_at(clamped) - distance) > rounding_) return std::nullopt;
  e.q4 = clamped;
  e.margin = std::min(std::min(e.q4 - lower_limit_[3], upper_limit_[3] - e.q4), std::abs(std::sin(e.q4 - q4_longest_)));
  e.R4 = rotation(a4_, e.q4);
  const Eigen::Vector3d w = upper_ + e.R4 * lower_;
  if (distance < 1e-9 || w.norm() < 1e-9) return std::nullopt;  // wrist in the shoulder: no line to swivel about
  e.n = to_wrist / distance;
  e.R0 = frame_around(e.n) * frame_around(w.normalized()).transpose();
  e.G = T.linear() * R_tip_at_zero_.transpose();
  e.shoulder = shoulder_.turn(
      [&](const Eigen::Vector3d& y, const Eigen::Vector3d& z) { return turned_product(y, e.n, e.R0 * z); });
  const Eigen::Matrix3d A = e.R0 * e.R4;
  e.wrist = wrist_.turn(
      [&](const Eigen::Vector3d& y, const Eigen::Vector3d& z) { return turned_product(e.G * z, e.n, A * y); });
  return e;
}

JointVector SphericalArm::joints(const Elbow& e, double psi, BallSide shoulder, BallSide wrist) const noexcept {
  const auto s = shoulder_.angles(rotation(e.n, psi) * e.R0, shoulder, 0.0);
  const Eigen::Matrix3d R = shoulder_.rotation(s);
  const auto w = wrist_.angles(e.R4.transpose() * R.transpose() * e.G, wrist, 0.0);
  JointVector q(7);
  q << s[0], s[1], s[2], e.q4, w[0], w[1], w[2];
  return q;
}

// Both balls' sides at one swivel angle, and their margin.
struct SphericalArm::Scored {
  double score = -std::numeric_limits<double>::infinity();
  double psi = 0;
  BallSide shoulder = BallSide::positive, wrist = BallSide::positive;
};

SwivelAngles SphericalArm::limit_angles(const Elbow& e) const noexcept {
  SwivelAngles angles;
  shoulder_.add_limits(e.shoulder, rounding_, angles);
  wrist_.add_limits(e.wrist, rounding_, angles);
  angles.sort();
  return angles;
}

// The better sides. Where the shoulder alone is no better than `enough`, the wrist is not looked at.
SphericalArm::Scored SphericalArm::score(const Elbow& e, double psi, double enough) const noexcept {
  const double cosine = std::cos(psi), sine = std::sin(psi);
  const auto s = shoulder_.margins(e.shoulder, cosine, sine);
  const std::size_t i = s[1] > s[0];
  if (s[i] <= enough) return {};
  const auto w = wrist_.margins(e.wrist, cosine, sine);
  const std::size_t k = w[1] > w[0];
  return {std::min(s[i], w[k]), psi, static_cast<BallSide>(i), static_cast<BallSide>(k)};
}

SphericalArm::Scored SphericalArm::score_on(const Elbow& e, double psi, BallSide shoulder,
                                            BallSide wrist) const noexcept {
  const double cosine = std::cos(psi), sine = std::sin(psi);
  const double s = shoulder_.margins(e.shoulder, cosine, sine)[static_cast<std::size_t>(shoulder)];
  const double w = wrist_.margins(e.wrist, cosine, sine)[static_cast<std::size_t>(wrist)];
  return {std::min(s, w), psi, shoulder, wrist};
}

namespace {

// Between neighbours of `angles`, going around; the whole circle where there is none.
template <typename Visit>
void visit_between(const SwivelAngles& angles, const Visit& visit) {
  if (angles.size() == 0) visit(-std::numbers::pi, std::numbers::pi);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const bool last = i + 1 == angles.size();
    visit(angles[i], last ? angles[0] + 2 * std::numbers::pi : angles[i + 1]);
  }
}

// The largest value of a function that rises and falls once, to a twentieth of the interval (golden section).
template <typename Scored, typename Score>
Scored climb(const Score& score, Scored best, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  Scored at_a = score(a), at_b = score(b);
  for (int step = 0; step < 5; ++step) {
    if (at_a.score > at_b.score) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = score(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = score(b);
    }
  }
  for (const Scored& s : {at_a, at_b})
    if (s.score > best.score) best = s;
  return best;
}

constexpr std::size_t kSamples = 12;  // of a circle that limits divide less often

}  // namespace

// The swivel angle with the largest margin: of each interval between limits the middle, then up from the best of these.
SphericalArm::Scored SphericalArm::best_swivel(const Elbow& e) const noexcept {
  const double infinity = std::numeric_limits<double>::infinity();
  const SwivelAngles angles = limit_angles(e);
  Scored best;
  double width = 2 * std::numbers::pi / kSamples;
  const auto consider = [&](double psi, double room) {
    const Scored s = score(e, psi, best.score);
    if (s.score <= best.score) return;
    best = s;
    width = std::min(room, 2 * std::numbers::pi / kSamples);
  };
  visit_between(angles, [&](double low, double high) { consider(0.5 * (low + high), 0.5 * (high - low)); });
  if (angles.size() < kSamples)
    for (std::size_t i = 0; i < kSamples; ++i)
      consider(2 * std::numbers::pi * static_cast<double>(i) / kSamples, std::numbers::pi);
  if (best.score < 0)  // an interval of one angle alone, where limits touch
    for (std::size_t i = 0; i < angles.size(); ++i) consider(angles[i], 0);
  if (best.score < -rounding_ || width == 0) return best;
  return climb([&](double psi) { return score(e, psi, -infinity); }, best, best.psi - width, best.psi + width);
}

std::optional<SphericalArm::Answer> SphericalArm::solve(const Pose& T) const noexcept {
  std::optional<Elbow> chosen;
  Scored best;
  double best_total = -std::numeric_limits<double>::infinity();
  for (const double sign : {1.0, -1.0}) {
    const auto e = elbow(T, sign);
    // The margin of a joint that the swivel does not move would level all others: it has a say, not the last word.
    const auto total = [&](double score) { return std::min(score, e->margin) + 0.25 * score; };
    if (!e || total(1.0) <= best_total) continue;  // no score exceeds 1
    const Scored here = best_swivel(*e);
    if (here.score < -rounding_ || total(here.score) <= best_total) continue;
    best = here;
    best_total = total(here.score);
    chosen = e;
  }
  if (!chosen) return std::nullopt;
  return Answer{joints(*chosen, best.psi, best.shoulder, best.wrist), std::min(best.score, chosen->margin)};
}

std::optional<SphericalArm::Answer> SphericalArm::solve_on(const Pose& T, std::size_t branch,
                                                           double psi) const noexcept {
  const auto e = elbow(T, branch & 4 ? -1 : 1);
  if (!e) return std::nullopt;
  const Scored there = score_on(*e, psi, static_cast<BallSide>(branch & 1), static_cast<BallSide>(branch >> 1 & 1));
  if (there.score < -rounding_) return std::nullopt;
  return Answer{joints(*e, psi, there.shoulder, there.wrist), std::min(there.score, e->margin)};
}

SwivelSamples SphericalArm::swivels(const Pose& T, std::size_t branch) const noexcept {
  SwivelSamples samples;
  const auto e = elbow(T, branch & 4 ? -1 : 1);
  if (!e) return samples;
  visit_between(limit_angles(*e), [&](double from, double to) {
    const double middle = 0.5 * (from + to);
    if (score_on(*e, middle, static_cast<BallSide>(branch & 1), static_cast<BallSide>(branch >> 1 & 1)).score <
        -rounding_)
      return;
    const int steps = std::max(2, static_cast<int>(std::ceil((to - from) * kSamples / (2 * std::numbers::pi))));
    for (int k = 0; k <= steps; ++k) samples.add({from + (to - from) * k / steps, k > 0});
  });
  return samples;
}

// The swivel angle that turns R0 nearest to the last shoulder: the largest trace(R_last' rot(n, psi) R0).
double SphericalArm::nearest_swivel(const Elbow& e, const Eigen::Matrix3d& R_last) {
  const Eigen::Matrix3d M = e.R0 * R_last.transpose();
  const double c = M.trace() - e.n.dot(M * e.n);
  const double s = e.n.dot(Eigen::Vector3d(M(1, 2) - M(2, 1), M(2, 0) - M(0, 2), M(0, 1) - M(1, 0)));
  return std::atan2(s, c);
}

std::optional<SphericalArm::Answer> SphericalArm::solve_near(const Pose& T, const JointVector& last,
                                                             double swivel) const noexcept {
  const Eigen::Matrix3d R_last = shoulder_.rotation({last[0], last[1], last[2]});
  std::optional<Elbow> chosen;
  Scored best;
  double nearest = std::numeric_limits<double>::infinity(), low = 0, high = 0;
  for (const double sign : {1.0, -1.0}) {
    const auto e = elbow(T, sign);
    if (!e) continue;
    const SwivelAngles angles = limit_angles(*e);
    const double wanted = nearest_swivel(*e, R_last);
    for (std::size_t branch = 0; branch < 4; ++branch) {
      const auto i = static_cast<BallSide>(branch % 2), k = static_cast<BallSide>(branch / 2);
      const auto consider = [&](double psi, double from, double to) {
        const Scored at = score_on(*e, psi, i, k);
        if (at.score < -rounding_) return false;
        const double far = (turned_towards(last, joints(*e, psi, i, k)) - last).cwiseAbs().maxCoeff();
        if (far >= nearest) return true;
        nearest = far;
        best = at;
        chosen = e;
        low = from;
        high = to;
        return true;
      };
      // In the last joints' own interval; only where that is closed, in the others, at their ends nearest to it.
      bool inside = false;
      visit_between(angles, [&](double from, double to) {
        const double psi = nearest_turn(wanted, 0.5 * (from + to));
        if (psi >= from && psi <= to) inside |= consider(psi, from, to);
      });
      if (inside) continue;
      visit_between(angles, [&](double from, double to) {
        if (score_on(*e, 0.5 * (from + to), i, k).score >= 0)
          consider(std::clamp(nearest_turn(wanted, 0.5 * (from + to)), from, to), from, to);
      });
      for (std::size_t a = 0; a < angles.size() && !chosen; ++a) consider(angles[a], angles[a], angles[a]);
    }
  }
  if (!chosen) return std::nullopt;
  best.psi = nearest_turn(best.psi, 0.5 * (low + high));
  if (swivel > 0 && high > low)
    best = climb([&](double psi) { return score_on(*chosen, psi, best.shoulder, best.wrist); }, best,
                 std::max(low, best.psi - swivel), std::min(high, best.psi + swivel));
  return Answer{turned_towards(last, joints(*chosen, best.psi, best.shoulder, best.wrist)),
                std::min(best.score, chosen->margin)};
}

JointVector SphericalArm::turned_towards(const JointVector& last, JointVector q) const noexcept {
  for (Eigen::Index i = 0; i < 7; ++i) {
    const double turned = nearest_turn(q[i], last[i]);
    if (turned >= lower_limit_[i] && turned <= upper_limit_[i]) q[i] = turned;
  }
  return q;
}

Pose SphericalArm::pulled_within_reach(const Pose& T) const noexcept {
  const Eigen::Vector3d to_wrist = T * W_in_tip_ - S_;
  const double distance = to_wrist.norm();
  const auto [shortest, longest] = distances_within_limits();
  const double wanted = std::clamp(distance, shortest, longest);
  Pose pulled = T;
  const Eigen::Vector3d n = distance > 1e-9 ? Eigen::Vector3d(to_wrist / distance) : Eigen::Vector3d::UnitZ();
  pulled.translation() += (wanted - distance) * n;
  return pulled;
}

std::array<double, 2> SphericalArm::distances_within_limits() const noexcept {
  const double shortest = distance_at(q4_longest_ + std::numbers::pi), longest = distance_at(q4_longest_);
  if (!std::isfinite(lower_limit_[3]) || !std::isfinite(upper_limit_[3])) return {shortest, longest};
  const double middle = 0.5 * (lower_limit_[3] + upper_limit_[3]), half = upper_limit_[3] - middle;
  const auto passes = [&](double q4) { return std::abs(nearest_turn(q4, middle) - middle) <= half; };
  const double a = distance_at(lower_limit_[3]), b = distance_at(upper_limit_[3]);
  return {passes(q4_longest_ + std::numbers::pi) ? shortest : std::min(a, b),
          passes(q4_longest_) ? longest : std::max(a, b)};
}

}  // namespace foresight
