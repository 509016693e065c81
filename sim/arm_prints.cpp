#include "sim/arm_prints.hpp"

#include <algorithm>

#include "sim/painter.hpp"

namespace foresight::sim::prints {
namespace {

constexpr std::uint32_t kShell = 0xd3d5d3, kMarking = 0x2a2e35, kSeam = 0x8e9296, kWarning = 0xe9b93a,
                        kAlert = 0xc8432f;

void screw(Painter& p, double x, double y) {
  p.disc(x, y, 0.0034, kSeam);
  p.disc(x, y, 0.0026, 0x55595f);
  p.line(x - 0.0016, y - 0.0010, x + 0.0016, y + 0.0010, 0.0007, 0xb8bcc0);
}

// A triangle that warns of the hand being squeezed, or so.
void warning(Painter& p, double x, double y, double s) {
  p.polygon({{x - s, y + 0.8 * s}, {x, y - s}, {x + s, y + 0.8 * s}}, kMarking);
  p.polygon({{x - 0.72 * s, y + 0.64 * s}, {x, y - 0.66 * s}, {x + 0.72 * s, y + 0.64 * s}}, kWarning);
  p.rectangle(x - 0.09 * s, y - 0.25 * s, 0.18 * s, 0.5 * s, kMarking);
  p.rectangle(x - 0.09 * s, y + 0.36 * s, 0.18 * s, 0.16 * s, kMarking);
}

// Broad unevenness and the grain of the paint.
void wear(Painter& p, std::uint32_t seed) {
  p.modulate([&](double x, double y) {
    return 0.03 * fractal_noise(static_cast<float>(x * 22), static_cast<float>(y * 22), 3, seed) +
           0.025 * noise(static_cast<float>(x * 700), static_cast<float>(y * 700), seed + 5);
  });
}

}  // namespace

cv::Mat arm_cover(double length, double height, double texel, const std::string& label, std::uint32_t ring,
                  std::uint32_t seed) {
  Painter p(length, height, texel, kShell);
  p.rectangle(0, 0.006, length, 0.009, ring);
  p.line(0, 0.019, length, 0.019, 0.0009, kSeam);
  for (int i = 0; i < 2; ++i) {
    const double x = 0.5 * length * i, w = 0.5 * length, h = height - 0.020;
    const double size = std::min(0.13 * w, 0.42 * w / static_cast<double>(label.size()));
    p.line(x + 0.003, 0.019, x + 0.003, height, 0.0009, kSeam);
    p.text(x + 0.14 * w, 0.020 + 0.42 * h, size, 0.15 * size, kMarking, label);
    p.rectangle(x + 0.14 * w, 0.020 + 0.50 * h, 0.30 * w, 0.0022, ring);
    p.small_print(x + 0.14 * w, 0.020 + 0.56 * h, 0.34 * w, 0.16 * h, 0.0048, 0x5f666e, seed + 7 * i);
    if (i == 0)
      warning(p, x + 0.74 * w, 0.020 + 0.36 * h, 0.07 * w);
    else
      p.bar_code(x + 0.60 * w, 0.020 + 0.22 * h, 0.30 * w, 0.20 * h, seed);
    p.polygon({{x + 0.70 * w, 0.020 + 0.72 * h}, {x + 0.74 * w, 0.020 + 0.65 * h}, {x + 0.78 * w, 0.020 + 0.72 * h}},
              kAlert);
    for (double v : {0.10, 0.88})
      for (double u : {0.06, 0.95}) screw(p, x + u * w, 0.020 + v * h);
    for (int k = 0; k < 12; ++k)  // a scale that shows the joint's angle
      p.line(x + (k + 0.5) * w / 12, height - (k % 3 ? 0.004 : 0.008), x + (k + 0.5) * w / 12, height, 0.0008,
             kMarking);
  }
  wear(p, seed);
  return p.picture();
}

// Seen through its mirror image at the lower end: no letters.
cv::Mat arm_ball(double length, double height, double texel, std::uint32_t ring, std::uint32_t seed) {
  Painter p(length, height, texel, kShell);
  p.line(0, 0.30 * height, length, 0.30 * height, 0.0009, kSeam);
  p.rectangle(0, 0.36 * height, length, 0.004, ring);
  for (int i = 0; i < 4; ++i) {
    const double x = (i + 0.5) * length / 4;
    p.line(x - 0.12 * length, 0.30 * height, x - 0.12 * length, height, 0.0009, kSeam);
    screw(p, x - 0.05 * length, 0.48 * height);
    screw(p, x + 0.05 * length, 0.48 * height);
    p.disc(x, 0.62 * height, 0.0045, i % 2 ? kAlert : kMarking);
    for (int k = 0; k < 9; ++k)
      p.line(x + (k - 4) * 0.020 * length, 0.16 * height, x + (k - 4) * 0.020 * length, (k % 4 ? 0.22 : 0.26) * height,
             0.0008, kMarking);
  }
  wear(p, seed);
  return p.picture();
}

}  // namespace foresight::sim::prints
