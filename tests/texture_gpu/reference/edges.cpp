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
Answer negation(Answer a) {
  return a == Answer::yes ? Answer::no : a == Answer::no ? Answer::yes : a;
}
Answer both(Answer a, Answer b) {
  return negation(either(negation(a), negation(b)));
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
  /// Does the surface end towards (-dx, -dy) within four pixels of (x, y)?
  Answer ends_behind(int x, int y, int dx, int dy) const {
    Answer out = Answer::no;
    for (int k = 0; k < 4; ++k) out = either(out, ends(x - k * dx, y - k * dy, -dx, -dy));
    return out;
  }
  /// The slope of 1/z with which the surface of (x, y) goes on towards (dx, dy): its own as far as it
  /// is seen, else that of the plane before, none where there is no plane. Several where rounding decides.
  std::vector<double> slopes(int x, int y, int dx, int dy) const {
    const double here = at(x, y), bent = tolerance_ * here * here, rounding = 4 * kRounding * here;
    const double a1 = at(x + dx, y + dy), a2 = at(x + 2 * dx, y + 2 * dy);
    const double b1 = at(x - dx, y - dy), b2 = at(x - 2 * dx, y - 2 * dy);
    std::vector<double> out;
    const Answer ends = a1 > 0 && a2 > 0 ? sign(std::abs(a2 - 2 * a1 + here) - bent, rounding) : Answer::yes;
    if (ends != Answer::yes) out.push_back(a1 - here);
    if (ends == Answer::no) return out;
    const double slope = here - b1, bend = std::abs(b2 - 2 * b1 + here);
    const Answer curved =
        b1 > 0 && b2 > 0 ? sign(bend - std::min(bent, 0.25 * std::abs(slope)), rounding) : Answer::yes;
    if (curved != Answer::yes) out.push_back(slope);
    if (curved != Answer::no) out.push_back(0);
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
      const Answer ends_right = picture.ends(x, y, 1, 0), ends_left = picture.ends(x, y, -1, 0),
                   ends_down = picture.ends(x, y, 0, 1), ends_up = picture.ends(x, y, 0, -1);
      const Answer any_edge = either(either(ends_right, ends_left), either(ends_down, ends_up));
      if (any_edge == Answer::no) continue;
      const Answer thin = either(
          either(both(ends_right, picture.ends_behind(x, y, 1, 0)), both(ends_left, picture.ends_behind(x, y, -1, 0))),
          either(both(ends_down, picture.ends_behind(x, y, 0, 1)), both(ends_up, picture.ends_behind(x, y, 0, -1))));
      Answer hides = Answer::no;
      const double here = picture.at(x, y);
      const auto right = picture.slopes(x, y, 1, 0), left = picture.slopes(x, y, -1, 0),
                 down = picture.slopes(x, y, 0, 1), up = picture.slopes(x, y, 0, -1);
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const double far = picture.at(x + dx, y + dy);
          if (far <= 0 || dx * dx + dy * dy > (margin + 0.5) * (margin + 0.5)) continue;
          // Only to the sides on which the surface ends.
          const Answer edge = either(std::abs(dx) < std::abs(dy) || dx == 0 ? Answer::no
                                     : dx > 0                               ? ends_right
                                                                            : ends_left,
                                     std::abs(dy) < std::abs(dx) || dy == 0 ? Answer::no
                                     : dy > 0                               ? ends_down
                                                                            : ends_up);
          if (edge == Answer::no) continue;
          int yes = 0, no = 0;
          const auto &along_u = dx < 0 ? left : right, &along_v = dy < 0 ? up : down;
          for (double u : along_u)
            for (double v : along_v) {
              // Never closer than where it ends.
              const double near = std::min(here, here + u * std::abs(dx) + v * std::abs(dy));
              const double scale = here * (1 + std::abs(dx) + std::abs(dy));
              const Answer behind = sign(near - far - tolerance * near * far, kRounding * scale);
              yes += behind == Answer::yes;
              no += behind == Answer::no;
            }
          const int all = static_cast<int>(along_u.size() * along_v.size());
          if (no == all) continue;
          Answer& answer = out[static_cast<std::size_t>((y + dy) * face.width + x + dx)];
          const Answer behind = yes == all ? edge : Answer::borderline;
          answer = either(answer, behind);
          hides = either(hides, behind);
        }
      Answer& own = out[static_cast<std::size_t>(y * face.width + x)];
      own = either(own, both(hides, negation(thin)));
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
