#include "tests/texture_gpu/reference/edges.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::reference {
namespace {

constexpr double kRounding = 1e-6;  // of float, share of the 1/z around

/// Of three values, one of which decides only where the others do not.
Answer either(Answer a, Answer b) {
  if (a == Answer::yes || b == Answer::yes) return Answer::yes;
  return a == Answer::no && b == Answer::no ? Answer::no : Answer::borderline;
}
Answer sign(double value, double rounding) {
  return value > rounding ? Answer::yes : value < -rounding ? Answer::no : Answer::borderline;
}

class Picture {
 public:
  Picture(const FacePicture& face, double tolerance) : face_(face), tolerance_(tolerance) {}
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < face_.width && y < face_.height; }
  /// 0 where there is no model, and outside.
  double at(int x, int y) const {
    return inside(x, y) ? face_.inverse_z[static_cast<std::size_t>(y * face_.width + x)] : 0;
  }

  /// Is there more than the tolerance between the depths 1 / near and 1 / far? Beyond its horizon a
  /// plane (far <= 0) is behind everything.
  Answer in_front(double near, double far, double scale) const {
    far = std::max(far, 0.0);
    return sign(near - far - tolerance_ * near * far, kRounding * scale);
  }

  /// Does the surface of (x, y) end towards (dx, dy), before another one?
  Answer ends(int x, int y, int dx, int dy) const {
    const double here = at(x, y), beyond = at(x + dx, y + dy), next = at(x + 2 * dx, y + 2 * dy);
    if (here <= 0 || beyond <= 0 || beyond >= here) return Answer::no;
    if (next > 0) return in_front(here, 2 * beyond - next, 2 * (here + next));
    const double before = at(x - dx, y - dy);
    return in_front(before > 0 ? 2 * here - before : here, beyond, 2 * (here + before));
  }
  Answer ends(int x, int y) const {
    return either(either(ends(x, y, 1, 0), ends(x, y, -1, 0)), either(ends(x, y, 0, 1), ends(x, y, 0, -1)));
  }

  /// The slope of 1/z along (dx, dy) with which the surface of (x, y) goes on: that of the side on
  /// which it bends less, none where it is not a plane. Several where rounding decides.
  std::vector<double> slopes(int x, int y, int dx, int dy) const {
    const double here = at(x, y);
    struct Side {
      double bend = 1e30, slope = 0;
    };
    const auto side = [&](int s) -> Side {
      const double one = at(x + s * dx, y + s * dy), two = at(x + 2 * s * dx, y + 2 * s * dy);
      return {one > 0 && two > 0 ? std::abs(two - 2 * one + here) : 1e30, s * (one - here)};
    };
    const Side a = side(-1), b = side(1);
    if (std::min(a.bend, b.bend) > 1e29) return {0};
    std::vector<double> out;
    for (const Side& s : {a, b}) {
      if (s.bend > std::min(a.bend, b.bend) + 4 * kRounding * here) continue;
      const double ahead = std::abs(at(x + 2 * dx, y + 2 * dy) - here - 2 * s.slope),
                   back = std::abs(at(x - 2 * dx, y - 2 * dy) - here + 2 * s.slope);
      const Answer curved = sign(std::min(ahead, back) - tolerance_ * here * here, 4 * kRounding * here);
      if (curved != Answer::yes) out.push_back(s.slope);
      if (curved != Answer::no) out.push_back(0);
    }
    return out;
  }

 private:
  const FacePicture& face_;
  double tolerance_;
};

}  // namespace

std::vector<Answer> uncertain_edges(const FacePicture& face, double margin, double tolerance) {
  const Picture picture(face, tolerance);
  const int reach = static_cast<int>(std::ceil(margin)) + 1;
  std::vector<Answer> out(face.inverse_z.size(), Answer::no);
  for (int y = 0; y < face.height; ++y)
    for (int x = 0; x < face.width; ++x) {
      const Answer edge = picture.ends(x, y);
      if (edge == Answer::no) continue;
      const double here = picture.at(x, y);
      const auto along_u = picture.slopes(x, y, 1, 0), along_v = picture.slopes(x, y, 0, 1);
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const double far = picture.at(x + dx, y + dy);
          if (far <= 0 || dx * dx + dy * dy > (margin + 0.5) * (margin + 0.5)) continue;
          int yes = 0, no = 0;
          for (double u : along_u)
            for (double v : along_v) {
              // The surface goes on as a plane, but never closer than where it ends.
              const double near = std::min(here, here + u * dx + v * dy);
              const double scale = here * (1 + std::abs(dx) + std::abs(dy));
              const Answer behind = sign(near - far - tolerance * near * far, kRounding * scale);
              yes += behind == Answer::yes;
              no += behind == Answer::no;
            }
          const int all = static_cast<int>(along_u.size() * along_v.size());
          if (no == all) continue;
          Answer& answer = out[static_cast<std::size_t>((y + dy) * face.width + x + dx)];
          answer = either(answer, yes == all ? edge : Answer::borderline);
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
