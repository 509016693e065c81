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
  int axis = 0;
  centres.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
    const float ca = box_of(triangles_[a]).center()[axis], cb = box_of(triangles_[b]).center()[axis];
    return ca != cb ? ca < cb : a < b;
  });
  build(begin, middle);
  nodes_[index].first = static_cast<int>(nodes_.size());
  build(middle, end);
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
