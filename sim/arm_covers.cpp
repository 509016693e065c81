#include "sim/arm_covers.hpp"

#include <numbers>

#include "sim/arm.hpp"
#include "sim/arm_prints.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector3f;

constexpr double kLightStep = 0.05;
constexpr std::uint32_t kOrange = 0xe0792b, kBlue = 0x2b7fb3;

class Covers {
 public:
  explicit Covers(LabBuilder& builder)
      : b_(builder),
        dark_(b_.plain(0x3a3f46, 0.05, 0.03f)),
        steel_(b_.plain(0x9aa1a8, 0.05, 0.05f)),
        shell_(b_.plain(0xd3d5d3, 0.03, 0.03f)),
        orange_(b_.plain(kOrange, 0.04, 0.03f)),
        blue_(b_.plain(kBlue, 0.04, 0.03f)) {}

  void stand(Facets& f) {
    const int cover = wrap(0.085f, 0.15f, "7-DOF", kOrange);
    add_turned(f,
               {{0, 0, dark_},
                {0.17f, 0, dark_},
                {0.17f, 0.018f, dark_},
                {0.050f, 0.050f, dark_},
                {0.050f, 0.77f, shell_},
                {0.085f, 0.80f, cover},
                {0.085f, 0.925f, dark_},
                {0.070f, 0.95f, dark_},
                {0, 0.95f, dark_}},
               16, 0.085f, 0.95f);
  }

  // A post that ends in a ball of `ball` around the next joint at `top`.
  void post(Facets& f, float radius, float neck, float ball, float top, const char* label, std::uint32_t ring,
            int segments) {
    const float below = top - 0.75f * ball, height = below + 0.001f;
    const int cover = wrap(radius, height, label, ring);
    const double around = 2 * std::numbers::pi * radius, ball_height = top + ball - below;
    const int sphere = b_.material(
        [=](double t, unsigned s) { return prints::arm_ball(around, ball_height, t, ring, s); }, 0.8, 0.03f);
    add_turned(f,
               {{0, 0, dark_},
                {radius, 0, cover},
                {radius, 0.35f * below, cover},
                {neck, below, sphere},
                {ball, top, sphere},
                {0.80f * ball, top + 0.60f * ball, sphere},
                {0.42f * ball, top + 0.91f * ball, sphere},
                {0, top + ball, sphere}},
               segments, radius, below);
  }

  // A drum across the joint, its caps showing on both sides, and a tube that leaves the ball before it.
  void elbow(Facets& f, float drum, float half_width, float radius, float start, float top, const char* label,
             std::uint32_t ring, int cap, int segments) {
    const float w = half_width, r = drum;
    add_turned(
        f, {{0, -w, dark_}, {0.45f * r, -w, cap}, {r, -w, dark_}, {r, w, cap}, {0.45f * r, w, dark_}, {0, w, dark_}},
        14, r, w);
    Eigen::Isometry3f T = Eigen::Isometry3f::Identity();
    T.rotate(Eigen::AngleAxisf(-std::numbers::pi_v<float> / 2, Vector3f::UnitX()));  // z becomes y
    transform(f, 0, T);
    const int cover = wrap(radius, top - start, label, ring);
    add_turned(f, {{0, start, dark_}, {0.94f * radius, start, cover}, {radius, top, dark_}, {0, top, dark_}}, segments,
               radius, top);
  }

  void hand(Facets& f) {
    add_turned(
        f, {{0, 0, steel_}, {0.038f, 0, orange_}, {0.038f, 0.010f, dark_}, {0.030f, 0.022f, dark_}, {0, 0.022f, dark_}},
        14, 0.038f, 0.022f);
    BoxPaint palm = BoxPaint::all(shell_);
    palm.top = dark_;
    palm.left = palm.right = dark_;
    palm.front = palm.back = wrap_flat(0.12f, 0.036f);
    add_box(f, {0, 0, 0.020f}, {0.056f, 0.12f, 0.036f}, 0, palm);
  }

  void finger(Facets& f, float side) {
    BoxPaint paint = BoxPaint::all(dark_);
    add_box(f, {0, side * 0.011f, 0}, {0.034f, 0.020f, 0.022f}, 0, paint);
    BoxPaint tip = BoxPaint::all(steel_);
    tip.top = orange_;
    add_box(f, {0, side * 0.006f, 0.020f}, {0.020f, 0.011f, 0.075f}, 0, tip);
  }

  int orange() const { return orange_; }
  int blue() const { return blue_; }

 private:
  int wrap(float radius, float height, const std::string& label, std::uint32_t ring) {
    const double around = 2 * std::numbers::pi * radius;
    return b_.material([=](double t, unsigned s) { return prints::arm_cover(around, height, t, label, ring, s); }, 0.8,
                       0.03f);
  }
  int wrap_flat(float width, float height) {
    return b_.material([=](double t, unsigned s) { return prints::arm_cover(width, height, t, "G2", kBlue, s); }, 0.8,
                       0.03f);
  }

  LabBuilder& b_;
  int dark_, steel_, shell_, orange_, blue_;
};

}  // namespace

void add_arm(LabBuilder& builder) {
  Covers covers(builder);
  const auto rest = arm_links_at({});
  covers.stand(builder.part(kArmStand, rest[0], 0.02));
  const auto link = [&](std::size_t i) -> Facets& {
    return builder.part(arm_joints()[i - 1].child, rest[i], kLightStep, true);
  };
  covers.post(link(1), 0.070f, 0.066f, 0.072f, 0.14f, "S1", kOrange, 14);
  covers.elbow(link(2), 0.050f, 0.080f, 0.054f, 0.045f, 0.18f, "UPPER", kBlue, covers.orange(), 14);
  covers.post(link(3), 0.054f, 0.048f, 0.058f, 0.18f, "A3", kOrange, 14);
  covers.elbow(link(4), 0.040f, 0.066f, 0.046f, 0.035f, 0.17f, "LOWER", kBlue, covers.blue(), 14);
  covers.post(link(5), 0.046f, 0.039f, 0.048f, 0.17f, "A5", kOrange, 14);
  covers.elbow(link(6), 0.033f, 0.055f, 0.038f, 0.028f, 0.05f, "W", kBlue, covers.orange(), 12);
  covers.hand(link(7));
  covers.finger(link(8), 1);
  covers.finger(link(9), -1);
}

}  // namespace foresight::sim
