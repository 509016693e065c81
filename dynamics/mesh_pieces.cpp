#include "dynamics/mesh_pieces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace foresight {
namespace {

constexpr double kFlat = 5e-4;  // m
constexpr double kRound = 0.01;
constexpr std::size_t kFewestOfBall = 60;

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

Eigen::AlignedBox3d box_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v.cast<double>());
  return box;
}

/// Every edge has one neighbour on its other side.
bool closed(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (!edges.insert({t[k], t[(k + 1) % 3]}).second) return false;
  return std::ranges::all_of(edges, [&](const auto& edge) { return edges.contains({edge.second, edge.first}); });
}

bool is_convex(const Mesh& mesh) {
  if (!closed(mesh)) return false;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d n =
        (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a).normalized();
    for (const Eigen::Vector3f& v : mesh.vertices)
      if (n.dot(v.cast<double>() - a) > kFlat) return false;
  }
  return true;
}

double ball_radius(const Mesh& mesh) {
  if (mesh.vertices.size() < kFewestOfBall) return 0;
  const Eigen::Vector3d middle = box_of(mesh).center();
  double least = 1e9, most = 0;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    const double r = (v.cast<double>() - middle).norm();
    least = std::min(least, r);
    most = std::max(most, r);
  }
  return most - least <= kRound * most ? most : 0;
}

}  // namespace

std::vector<MeshPiece> pieces_of(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 1; k < 3; ++k) parent[root_of(parent, t[k])] = root_of(parent, t[0]);
  std::map<std::uint32_t, std::size_t> piece_of;
  std::vector<MeshPiece> out;
  std::vector<std::uint32_t> place(mesh.vertices.size(), ~0u);
  for (const auto& t : mesh.triangles) {
    const auto [at, added] = piece_of.try_emplace(root_of(parent, t[0]), out.size());
    if (added) out.emplace_back();
    Mesh& piece = out[at->second].mesh;
    std::array<std::uint32_t, 3> moved{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (place[t[k]] == ~0u) {
        place[t[k]] = static_cast<std::uint32_t>(piece.vertices.size());
        piece.vertices.push_back(mesh.vertices[t[k]]);
      }
      moved[k] = place[t[k]];
    }
    piece.triangles.push_back(moved);
  }
  for (MeshPiece& piece : out) {
    piece.ball_radius = ball_radius(piece.mesh);
    piece.convex = piece.ball_radius > 0 || is_convex(piece.mesh);
  }
  return out;
}

Solid solid_of(const Mesh& mesh) {
  Solid out;
  if (mesh.vertices.empty()) return out;
  const Eigen::Vector3d middle = box_of(mesh).center();
  out.centre = middle;
  double volume = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - middle,
                          b = mesh.vertices[t[1]].cast<double>() - middle,
                          c = mesh.vertices[t[2]].cast<double>() - middle;
    const double six = a.dot(b.cross(c));
    volume += six / 6;
    sum += six / 24 * (a + b + c);
  }
  if (!(volume > 0) || !box_of(mesh).contains(middle + sum / volume)) return out;
  out.volume = volume;
  out.centre = middle + sum / volume;
  return out;
}

}  // namespace foresight
