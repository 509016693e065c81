// Boxes and balls as meshes, and a hand of two jaws that goes up and down.
#pragma once

#include <cmath>
#include <numbers>

#include "dynamics/thing_world.hpp"

namespace foresight {

/// Closed, outward, with its middle at `middle`.
inline Mesh box_mesh(const Eigen::Vector3f& size, const Eigen::Vector3f& middle = {0, 0, 0}) {
  Mesh out;
  for (int i = 0; i < 8; ++i)
    out.vertices.push_back(middle + 0.5f * Eigen::Vector3f(i & 1 ? size.x() : -size.x(), i & 2 ? size.y() : -size.y(),
                                                           i & 4 ? size.z() : -size.z()));
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

inline Mesh ball_mesh(float radius) {
  constexpr int kRings = 12, kSides = 16;
  Mesh out;
  out.vertices.push_back({0, 0, -radius});
  for (int r = 1; r < kRings; ++r)
    for (int s = 0; s < kSides; ++s) {
      const float a = std::numbers::pi_v<float> * static_cast<float>(r) / kRings,
                  b = 2 * std::numbers::pi_v<float> * static_cast<float>(s) / kSides;
      out.vertices.push_back(radius *
                             Eigen::Vector3f(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), -std::cos(a)));
    }
  out.vertices.push_back({0, 0, radius});
  const auto at = [](int r, int s) { return static_cast<std::uint32_t>(1 + (r - 1) * kSides + s % kSides); };
  const auto last = static_cast<std::uint32_t>(out.vertices.size() - 1);
  for (int s = 0; s < kSides; ++s) {
    out.triangles.push_back({0, at(1, s + 1), at(1, s)});
    for (int r = 1; r + 1 < kRings; ++r) {
      out.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
      out.triangles.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
    }
    out.triangles.push_back({at(kRings - 1, s), at(kRings - 1, s + 1), last});
  }
  return out;
}

inline Mesh both(Mesh a, const Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

inline Pose lifted(double x, double y, double z) {
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(x, y, z);
  return out;
}

/// A table (part 0, its top at 0), a hand of two jaws along y (parts 1 and 2), then the things. Joints: "grip", each
/// jaw's way from the middle (with `one_jaw` the first one's alone), and "height", "along" of the hand.
class HandWorld {
 public:
  explicit HandWorld(std::vector<WorldPart> things, ThingWorldOptions options = {}, bool one_jaw = false)
      : one_jaw_(one_jaw) {
    parts_.push_back({box_mesh({1, 1, 0.1f}, {0, 0, -0.05f}), PartRole::still, Pose::Identity(), 0, {.friction = 0.9}});
    for (int side : {1, -1})
      parts_.push_back({box_mesh({0.02f, 0.01f, 0.06f}, {0, 0.005f * static_cast<float>(side), 0}),
                        PartRole::driven,
                        Pose::Identity(),
                        0,
                        {}});
    parts_.insert(parts_.end(), things.begin(), things.end());
    options.jaws = {"grip"};
    world_ = std::make_unique<ThingWorld>(parts_, poses(), options, joints());
  }
  double grip = 0.04, height = 0.03, along = 0;

  JointPositions joints() const {
    return [this](std::string_view name) -> std::optional<double> {
      return name == "grip" ? grip : name == "height" ? height : name == "along" ? along : 0;
    };
  }
  /// Moves what it refers to evenly to `to`.
  void move(double& what, double to, double seconds) {
    const double from = what;
    const int steps = static_cast<int>(std::lround(seconds / world_->seconds_per_step()));
    for (int i = 1; i <= steps; ++i) {
      what = from + (to - from) * i / steps;
      world_->step(joints());
    }
  }
  void wait(double seconds) { move(height, height, seconds); }
  ThingWorld& world() { return *world_; }
  Eigen::Vector3d place(std::size_t thing) const { return world_->motion(3 + thing).T_world_body.translation(); }

 private:
  PartPoses poses() const {
    return [n = parts_.size(), one = one_jaw_](const JointPositions& q) {
      std::vector<Pose> out(n, Pose::Identity());
      out[1] = lifted(*q("along"), *q("grip"), *q("height"));
      out[2] = lifted(*q("along"), one ? -0.0225 : -*q("grip"), *q("height"));
      return out;
    };
  }
  const bool one_jaw_;
  std::vector<WorldPart> parts_;
  std::unique_ptr<ThingWorld> world_;
};

}  // namespace foresight
