#include "prediction/contact/contact_mesh.hpp"

#include "motion/triangle_tree.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

// A hint may be nearest itself: what is looked for must be nearer than a little more than it, or nothing is found.
constexpr double kHintShare = 1e-9, kHintLength = 1e-12;

using Model = fcl::BVHModel<fcl::OBBd>;

bool has_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return std::isfinite(longest) && (b - a).cross(c - a).norm() > 1e-6 * longest * longest;
}

}  // namespace

struct ContactMesh::Tree {
  Model model;
  TriangleTree nearest;

  bool has(int triangle) const { return triangle >= 0 && triangle < model.num_tris; }
};

ContactMesh::ContactMesh(const Mesh& mesh) : tree_(std::make_unique<Tree>()) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  vertices.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& v : mesh.vertices) vertices.push_back(v.cast<double>());
  for (const auto& t : mesh.triangles) {
    const bool exists = std::ranges::all_of(t, [&](std::uint32_t i) { return i < vertices.size(); });
    if (exists && has_area(vertices[t[0]], vertices[t[1]], vertices[t[2]]))
      triangles.emplace_back(t[0], t[1], t[2]);
    else
      ++left_out_;
  }
  triangles_ = triangles.size();
  if (triangles.empty()) return;
  for (const fcl::Triangle& t : triangles)
    for (int corner = 0; corner < 3; ++corner) box_.extend(vertices[t[corner]]);
  for (const fcl::Triangle& t : triangles)
    for (int corner = 0; corner < 3; ++corner)
      radius_ = std::max(radius_, (vertices[t[corner]] - box_.center()).norm());
  for (Eigen::Vector3d& v : vertices)
    if (!v.allFinite()) v.setZero();  // no triangle uses it
  tree_->model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  tree_->model.addSubModel(vertices, triangles);
  tree_->model.endModel();
  std::vector<Corners> corners;
  for (const fcl::Triangle& t : triangles) corners.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
  tree_->nearest = TriangleTree(std::move(corners));
}

ContactMesh::~ContactMesh() = default;
ContactMesh::ContactMesh(ContactMesh&&) noexcept = default;
ContactMesh& ContactMesh::operator=(ContactMesh&&) noexcept = default;

Eigen::Vector3d ContactMesh::normal(int triangle) const {
  const auto& [a, b, c] = tree_->nearest.triangle(static_cast<std::size_t>(triangle));
  return (b - a).cross(c - a).normalized();
}

bool ContactMesh::touch(const ContactMesh& one, const Pose& T_one, const ContactMesh& other, const Pose& T_other) {
  const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  return fcl::collide(&one.tree_->model, T_one, &other.tree_->model, T_other, request, result) > 0;
}

std::vector<TrianglePair> ContactMesh::crossing(const ContactMesh& one, const Pose& T_one, const ContactMesh& other,
                                                const Pose& T_other, std::size_t most) {
  const fcl::CollisionRequestd request(most, false);
  fcl::CollisionResultd result;
  fcl::collide(&one.tree_->model, T_one, &other.tree_->model, T_other, request, result);
  std::vector<TrianglePair> out;
  for (std::size_t i = 0; i < std::min(result.numContacts(), most); ++i) {
    const fcl::Contactd& contact = result.getContact(i);
    const TrianglePair pair{static_cast<int>(contact.b1), static_cast<int>(contact.b2)};
    if (one.tree_->has(pair[0]) && other.tree_->has(pair[1])) out.push_back(pair);
  }
  return out;
}

std::optional<MeshNearest> ContactMesh::nearest(const ContactMesh& one, const Pose& T_one, const ContactMesh& other,
                                                const Pose& T_other, double within, const TrianglePair& hint) {
  const TriangleTree &ours = one.tree_->nearest, &theirs = other.tree_->nearest;
  const Pose T = T_one.inverse(Eigen::Isometry) * T_other;
  MeshNearest out;
  // Where boxes overlap, whether triangles cross is the cheaper question, and the one that touch() answers.
  if (ours.at_least(theirs, T) <= 0)
    if (const auto pairs = crossing(one, T_one, other, T_other, 1); !pairs.empty()) {
      const TriangleTree::Nearest met = ours.between(theirs, T, pairs[0]);
      out.point = out.other_point = T_one * (0.5 * (met.point + met.other_point));
      out.triangles = pairs[0];
      return out;
    }
  if (one.tree_->has(hint[0]) && other.tree_->has(hint[1]))
    within = std::min(within, ours.between(theirs, T, hint).distance * (1 + kHintShare) + kHintLength);
  const TriangleTree::Nearest found = ours.nearest(theirs, T, within);
  if (found.triangles[0] < 0) return std::nullopt;
  out.distance = found.distance;
  out.point = T_one * found.point;
  out.other_point = T_one * found.other_point;
  out.triangles = found.triangles;
  return out;
}

}  // namespace foresight
