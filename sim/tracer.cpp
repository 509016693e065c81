#include "sim/tracer.hpp"

#include <algorithm>
#include <numeric>
#include <ranges>

namespace foresight::sim {
namespace {

constexpr int kLeafSize = 4;
constexpr float kMissed = std::numeric_limits<float>::infinity();

// Moeller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection", 1997.
bool intersect(const Triangle& t, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max,
               Hit& hit) {
  const Eigen::Vector3f e1 = t[1] - t[0], e2 = t[2] - t[0];
  const Eigen::Vector3f p = direction.cross(e2);
  const float det = e1.dot(p);
  if (det == 0) return false;
  const float inverse = 1 / det;
  const Eigen::Vector3f s = origin - t[0];
  const float b1 = s.dot(p) * inverse;
  if (b1 < 0 || b1 > 1) return false;
  const Eigen::Vector3f q = s.cross(e1);
  const float b2 = direction.dot(q) * inverse;
  if (b2 < 0 || b1 + b2 > 1) return false;
  const float distance = e2.dot(q) * inverse;
  if (!(distance > 0 && distance < t_max)) return false;
  hit.t = distance;
  hit.b1 = b1;
  hit.b2 = b2;
  return true;
}

}  // namespace

/// What is the same for all boxes that a ray meets.
struct Tracer::Ray {
  Eigen::Vector3f origin, inverse;

  /// How far along the ray the box begins, 0 from inside; kMissed where it lies beside the ray or beyond `t_max`.
  float enters(const BoxNode& node, float t_max) const {
    float near = 0, far = t_max;
    for (int k = 0; k < 3; ++k) {
      const float a = (node.low[k] - origin[k]) * inverse[k], b = (node.high[k] - origin[k]) * inverse[k];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far && near < t_max ? near : kMissed;
  }
};

Tracer::Tracer(std::vector<Triangle> triangles) : triangles_(std::move(triangles)), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Box> boxes;
  boxes.reserve(triangles_.size());
  for (const Triangle& t : triangles_) {
    Eigen::AlignedBox3f box(t[0]);
    box.extend(t[1]);
    box.extend(t[2]);
    boxes.push_back({box, box.center()});
  }
  if (!boxes.empty()) build(boxes, 0, static_cast<int>(order_.size()));
}

void Tracer::build(const std::vector<Box>& boxes, int begin, int end) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3f box, centres;
  for (int i = begin; i < end; ++i) {
    box.extend(boxes[order_[i]].box);
    centres.extend(boxes[order_[i]].centre);
  }
  nodes_[index].low = box.min();
  nodes_[index].high = box.max();
  if (end - begin <= kLeafSize) {
    nodes_[index].first = begin;
    nodes_[index].count = end - begin;
    return;
  }
  const int middle = split(boxes, begin, end, centres);
  build(boxes, begin, middle);
  nodes_[index].first = static_cast<int>(nodes_.size());
  build(boxes, middle, end);
}

// Cuts where the boxes' areas, weighed by their triangles, are smallest (surface area heuristic),
// over kBins places along the longest side; halves where all centres coincide.
int Tracer::split(const std::vector<Box>& boxes, int begin, int end, const Eigen::AlignedBox3f& centres) {
  constexpr int kBins = 16;
  int axis = 0;
  const float length = centres.sizes().maxCoeff(&axis);
  if (!(length > 0)) return (begin + end) / 2;
  const auto bin_of = [&](int triangle) {
    const float place = (boxes[triangle].centre[axis] - centres.min()[axis]) / length;
    return std::min(static_cast<int>(place * kBins), kBins - 1);
  };
  struct Bin {
    Eigen::AlignedBox3f box;
    int count = 0;

    void take(const Bin& other) {
      box.extend(other.box);
      count += other.count;
    }
    float cost() const {
      const Eigen::Vector3f s = box.sizes();
      return static_cast<float>(count) * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
    }
  };
  std::array<Bin, kBins> bins;
  for (int i = begin; i < end; ++i) bins[bin_of(order_[i])].take({boxes[order_[i]].box, 1});
  std::array<Bin, kBins> above;  // this bin and all behind it
  for (int bin = kBins - 1; bin > 0; --bin) {
    above[bin] = bins[bin];
    if (bin + 1 < kBins) above[bin].take(above[bin + 1]);
  }
  int best_bin = 0;
  float lowest = std::numeric_limits<float>::infinity();
  for (Bin below = bins[0]; int bin : std::views::iota(1, kBins)) {
    if (below.count && above[bin].count && below.cost() + above[bin].cost() < lowest) {
      lowest = below.cost() + above[bin].cost();
      best_bin = bin;
    }
    below.take(bins[bin]);
  }
  if (best_bin == 0) return (begin + end) / 2;
  const auto middle = std::stable_partition(order_.begin() + begin, order_.begin() + end,
                                            [&](int triangle) { return bin_of(triangle) < best_bin; });
  return static_cast<int>(middle - order_.begin());
}

// The nearer of two boxes first: what is hit in it often hides the other.
template <bool kAny>
std::optional<Hit> Tracer::walk(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max) const {
  struct Entry {
    int node;
    float near;
  };
  const Ray ray{origin, direction.cwiseInverse()};
  std::optional<Hit> best;
  std::array<Entry, 64> stack;
  int depth = 0;
  const auto push = [&](int node, float near) {
    if (near < t_max) stack[depth++] = {node, near};
  };
  if (!nodes_.empty()) push(0, ray.enters(nodes_[0], t_max));
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.near >= t_max) continue;
    const BoxNode& node = nodes_[entry.node];
    for (int i = node.first; i < node.first + node.count; ++i) {
      Hit hit;
      if (!intersect(triangles_[order_[i]], origin, direction, t_max, hit)) continue;
      hit.triangle = order_[i];
      t_max = hit.t;
      best = hit;
      if (kAny) return best;
    }
    if (node.count > 0) continue;
    const int left = entry.node + 1, right = node.first;
    const float to_left = ray.enters(nodes_[left], t_max), to_right = ray.enters(nodes_[right], t_max);
    const bool left_first = to_left <= to_right;
    push(left_first ? right : left, std::max(to_left, to_right));
    push(left_first ? left : right, std::min(to_left, to_right));
  }
  return best;
}

std::optional<Hit> Tracer::nearest(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max) const {
  return walk<false>(origin, direction, t_max);
}

bool Tracer::blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max) const {
  return walk<true>(origin, direction, t_max).has_value();
}

}  // namespace foresight::sim
