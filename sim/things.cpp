#include "sim/things.hpp"

#include <cctype>
#include <cmath>

#include "sim/thing_prints.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector3f;

constexpr float kSmooth = 0.766f;  // cosine of the largest angle between triangles that are one smooth surface
constexpr double kStillStep = 0.02, kMovingStep = 0.05;  // between light samples, as on the lab's own parts
constexpr double kPrintSide = 0.24;                      // metres; goes on mirrored
constexpr float kGloss = 0.03f;

// Where on its print, metres: letters stand upright on upright sides, the middle lies at the node's origin.
Eigen::Vector2f on_print(const Vector3f& p, const Vector3f& normal) {
  int along = 0;
  normal.cwiseAbs().maxCoeff(&along);
  Eigen::Vector2f from_middle(p.y(), normal.z() > 0 ? -p.x() : p.x());
  if (along == 0) from_middle = {normal.x() > 0 ? p.y() : -p.y(), -p.z()};
  if (along == 1) from_middle = {normal.y() > 0 ? -p.x() : p.x(), -p.z()};
  return from_middle + Eigen::Vector2f::Constant(0.5f * static_cast<float>(kPrintSide));
}

std::vector<Vector3f> normals_of(const Mesh& mesh) {
  std::vector<Vector3f> out;
  for (const auto& t : mesh.triangles)
    out.push_back((mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]));
  return out;
}

void add_facets(Facets& out, const Mesh& mesh, int material) {
  const std::vector<Vector3f> areas = normals_of(mesh);
  std::vector<std::vector<std::size_t>> around(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) around[v].push_back(t);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3f own = areas[t].normalized();
    Facet facet;
    facet.material = material;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      Vector3f sum = Vector3f::Zero();
      for (const std::size_t other : around[v])
        if (areas[other].normalized().dot(own) > kSmooth) sum += areas[other];
      facet.corners[k] = {mesh.vertices[v], sum.normalized(), on_print(mesh.vertices[v], own)};
    }
    out.push_back(facet);
  }
}

/// Letters and digits that the painter has.
std::string label_of(const std::string& name) {
  std::string out;
  for (const char c : name)
    out += std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::toupper(static_cast<unsigned char>(c)))
                                                       : ' ';
  return out.substr(out.size() > 12 ? out.size() - 12 : 0);
}

}  // namespace

void add_things(LabBuilder& builder, const RobotScene& things) {
  const std::vector<Pose> rest = things.poses([](std::string_view) { return std::nullopt; });
  for (std::size_t i = 0; i < things.nodes().size(); ++i) {
    const Node& node = things.nodes()[i];
    const bool moves = things.moves(i);
    Facets& facets = builder.part(node.name, rest[i], moves ? kMovingStep : kStillStep, moves);
    if (node.mesh.triangles.empty()) continue;
    const int material =
        builder.material([label = label_of(node.name), i](
                             double texel, unsigned seed) { return prints::thing(kPrintSide, texel, label, i, seed); },
                         0.8, kGloss);
    add_facets(facets, node.mesh, material);
  }
}

}  // namespace foresight::sim
