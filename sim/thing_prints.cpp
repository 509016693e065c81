#include "sim/thing_prints.hpp"

#include <algorithm>
#include <iterator>

#include "sim/painter.hpp"

namespace foresight::sim::prints {
namespace {

constexpr std::uint32_t kShells[] = {0xd3d5d3, 0xc9ccd6, 0xdad2c4, 0xc4d0ca}, kInk = 0x2a2e35, kSeam = 0x868b91;
constexpr std::uint32_t kAccents[] = {0xe0792b, 0x2b7fb3, 0x3f8f5a, 0xb0413e, 0x7a5aa6};

void screw(Painter& p, double x, double y) {
  p.disc(x, y, 0.0034, kSeam);
  p.disc(x, y, 0.0026, 0x55595f);
  p.line(x - 0.0016, y - 0.0010, x + 0.0016, y + 0.0010, 0.0007, 0xb8bcc0);
}

// One panel of the print, w by h, in one of four ways.
void panel(Painter& p, double x, double y, double w, double h, std::size_t kind, std::uint32_t accent,
           const std::string& label, std::uint32_t seed) {
  switch (kind) {
    case 0: {
      const double size = std::min(0.30 * h, 1.1 * w / static_cast<double>(std::max<std::size_t>(label.size(), 4)));
      p.text(x + 0.08 * w, y + 0.45 * h, size, 0.14 * size, kInk, label);
      p.rectangle(x + 0.08 * w, y + 0.55 * h, 0.55 * w, 0.0022, accent);
      p.small_print(x + 0.08 * w, y + 0.62 * h, 0.50 * w, 0.22 * h, 0.0048, 0x5f666e, seed);
      p.disc(x + 0.82 * w, y + 0.72 * h, 0.0048, accent);
      break;
    }
    case 1:
      p.rectangle(x + 0.10 * w, y + 0.14 * h, 0.80 * w, 0.20 * h, accent);
      for (int k = 0; k < 9; ++k)
        p.line(x + (0.12 + 0.085 * k) * w, y + 0.44 * h, x + (0.12 + 0.085 * k) * w, y + (k % 3 ? 0.54 : 0.62) * h,
               0.0008, kInk);
      p.bar_code(x + 0.14 * w, y + 0.70 * h, 0.45 * w, 0.18 * h, seed);
      p.ring(x + 0.80 * w, y + 0.78 * h, 0.0060, 0.0012, kInk);
      break;
    case 2:
      for (int k = 0; k < 4; ++k)  // a warning's stripes
        p.polygon({{x + (0.10 + 0.21 * k) * w, y + 0.30 * h},
                   {x + (0.20 + 0.21 * k) * w, y + 0.10 * h},
                   {x + (0.30 + 0.21 * k) * w, y + 0.10 * h},
                   {x + (0.20 + 0.21 * k) * w, y + 0.30 * h}},
                  k % 2 ? accent : kInk);
      p.small_print(x + 0.10 * w, y + 0.44 * h, 0.36 * w, 0.40 * h, 0.0046, 0x5f666e, seed + 3);
      p.frame(x + 0.58 * w, y + 0.46 * h, 0.30 * w, 0.36 * h, 0.0012, kInk);
      p.disc(x + 0.73 * w, y + 0.64 * h, 0.0075, accent);
      break;
    default:
      p.ring(x + 0.30 * w, y + 0.34 * h, 0.0120, 0.0016, kSeam);
      p.ring(x + 0.30 * w, y + 0.34 * h, 0.0060, 0.0024, accent);
      p.polygon({{x + 0.62 * w, y + 0.48 * h}, {x + 0.74 * w, y + 0.20 * h}, {x + 0.86 * w, y + 0.48 * h}}, kInk);
      p.grid(x + 0.12 * w, y + 0.64 * h, 0.76 * w, 0.22 * h, 0.0065, 0.0007, kSeam);
  }
}

}  // namespace

cv::Mat thing(double side, double texel, const std::string& label, std::size_t number, std::uint32_t seed) {
  constexpr std::size_t kPanels = 3;  // along each side
  Painter p(side, side, texel, kShells[number % std::size(kShells)]);
  const double w = side / kPanels;
  for (std::size_t j = 0; j < kPanels; ++j)
    for (std::size_t i = 0; i < kPanels; ++i) {
      const double x = w * static_cast<double>(i), y = w * static_cast<double>(j);
      const std::size_t kind = (i + 2 * j + number + (i * j) % 3) % 4;
      panel(p, x, y, w, w, kind, kAccents[(number + i + j) % std::size(kAccents)], label,
            seed + static_cast<std::uint32_t>(11 * i + 7 * j));
      p.line(x, y, x + w, y, 0.0009, kSeam);
      p.line(x, y, x, y + w, 0.0009, kSeam);
      for (const double v : {0.06, 0.94}) screw(p, x + 0.06 * w, y + v * w);
    }
  p.modulate([&](double x, double y) {
    return 0.04 * fractal_noise(static_cast<float>(x * 22), static_cast<float>(y * 22), 3, seed) +
           0.03 * noise(static_cast<float>(x * 700), static_cast<float>(y * 700), seed + 5);
  });
  return p.picture();
}

}  // namespace foresight::sim::prints
