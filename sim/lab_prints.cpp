#include "sim/lab_prints.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "sim/painter.hpp"

namespace foresight::sim::prints {
namespace {

constexpr std::uint32_t kPaper = 0xf1eee4, kInk = 0x22242a, kRed = 0xc8432f, kBlue = 0x2f5f9e, kTeal = 0x2b7f78,
                        kYellow = 0xe9b93a;

float f(double x) {
  return static_cast<float>(x);
}

// Fine speckle and broad unevenness that every real surface has.
void roughen(Painter& p, double strength, std::uint32_t seed) {
  p.modulate([&](double x, double y) {
    return strength * (0.7 * fractal_noise(f(x * 14), f(y * 14), 3, seed) +
                       0.5 * noise(f(x * 450), f(y * 450), seed + 5) + 0.5 * noise(f(x * 1100), f(y * 1100), seed + 9));
  });
}

// The side view of a small arm: base, two links, gripper.
void arm_drawing(Painter& p, double x, double y, double s, std::uint32_t colour, std::uint32_t accent) {
  const cv::Point2d base(x, y), shoulder(x, y - 0.30 * s), elbow(x + 0.28 * s, y - 0.78 * s),
      wrist(x + 0.80 * s, y - 0.62 * s), tip(x + 0.92 * s, y - 0.36 * s);
  p.polygon({{x - 0.2 * s, y}, {x + 0.2 * s, y}, {x + 0.11 * s, y - 0.2 * s}, {x - 0.11 * s, y - 0.2 * s}}, colour);
  const auto link = [&](cv::Point2d a, cv::Point2d b, double w) { p.line(a.x, a.y, b.x, b.y, w * s, colour); };
  link(base, shoulder, 0.12);
  link(shoulder, elbow, 0.11);
  link(elbow, wrist, 0.09);
  link(wrist, tip, 0.06);
  link(tip, tip + cv::Point2d(-0.06 * s, 0.12 * s), 0.03);
  link(tip, tip + cv::Point2d(0.08 * s, 0.10 * s), 0.03);
  for (const auto& joint : {shoulder, elbow, wrist}) {
    p.disc(joint.x, joint.y, 0.085 * s, accent);
    p.disc(joint.x, joint.y, 0.035 * s, kPaper);
  }
}

}  // namespace

cv::Mat wood(double width, double height, double texel, std::uint32_t light, std::uint32_t dark, double plank,
             std::uint32_t seed) {
  Painter p(width, height, texel, light);
  cv::Mat picture = p.picture();
  const cv::Scalar a = rgb(light), b = rgb(dark);
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column) {
      // The grain runs along x; y crosses the planks.
      const float x = f((column + 0.5) * texel), y = f((row + 0.5) * texel);
      const float board = std::floor(y / f(plank)), across = y - board * f(plank);
      const auto s = seed + 101 * static_cast<std::uint32_t>(board);
      const float bend = 0.030f * fractal_noise(x * 1.6f + board * 7, y * 3.5f, 3, s);
      const float ring = (across + bend) * 62 + 3 * noise(x * 0.7f, board * 3, s);
      const float saw = ring - std::floor(ring);
      const float rings = saw < 0.8f ? saw / 0.8f : (1 - saw) / 0.2f;  // slow summer growth, abrupt winter edge
      const float fibre = noise(x * 22, y * 1500, s + 3), pores = noise(x * 60, y * 2600, s + 4);
      float t = 0.10f + 0.38f * rings * rings + 0.16f * fibre + (pores > 0.62f ? 0.22f : 0.0f) +
                0.22f * noise(board * 5.3f, 1.5f, seed) + 0.20f * fractal_noise(x * 4, y * 9, 2, s + 8);
      const float seam = std::min(across, f(plank) - across);
      if (seam < 0.0009f) t += 0.75f * (1 - seam / 0.0009f);
      t = std::clamp(t, 0.0f, 1.25f);
      for (int c = 0; c < 3; ++c)
        picture.at<cv::Vec3b>(row, column)[c] = cv::saturate_cast<std::uint8_t>(a[c] + t * (b[c] - a[c]));
    }
  return picture;
}

cv::Mat plain(double width, double height, double texel, std::uint32_t colour, double roughness, std::uint32_t seed) {
  Painter p(width, height, texel, colour);
  roughen(p, roughness, seed);
  return p.picture();
}

cv::Mat floor_tiles(double texel, std::uint32_t seed) {
  Painter p(2, 2, texel, 0x8b9096);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) p.rectangle(0.5 * i, 0.5 * j, 0.5, 0.5, (i + j) % 2 ? 0x858a91 : 0x92979c);
  p.grid(0, 0, 2, 2, 0.5, 0.004, 0x5f646a);
  roughen(p, 0.10, seed);
  return p.picture();
}

cv::Mat cutting_mat(double texel, std::uint32_t seed) {
  Painter p(0.60, 0.42, texel, 0x1f6b57);
  constexpr std::uint32_t kFine = 0x3d8672, kLine = 0xa9cfae;
  p.grid(0.03, 0.03, 0.54, 0.36, 0.005, 0.0004, kFine);
  p.grid(0.03, 0.03, 0.54, 0.36, 0.03, 0.0008, kLine);
  p.frame(0.03, 0.03, 0.54, 0.36, 0.0016, kLine);
  for (int i = 0; i <= 18; ++i) {
    p.text(0.026 + 0.03 * i, 0.023, 0.007, 0.0008, kLine, std::to_string(3 * i));
    p.text(0.026 + 0.03 * i, 0.405, 0.007, 0.0008, kLine, std::to_string(3 * i));
  }
  for (int i = 0; i <= 12; ++i) {
    p.text(0.010, 0.0335 + 0.03 * i, 0.007, 0.0008, kLine, std::to_string(36 - 3 * i));
    p.text(0.576, 0.0335 + 0.03 * i, 0.007, 0.0008, kLine, std::to_string(36 - 3 * i));
  }
  for (double r : {0.06, 0.12, 0.18}) p.ring(0.30, 0.21, r, 0.0008, kLine);
  p.line(0.03, 0.39, 0.39, 0.03, 0.0007, kLine);
  p.line(0.21, 0.39, 0.57, 0.03, 0.0007, kLine);
  p.text(0.44, 0.375, 0.012, 0.0014, kLine, "LAB MAT A2");
  roughen(p, 0.10, seed);
  return p.picture();
}

cv::Mat cardboard(double width, double height, double texel, bool label, std::uint32_t seed) {
  Painter p(width, height, texel, 0xb58a5c);
  p.modulate([&](double x, double y) {  // flutes and recycled fibres
    return 0.035 * std::sin(x * 2 * 3.14159265 / 0.0042) + 0.08 * fractal_noise(f(x * 30), f(y * 9), 3, seed) +
           0.06 * noise(f(x * 260), f(y * 900), seed + 2) + 0.05 * noise(f(x * 1200), f(y * 1200), seed + 3);
  });
  if (!label) {
    p.rectangle(0.5 * width - 0.024, 0, 0.048, height, 0xcdb185);  // tape
    p.line(0.5 * width, 0, 0.5 * width, height, 0.0012, 0x8a6840);
    for (double x : {-0.024, 0.024}) p.line(0.5 * width + x, 0, 0.5 * width + x, height, 0.0007, 0xe0c9a4);
    return p.picture();
  }
  const double lx = 0.30 * width, ly = 0.16 * height, lw = 0.58 * width, lh = 0.58 * height;
  p.rectangle(lx, ly, lw, lh, kPaper);
  p.rectangle(lx, ly, lw, 0.030, kInk);
  p.text(lx + 0.007, ly + 0.022, 0.013, 0.0020, kPaper, "FORESIGHT LAB");
  p.small_print(lx + 0.007, ly + 0.038, 0.55 * lw, 0.26 * lh, 0.0055, kInk, seed);
  p.bar_code(lx + 0.007, ly + 0.66 * lh, 0.60 * lw, 0.30 * lh, seed);
  p.text(lx + 0.685 * lw, ly + 0.90 * lh, 0.023, 0.0036, kRed, "42");
  p.frame(lx + 0.66 * lw, ly + 0.66 * lh, 0.30 * lw, 0.30 * lh, 0.0012, kInk);
  for (double x : {0.08, 0.18}) {  // this side up
    const double ax = x * width, ay = 0.58 * height;
    p.polygon({{ax - 0.012, ay - 0.020}, {ax, ay - 0.042}, {ax + 0.012, ay - 0.020}}, kInk);
    p.rectangle(ax - 0.005, ay - 0.021, 0.010, 0.036, kInk);
  }
  p.rectangle(0.04 * width, 0.70 * height, 0.19 * width, 0.004, kInk);
  p.text(0.04 * width, 0.92 * height, 0.014, 0.0022, kInk, "HANDLE WITH CARE");
  return p.picture();
}

cv::Mat product_front(double texel, std::uint32_t seed) {
  Painter p(0.12, 0.21, texel, kBlue);
  for (int i = 0; i < 7; ++i)
    p.polygon({{0, 0.092 + 0.012 * i}, {0.12, 0.062 + 0.012 * i}, {0.12, 0.067 + 0.012 * i}, {0, 0.097 + 0.012 * i}},
              i % 2 ? 0x3e74b8 : kYellow);
  p.rectangle(0.010, 0.012, 0.100, 0.046, kPaper);
  p.text(0.016, 0.033, 0.0145, 0.0026, kBlue, "SERVO");
  p.text(0.016, 0.051, 0.0105, 0.0016, kRed, "KIT  7-DOF");
  p.disc(0.060, 0.128, 0.036, kPaper);
  arm_drawing(p, 0.047, 0.150, 0.040, kInk, kRed);
  p.rectangle(0, 0.178, 0.12, 0.032, 0x16335c);
  p.small_print(0.010, 0.184, 0.058, 0.022, 0.0045, 0xb7c6dc, seed);
  p.bar_code(0.076, 0.182, 0.038, 0.023, seed);
  roughen(p, 0.04, seed);
  return p.picture();
}

cv::Mat product_side(double texel, std::uint32_t seed) {
  Painter p(0.09, 0.21, texel, 0x2a568f);
  p.rectangle(0.008, 0.012, 0.074, 0.110, 0xdfe6ee);
  p.text(0.013, 0.026, 0.008, 0.0012, kBlue, "CONTENTS");
  p.small_print(0.013, 0.034, 0.062, 0.080, 0.0050, 0x3a4452, seed);
  for (int i = 0; i < 5; ++i) p.rectangle(0.008, 0.134 + 0.012 * i, 0.014 + 0.012 * ((i * 3) % 5), 0.007, kYellow);
  roughen(p, 0.04, seed);
  return p.picture();
}

cv::Mat poster(double texel, std::uint32_t seed) {
  Painter p(0.62, 0.44, texel, kPaper);
  p.rectangle(0, 0, 0.62, 0.085, 0x1d3d5c);
  p.text(0.022, 0.054, 0.026, 0.0042, kPaper, "SEE IT BEFORE IT ARRIVES");
  p.rectangle(0.022, 0.105, 0.270, 0.225, 0xdbe5ea);
  p.grid(0.022, 0.105, 0.270, 0.225, 0.015, 0.0006, 0xb9cad4);
  arm_drawing(p, 0.090, 0.315, 0.170, 0x2c4a63, kRed);
  p.rectangle(0.205, 0.285, 0.040, 0.030, kYellow);
  p.line(0.022, 0.317, 0.292, 0.317, 0.004, kInk);
  p.line(0.330, 0.330, 0.330, 0.115, 0.0020, kInk);  // a plot
  p.line(0.330, 0.330, 0.590, 0.330, 0.0020, kInk);
  p.grid(0.330, 0.130, 0.250, 0.200, 0.025, 0.0005, 0xc9ccc8);
  for (int k = 0; k < 2; ++k) {
    const auto curve = [k](double x) {
      return k ? 0.30 - 0.62 * x + 0.02 * std::sin(40 * x) : 0.17 + 0.45 * x * x * 4;
    };
    for (double x = 0; x < 0.245; x += 0.007)
      p.line(0.330 + x, curve(x), 0.337 + x, curve(x + 0.007), 0.0034, k ? kTeal : kRed);
  }
  p.text(0.345, 0.125, 0.010, 0.0014, kInk, "error / delay");
  for (int column = 0; column < 3; ++column)
    p.small_print(0.022 + 0.200 * column, 0.350, 0.175, 0.072, 0.0085, 0x4b5158, seed + column);
  roughen(p, 0.03, seed);
  return p.picture();
}

cv::Mat pegboard(double texel, std::uint32_t seed) {
  Painter p(0.70, 0.44, texel, 0xc9b48f);
  for (double y = 0.0125; y < 0.44; y += 0.025)
    for (double x = 0.0125; x < 0.70; x += 0.025) p.disc(x, y, 0.0030, 0x4f4331);
  const auto outline = [&](double x, double y, double w, double h, std::uint32_t colour) {
    p.rectangle(x, y, w, h, colour);
    p.disc(x + w / 2, y, w / 2, colour);
    p.disc(x + w / 2, y + h, w / 2, colour);
  };
  for (int i = 0; i < 4; ++i) {  // screwdrivers, their blades and handles
    const double x = 0.075 + 0.060 * i;
    outline(x, 0.090, 0.022, 0.085 - 0.008 * i, i % 2 ? kRed : kYellow);
    p.rectangle(x + 0.008, 0.190 - 0.008 * i, 0.006, 0.110, 0x70757b);
  }
  outline(0.345, 0.080, 0.018, 0.250, 0x59606a);  // a spanner
  p.disc(0.354, 0.080, 0.026, 0x59606a);
  p.disc(0.354, 0.068, 0.012, 0xc9b48f);
  p.ring(0.354, 0.335, 0.019, 0.012, 0x59606a);
  p.ring(0.500, 0.160, 0.062, 0.016, kTeal);  // a coil of cable
  p.ring(0.500, 0.160, 0.042, 0.004, 0x1c544f);
  p.rectangle(0.590, 0.090, 0.080, 0.120, kPaper);
  p.small_print(0.598, 0.100, 0.064, 0.100, 0.0085, kInk, seed);
  roughen(p, 0.07, seed);
  return p.picture();
}

cv::Mat graph_paper(double texel, std::uint32_t seed) {
  Painter p(0.21, 0.297, texel, 0xf6f4ec);
  p.grid(0.010, 0.012, 0.190, 0.270, 0.005, 0.0004, 0xbcd2e0);
  p.grid(0.010, 0.012, 0.190, 0.270, 0.025, 0.0008, 0x86aeca);
  const auto curve = [](double x) { return 0.150 - 0.055 * std::sin(x * 48) * std::exp(-x * 7); };
  for (double x = 0.012; x < 0.190; x += 0.003) p.line(x, curve(x), x + 0.003, curve(x + 0.003), 0.0014, 0x23407e);
  p.line(0.012, 0.150, 0.198, 0.150, 0.0010, kInk);
  p.line(0.012, 0.070, 0.012, 0.230, 0.0010, kInk);
  p.text(0.030, 0.045, 0.011, 0.0013, 0x23407e, "step response");
  p.text(0.100, 0.225, 0.008, 0.0010, kRed, "T = 131 ms");
  p.small_print(0.030, 0.245, 0.140, 0.030, 0.0075, 0x55617a, seed);
  return p.picture();
}

cv::Mat can_wrap(double texel, double length, double height, std::uint32_t seed) {
  Painter p(length, height, texel, kRed);
  p.rectangle(0, 0, length, 0.010, 0xb9bcc0);
  p.rectangle(0, height - 0.008, length, 0.008, 0xb9bcc0);
  for (int i = 0; i < 2; ++i) {
    const double x = 0.5 * length * i;
    p.polygon({{x + 0.004, 0.052}, {x + 0.45 * length, 0.026}, {x + 0.45 * length, 0.066}, {x + 0.004, 0.088}}, kPaper);
    p.text(x + 0.012, 0.070, 0.014, 0.0028, kRed, "GREASE");
    p.small_print(x + 0.012, 0.094, 0.070, 0.012, 0.0045, 0xf0d6cf, seed + i);
    p.text(x + 0.012, 0.026, 0.008, 0.0012, kYellow, "No. 5");
  }
  roughen(p, 0.04, seed);
  return p.picture();
}

cv::Mat mug_wrap(double texel, double length, double height, std::uint32_t seed) {
  Painter p(length, height, texel, 0x2b6f8f);
  p.rectangle(0, 0.020, length, 0.005, kPaper);
  p.rectangle(0, height - 0.024, length, 0.005, kPaper);
  for (int i = 0; i < 9; ++i) {
    const double x = length * (i + 0.5) / 9, y = 0.5 * height;
    p.polygon({{x - 0.010, y}, {x, y - 0.014}, {x + 0.010, y}, {x, y + 0.014}}, i % 3 ? kPaper : kYellow);
    p.disc(x, y, 0.0035, 0x2b6f8f);
  }
  roughen(p, 0.03, seed);
  return p.picture();
}

cv::Mat bottle_wrap(double texel, double length, double height, std::uint32_t seed) {
  Painter p(length, height, texel, 0x3f6f3d);
  p.rectangle(0, 0, length, 0.026, 0x26282c);  // cap
  for (double x = 0; x < length; x += 0.003) p.line(x, 0.002, x, 0.024, 0.0008, 0x3a3d42);
  const double top = height - 0.115;
  p.rectangle(0, top, length, 0.090, 0xf3efe0);
  p.rectangle(0, top, length, 0.004, kTeal);
  p.rectangle(0, top + 0.086, length, 0.004, kTeal);
  for (int i = 0; i < 2; ++i) {
    const double x = 0.5 * length * i;
    p.text(x + 0.012, top + 0.032, 0.014, 0.0024, kTeal, "ISO-P");
    p.text(x + 0.012, top + 0.046, 0.006, 0.0009, kInk, "70 % / 500 ml");
    p.small_print(x + 0.012, top + 0.053, 0.052, 0.028, 0.0048, 0x4b5158, seed + i);
    p.polygon({{x + 0.088, top + 0.050}, {x + 0.100, top + 0.028}, {x + 0.112, top + 0.050}}, kYellow);
  }
  roughen(p, 0.03, seed);
  return p.picture();
}

cv::Mat book_spine(double width, double height, double texel, std::uint32_t colour, std::uint32_t seed) {
  Painter p(height, width, texel, colour);  // drawn lying, turned at the end
  p.rectangle(0.012, 0, 0.003, width, kPaper);
  p.rectangle(height - 0.020, 0, 0.006, width, kYellow);
  constexpr const char* kTitles[] = {"ROBOT CONTROL", "OPTICS", "KINEMATICS", "LINEAR ALGEBRA", "SIGNALS", "VISION"};
  p.text(0.026, 0.5 * width + 0.005, 0.010, 0.0015, kPaper, kTitles[seed % 6]);
  roughen(p, 0.06, seed);
  cv::Mat turned;
  cv::rotate(p.picture(), turned, cv::ROTATE_90_CLOCKWISE);
  return turned;
}

cv::Mat letter_block(double size, double texel, std::uint32_t colour, char letter, std::uint32_t seed) {
  cv::Mat picture = wood(size, size, texel, 0xe3c79c, 0xb98d56, 1.0, seed);
  Painter p(size, size, texel, 0);
  picture.copyTo(p.picture());
  p.frame(0.10 * size, 0.10 * size, 0.80 * size, 0.80 * size, 0.07 * size, colour);
  p.text(0.33 * size, 0.70 * size, 0.42 * size, 0.07 * size, colour, std::string(1, letter));
  return p.picture();
}

}  // namespace foresight::sim::prints
