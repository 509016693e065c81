// Lines, marks and wire meshes in the world that are to be seen over a view: plain values, made on the CPU.
//
// Everything becomes strokes so short that a lens bends none of them visibly.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct OverlayStyle {
  Eigen::Vector3f colour{1, 1, 1};  ///< 0 .. 1
  float width_px = 2;               ///< of the target's pixels
  float dash = 0;                   ///< m, of a dash and the gap after it together; 0: a whole line
  float opacity = 1;                ///< 0 .. 1
};

/// Part of a line: straight, at most kLongestStroke long.
struct OverlayStroke {
  Eigen::Vector3f a, b;  ///< world, m
  float along = 0;       ///< m, from the line's begin to `a`
  bool begins = false, ends = false;
  OverlayStyle style;
};

/// Edges of a mesh at which it bends, or ends: what tells its shape. In the mesh's frame, m.
struct WireMesh {
  std::vector<std::array<Eigen::Vector3f, 2>> edges;
};
/// `bend`: rad, from which on an edge between two triangles counts.
WireMesh wire_of(const Mesh& mesh, double bend = 0.6);

/// Strokes of one picture. Points that are not finite draw nothing; beyond kMostStrokes, nothing more is taken.
class OverlayLines {
 public:
  static constexpr double kLongestStroke = 0.02;  ///< m
  static constexpr std::size_t kMostStrokes = 20'000;

  void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const OverlayStyle& style);
  void polyline(std::span<const Eigen::Vector3d> points, const OverlayStyle& style);
  void dot(const Eigen::Vector3d& at, const OverlayStyle& style);
  /// `size`: m, from end to end.
  void cross(const Eigen::Vector3d& at, const Pose& T_world_axes, double size, const OverlayStyle& style);
  /// A part of a circle about `axis` (unit), from `begin` on; `angle` rad, signed.
  void arc(const Eigen::Vector3d& center, const Eigen::Vector3d& axis, const Eigen::Vector3d& begin, double angle,
           const OverlayStyle& style);
  void ring(const Eigen::Vector3d& center, const Eigen::Vector3d& axis, double radius, const OverlayStyle& style);
  void wire(const WireMesh& mesh, const Pose& T_world_mesh, const OverlayStyle& style);

  const std::vector<OverlayStroke>& strokes() const { return strokes_; }
  bool empty() const { return strokes_.empty(); }

 private:
  void piece(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double along, bool begins, bool ends,
             const OverlayStyle& style);

  std::vector<OverlayStroke> strokes_;
};

}  // namespace foresight
