#include "tests/texture_gpu/reference/edges.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::reference {
namespace {

struct Slope {
  double value = 0;
  bool ambiguous = false;  // both sides bend alike, but differ
};

class Picture {
 public:
  explicit Picture(const FacePicture& face) : face_(face) {}
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < face_.width && y < face_.height; }
  /// 0 where there is no model, and outside.
  double at(int x, int y) const {
    return inside(x, y) ? face_.inverse_z[static_cast<std::size_t>(y * face_.width + x)] : 0;
  }

  Slope slope(int x, int y, int dx, int dy) const {
    const double here = at(x, y);
    const auto side = [&](int s) {
      const double one = at(x + s * dx, y + s * dy), two = at(x + 2 * s * dx, y + 2 * s * dy);
      return std::pair(one > 0 && two > 0 ? std::abs(two - 2 * one + here) : 1e30, s * (one - here));
    };
    const auto [bend_a, slope_a] = side(-1);
    const auto [bend_b, slope_b] = side(1);
    if (std::min(bend_a, bend_b) > 1e29) return {};
    const bool alike = std::abs(bend_a - bend_b) < 2e-6 * here && std::abs(slope_a - slope_b) > 2e-6 * here;
    return {bend_a < bend_b ? slope_a : slope_b, alike};
  }

 private:
  const FacePicture& face_;
};

}  // namespace

std::vector<Answer> uncertain_edges(const FacePicture& face, double margin, double tolerance) {
  const Picture picture(face);
  const int reach = static_cast<int>(std::ceil(margin)) + 1;
  std::vector<Answer> out;
  for (int y = 0; y < face.height; ++y) {
    for (int x = 0; x < face.width; ++x) {
      const double here = picture.at(x, y);
      const Slope u = picture.slope(x, y, 1, 0), v = picture.slope(x, y, 0, 1);
      Answer answer = Answer::no;
      for (int dy = -reach; dy <= reach && here > 0; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const double near = picture.at(x + dx, y + dy);
          if (near <= 0 || dx * dx + dy * dy > (margin + 0.5) * (margin + 0.5)) continue;
          const double plane = here + u.value * dx + v.value * dy;
          // Beyond its horizon a plane is behind everything.
          const double in_front = plane > 0 ? 1 / plane - 1 / near : 1e30;
          const double rounding = 3e-6 * here * (1 + std::abs(dx) + std::abs(dy)) / std::max(plane * near, 1e-9);
          if (in_front > tolerance + rounding)
            answer = Answer::yes;
          else if (in_front > tolerance - rounding && answer == Answer::no)
            answer = Answer::borderline;
        }
      }
      if (here > 0 && (u.ambiguous || v.ambiguous)) answer = Answer::borderline;
      out.push_back(answer);
    }
  }
  return out;
}

std::vector<Block> depth_blocks(const FacePicture& face) {
  const int columns = (face.width + 3) / 4, rows = (face.height + 3) / 4;
  std::vector<Block> blocks(static_cast<std::size_t>(columns * rows));
  for (int y = 0; y < face.height; ++y)
    for (int x = 0; x < face.width; ++x) {
      Block& block = blocks[static_cast<std::size_t>(y / 4 * columns + x / 4)];
      const double value = face.inverse_z[static_cast<std::size_t>(y * face.width + x)];
      block.has_hole |= value == 0;
      if (value > 0) block.least = std::min(block.least, value);
      block.largest = std::max(block.largest, value);
    }
  return blocks;
}

}  // namespace foresight::reference
