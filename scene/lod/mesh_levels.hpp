// A mesh in coarser and coarser levels, each with a way to the next: geomorphs between them make it a progressive mesh.
//
//   vertices   [ of all levels | of level 1 and 0 | of level 0 only ]      levels take a part of the front
//                     ^                  |                 |
//                     '---- coarser -----'                 |               where a vertex goes on the first level that
//                     ^-------------------- coarser -------'               is without it: to another vertex
//
// A level drawn with its own vertices on the way, by a share t, is between it and the next: at t = 1 it is the next
// one, with triangles of no area besides, and can be exchanged for it unseen. (Hoppe, "Progressive Meshes", SIGGRAPH
// 1996; there collapses are undone one by one, here as many at once as halve the triangles.)
#pragma once

#include <span>
#include <string>

#include "scene/mesh.hpp"

namespace foresight {

struct MeshLevelOptions {
  double share = 0.5;          ///< of its triangles that the next level keeps, at the most; 0 < share < 1
  std::size_t fewest = 48;     ///< triangles: nobody gains by less
  std::size_t worth_it = 256;  ///< triangles of a mesh that is worth levels at all
  double largest_error = 0.1;  ///< of a level, as a share of the mesh's largest side
};

/// One version of a mesh.
struct MeshLevel {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of MeshLevels::vertices
  /// For each triangle the mesh's own that it was, before its corners went elsewhere: of the same part; empty on level
  /// 0: they are the mesh's own, in its order.
  std::vector<std::uint32_t> source;
  std::uint32_t vertex_count = 0;  ///< it uses the first so many vertices
  double error = 0;                ///< m: how far vertices of the mesh are from its surface; grows from level to level
};

struct MeshLevels {
  std::vector<Eigen::Vector3f> vertices;  ///< of the mesh, in another order
  /// Where each vertex goes on the first level that is without it; itself for those of the coarsest one.
  std::vector<Eigen::Vector3f> coarser;
  std::vector<MeshLevel> levels;  ///< at least one, the mesh itself
  /// Why there is but one although it has triangles enough, for people; else empty.
  std::string why_not;
};

/// Collapses edges by quadrics (edge_collapse.hpp), vertices stay where they are. `part_of`: a part of each triangle,
/// such as the patch that its texture belongs to, or empty: all are one. Triangles stay within their part, so that
/// whatever belongs to a part (its texture) goes with it to every level; borders of parts and of the surface become
/// simpler along themselves. What cannot be simplified (separate triangles, edges of three or more, numbers that are
/// none) has one level, and `why_not` says so. Same input, same result. Throws std::invalid_argument: another count of
/// parts than of triangles.
MeshLevels make_mesh_levels(const Mesh& mesh, std::span<const int> part_of, const MeshLevelOptions& options = {});

}  // namespace foresight
