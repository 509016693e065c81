// Light in the lab: a lamp of finite size, daylight from all around, and one bounce.
//
// Irradiance is kept on a triangular grid over each facet and interpolated in between:
//
//   corner 0 --- i (towards corner 1) --->    sample (i, j), i + j <= n, lies at
//      |                                      barycentric b1 = i / n, b2 = j / n
//      j (towards corner 2)
//      v
//
// The still scene is computed once. For each frame only the moving plate's own samples and the
// ones in its reach are computed again: which of the lamp's points each sample sees is remembered.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/lab.hpp"
#include "sim/tracer.hpp"

namespace foresight::sim {

/// Immutable once built; safe to share between threads. Facets are numbered through all parts
/// in order, the plate's included.
class LightMap {
 public:
  /// Irradiance (linear RGB; a white surface of 1 shows as 1 / pi) of every sample.
  using Irradiance = std::vector<Eigen::Vector3f>;

  /// Uses all cores. `coarser` multiplies the distance between samples. `lab` must outlive this.
  /// `poll`, which may be empty, is called now and then from all threads; what it throws stops the work.
  LightMap(const Lab& lab, double coarser, const std::function<void()>& poll = {});

  /// The light while the plate stands at `T_world_plate`. One thread.
  Irradiance with_plate_at(const Pose& T_world_plate) const;

  Eigen::Vector3f at(const Irradiance& irradiance, int facet, float b1, float b2) const;

  /// Strength in 0 .. 1 of the lamp's mirror image at `p` for a viewer in `to_eye` (world frame).
  static float mirrored_lamp(const Eigen::Vector3f& p, const Eigen::Vector3f& n, const Eigen::Vector3f& to_eye);

  std::size_t sample_count() const { return samples_.size(); }

 private:
  struct Sample {
    Eigen::Vector3f p;  // world; node frame on the plate
    Eigen::Vector3f n;  // for shading
    Eigen::Vector3f g;  // of the triangle
  };
  struct Grid {
    int first = 0, n = 1;
    int index(int i, int j) const { return first + j * (n + 1) - j * (j - 1) / 2 + i; }
  };
  struct Gather {
    Eigen::Vector3f light = Eigen::Vector3f::Zero();
    bool inside = false;  // within a solid: most rays meet a surface from behind
  };
  void add_part(const Part& part, const Pose& T, double coarser);
  std::uint64_t lamp_points_seen(const Sample& s) const;
  Gather gather(const Sample& s, int rays, const Tracer* plate, const Eigen::Isometry3f& T_plate_world) const;
  void fill(const Grid& grid, std::vector<std::uint8_t>& unusable, Irradiance& irradiance) const;
  void light_plate(const Eigen::Isometry3f& T_world_plate, Irradiance& out) const;
  void shade_surroundings(const Eigen::Isometry3f& T_world_plate, Irradiance& out) const;

  std::vector<Grid> grids_;              // one per facet
  std::vector<Eigen::Vector3f> albedo_;  // one per facet, mean
  std::vector<Sample> samples_;
  std::vector<int> still_facets_;        // facet of each of the still tracer's triangles
  int plate_first_ = 0, plate_end_ = 0;  // the plate's facets
  std::vector<Tracer> tracers_;          // still scene, plate (node frame)
  std::vector<std::uint64_t> seen_;      // lamp points that a still sample sees, one bit each
  Irradiance direct_, ambient_;
  std::vector<std::uint8_t> inside_;
};

}  // namespace foresight::sim
