// Makes a mesh coarser, one collapsed edge after the other, and remembers which vertex went where.
//
//       a---b            a---b        u goes to v, its triangles with it; the two between them are gone. v stays where
//      / \ / \          / \ /|        it is, so that a coarser mesh has vertices of the finer one, and each of its
//     c---u---v   -->  c----v         triangles is one of the mesh's own, with other corners.
//      \ / \ /          \  /|
//       d---e            d--e
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/mesh.hpp"

namespace foresight {

/// Edges go in the order of the squared distances from the planes of all triangles that their vertex stood for (Garland
/// and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997), in rounds of edges that do not touch each
/// other. No triangle turns over, nothing is glued together, nothing vanishes as a whole. Where parts meet, and where
/// the surface ends, vertices go along that line only, and corners of such lines stay, as do edges of three and more
/// triangles.
class EdgeCollapse {
 public:
  struct Triangle {
    std::array<std::uint32_t, 3> corners;  ///< of the mesh's vertices
    std::uint32_t source;                  ///< the mesh's triangle that it was
  };

  /// All vertices are finite. `part_of`: of each triangle, or empty. The mesh must outlive this.
  EdgeCollapse(const Mesh& mesh, std::span<const int> part_of);

  /// Until there are at most so many triangles, or nothing more can go within `largest_error` (m). False: the latter.
  bool reduce_to(std::size_t triangles, double largest_error);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// The vertex that this one has become; itself as long as it is there.
  std::uint32_t vertex_of(std::uint32_t vertex) const;

 private:
  /// Sum of the squared distances to planes, weighed by area.
  struct Quadric {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double c = 0, area = 0;
    void add_plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point, double weight);
    void add(const Quadric& other);
    double at(const Eigen::Vector3d& p) const;  ///< mean, m2
  };
  struct Neighbour {
    std::uint32_t vertex;
    int triangles;  // at the edge to it
    int part, other_part;
    bool is_line() const { return triangles != 2 || part != other_part; }
  };
  struct Collapse {
    double cost = 0;
    std::uint32_t from = 0, to = 0;
    bool operator<(const Collapse& other) const { return cost != other.cost ? cost < other.cost : from < other.from; }
  };

  void find_quadrics();
  void list_triangles_of_vertices();
  std::span<const std::uint32_t> around(std::uint32_t vertex) const;
  int part(std::uint32_t triangle) const;
  void find_neighbours(std::uint32_t vertex, std::vector<Neighbour>& out) const;
  /// Neighbours that it may go to.
  static void keep_allowed(std::vector<Neighbour>& neighbours);
  /// The cheapest one that is allowed; of infinite cost where there is none.
  Collapse best_collapse(std::uint32_t vertex);
  bool turns_over(std::uint32_t from, std::uint32_t to) const;
  bool glues(std::uint32_t from, std::uint32_t to);
  /// One round; returns how many triangles are gone.
  std::size_t round(std::size_t most, double largest_cost);
  void apply();

  std::span<const int> part_of_;
  std::vector<Eigen::Vector3d> places_;
  std::vector<Triangle> triangles_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> to_;            // of each vertex, itself while it is there
  std::vector<std::uint32_t> first_, list_;  // triangles of each vertex, as they were when the round began
  std::vector<std::uint8_t> touched_;        // since best_ was found
  std::vector<Collapse> best_, ways_;        // of each vertex; of the one in work
  std::vector<Neighbour> ring_, other_ring_;
};

}  // namespace foresight
