// Light in the lab: a lamp of finite size, daylight from all around, and one bounce.
//
// Irradiance is kept on a triangular grid over each facet and interpolated in between:
//
//   corner 0 --- i (towards corner 1) --->    sample (i, j), i + j <= n, lies at
//      |                                      barycentric b1 = i / n, b2 = j / n
//      j (towards corner 2)
//      v
//
// Grids share the samples where they meet on a smooth surface. What stands still is lit once. For a
// state of the lab only the samples on moving parts, in their shadow and near them are computed:
// which of the lamp's points each still sample sees is remembered.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/lab.hpp"
#include "sim/occluder.hpp"
#include "sim/tracer.hpp"

namespace foresight::sim {

/// Immutable once built; safe to share between threads. Facets are numbered through all parts in
/// order, the moving ones included.
class LightMap {
 public:
  /// Irradiance (linear RGB; a white surface of 1 shows as 1 / pi) of every sample.
  using Irradiance = std::vector<Eigen::Vector3f>;

  /// Uses all cores. `coarser` multiplies the distance between samples. `lab` must outlive this.
  /// `poll`, which may be empty, is called now and then from all threads; what it throws stops the work.
  LightMap(const Lab& lab, double coarser, const std::function<void()>& poll = {});

  /// The light while the parts stand at `T_world_part`. One thread. `quicker`, 1 .. 8: takes so much less care of the
  /// daylight around what moves; the lamp's shadows are the same.
  Irradiance lit(const LabState& T_world_part, int quicker = 1) const;

  /// Irradiance on a facet at barycentric weights of its corners 1 and 2.
  Eigen::Vector3f at(const Irradiance& irradiance, int facet, float b1, float b2) const;

  /// Steps of the grid along each side of a facet: samples lie at barycentric weights i / steps, j / steps.
  int steps(int facet) const { return grids_[static_cast<std::size_t>(facet)].n; }

  std::size_t sample_count() const { return samples_.size(); }

 private:
  struct Sample {
    Eigen::Vector3f p;  // world; node frame on a moving part
    Eigen::Vector3f n;  // for shading
    Eigen::Vector3f g;  // of the triangle; n where several share the sample
  };
  struct Grid {
    int first = 0, n = 1;  // of grid_samples_
    int size() const { return (n + 1) * (n + 2) / 2; }
    int place(int i, int j) const { return first + j * (n + 1) - j * (j - 1) / 2 + i; }
  };
  struct Range {  // of one part
    int part = 0, first_sample = 0, end_sample = 0, first_facet = 0, end_facet = 0;
  };
  struct Movers;
  struct Gather {
    Eigen::Vector3f light = Eigen::Vector3f::Zero();
    bool inside = false;  // within a solid: most rays meet a surface from behind
  };
  int index(const Grid& grid, int i, int j) const { return grid_samples_[grid.place(i, j)]; }
  Range add_part(const Part& part, int number, const Pose& T, double coarser);
  std::uint64_t lamp_points_seen(const Sample& s) const;
  Gather gather(const Sample& s, int rays, const Movers* movers) const;
  void fill(const Grid& grid, std::vector<std::uint8_t>& unusable, Irradiance& irradiance) const;
  void light_movers(const LabState& T_world_part, const Movers& movers, int rays, Irradiance& out) const;
  void shade_still(const Movers& movers, int rays, Irradiance& out) const;

  std::vector<Grid> grids_;              // one per facet
  std::vector<int> grid_samples_;        // index into samples_
  std::vector<Eigen::Vector3f> albedo_;  // one per facet, mean
  std::vector<Sample> samples_;
  std::vector<Range> still_, moving_;
  std::vector<int> still_facets_;              // facet of each of the still tracer's triangles
  std::vector<Eigen::Vector3f> still_g_;       // normals of these
  std::vector<std::vector<Triangle>> solids_;  // of each moving part, node frame
  std::optional<Tracer> still_tracer_;
  std::vector<std::uint64_t> seen_;  // lamp points that a still sample sees, one bit each
  Irradiance direct_, ambient_;
  std::vector<std::uint8_t> inside_;
  std::vector<std::uint8_t> deep_;  // inside, and covered by more than a sheet
};

}  // namespace foresight::sim
