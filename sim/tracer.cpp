#include "sim/tracer.hpp"

#include <algorithm>
#include <numeric>

namespace foresight::sim {
namespace {

constexpr int kLeafSize = 4;

Eigen::AlignedBox3f box_of(const Triangle& t) {
  Eigen::AlignedBox3f box(t[0]);
  box.extend(t[1]);
  box.extend(t[2]);
  return box;
}

constexpr float kFar = 1e30f;  // the idle lane of a box spans everything

bool enters(const Eigen::Array4f& low, const Eigen::Array4f& high, const Eigen::Array4f& origin,
            const Eigen::Array4f& inverse, float t_max) {
  const Eigen::Array4f a = (low - origin) * inverse, b = (high - origin) * inverse;
  const float near = a.min(b).maxCoeff(), far = a.max(b).minCoeff();
  return far >= std::max(near, 0.0f) && near < t_max;
}

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

Tracer::Tracer(std::vector<Triangle> triangles) : triangles_(std::move(triangles)), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(order_.size()));
}

void Tracer::build(int begin, int end) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3f box, centres;
  for (int i = begin; i < end; ++i) {
    const auto b = box_of(triangles_[order_[i]]);
    box.extend(b);
    centres.extend(b.center());
  }
  nodes_[index].low << box.min(), -kFar;
  nodes_[index].high << box.max(), kFar;
  if (end - begin <= kLeafSize) {
    nodes_[index].first = begin;
    nodes_[index].count = end - begin;
    return;
  }
  const int middle = split(begin, end, centres);
  build(begin, middle);
  nodes_[index].first = static_cast<int>(nodes_.size());
  build(middle, end);
}

// Cuts where the boxes' areas, weighed by their triangles, are smallest (surface area heuristic),
// over kBins places along the longest side; halves where all centres coincide.
int Tracer::split(int begin, int end, const Eigen::AlignedBox3f& centres) {
  constexpr int kBins = 16;
  int axis = 0;
  const float length = centres.sizes().maxCoeff(&axis);
  const auto bin_of = [&](int triangle) {
    const float place = (box_of(triangles_[triangle]).center()[axis] - centres.min()[axis]) / length;
    return std::min(static_cast<int>(place * kBins), kBins - 1);
  };
  int best_bin = 0;
  float lowest = std::numeric_limits<float>::infinity();
  for (int bin = 1; bin < kBins && length > 0; ++bin) {
    std::array<Eigen::AlignedBox3f, 2> boxes;
    std::array<int, 2> counts{};
    for (int i = begin; i < end; ++i) {
      const int side = bin_of(order_[i]) >= bin;
      boxes[side].extend(box_of(triangles_[order_[i]]));
      ++counts[side];
    }
    if (!counts[0] || !counts[1]) continue;
    const auto cost = [&](int side) {
      const Eigen::Vector3f s = boxes[side].sizes();
      return static_cast<float>(counts[side]) * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
    };
    if (cost(0) + cost(1) < lowest) {
      lowest = cost(0) + cost(1);
      best_bin = bin;
    }
  }
  if (best_bin == 0) return (begin + end) / 2;
  const auto middle = std::stable_partition(order_.begin() + begin, order_.begin() + end,
                                            [&](int triangle) { return bin_of(triangle) < best_bin; });
  return static_cast<int>(middle - order_.begin());
}

template <bool kAny>
std::optional<Hit> Tracer::walk(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max) const {
  Eigen::Array4f from, inverse;
  from << origin, 0;
  inverse << direction.cwiseInverse(), 1;
  std::optional<Hit> best;
  std::array<int, 64> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int index = stack[--depth];
    const BoxNode& node = nodes_[index];
    if (!enters(node.low, node.high, from, inverse, t_max)) continue;
    for (int i = node.first; i < node.first + node.count; ++i) {
      Hit hit;
      if (!intersect(triangles_[order_[i]], origin, direction, t_max, hit)) continue;
      hit.triangle = order_[i];
      t_max = hit.t;
      best = hit;
      if (kAny) return best;
    }
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
    }
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
