#include "scene/lod/mesh_levels.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "scene/lod/edge_collapse.hpp"
#include "scene/lod/nearest_surface.hpp"

namespace foresight {
namespace {

constexpr double kTooAlike = 0.85;     // a level with more of the finer one's triangles saves nothing
constexpr double kLoose = 0.1;         // share of triangles without neighbours that makes no surface
constexpr std::size_t kSamples = 200;  // of a mesh's vertices, from which a level's error is measured

/// A level while it is made: triangles over the mesh's own vertices.
struct Draft {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> source;
  double error = 0;
};

/// How far vertices of the mesh are from a level's surface at the most.
double farthest(const Mesh& mesh, const Draft& draft) {
  std::vector<NearestSurface::Corners> corners;
  corners.reserve(draft.triangles.size());
  for (const auto& [a, b, c] : draft.triangles)
    corners.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  const NearestSurface nearest(std::move(corners));
  const std::size_t step = std::max<std::size_t>(1, mesh.triangles.size() / kSamples);
  double out = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += step) {
    const Eigen::Vector3f& p = mesh.vertices[mesh.triangles[i][0]];
    out = std::max(out, static_cast<double>((*nearest(p) - p).norm()));
  }
  return out;
}

Draft draft_of(const Mesh& mesh, const EdgeCollapse& collapse, double finer_error) {
  Draft out;
  for (const EdgeCollapse::Triangle& t : collapse.triangles()) {
    out.triangles.push_back(t.corners);
    out.source.push_back(t.source);
  }
  out.error = std::max(finer_error, farthest(mesh, out));
  return out;
}

bool all_finite(const Mesh& mesh) {
  return std::ranges::all_of(mesh.vertices, [](const Eigen::Vector3f& v) { return v.allFinite(); });
}

std::string percent(std::size_t part, std::size_t all) {
  return std::to_string(100 * part / std::max<std::size_t>(1, all)) + " %";
}

/// Edges of a mesh, by how many triangles they have.
struct EdgeCounts {
  std::size_t all = 0, several = 0;  // several: more than two
  std::size_t loose = 0;             // triangles that share no edge with another
};

EdgeCounts count_edges(const Mesh& mesh) {
  struct Side {
    std::uint64_t edge;
    std::uint32_t triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]);
      sides.push_back({static_cast<std::uint64_t>(low) << 32 | high, i});
    }
  std::ranges::sort(sides, {}, &Side::edge);
  EdgeCounts out;
  std::vector<std::uint8_t> is_loose(mesh.triangles.size(), 1);
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end, ++out.all) {
    while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
    out.several += end - i > 2;
    for (std::size_t k = i; k < end && end - i > 1; ++k) is_loose[sides[k].triangle] = 0;
  }
  out.loose = static_cast<std::size_t>(std::ranges::count(is_loose, 1));
  return out;
}

/// Why nothing of it could go.
std::string what_holds(const EdgeCounts& edges) {
  if (edges.several > 0)
    return "three or more triangles meet at " + percent(edges.several, edges.all) +
           " of its edges; remove inner walls and doubled faces";
  return "no edge of it can go without turning triangles over";
}

MeshLevels only_itself(const Mesh& mesh, std::string why_not) {
  MeshLevels out;
  out.vertices = out.coarser = mesh.vertices;
  out.levels.push_back({mesh.triangles, {}, static_cast<std::uint32_t>(mesh.vertices.size()), 0});
  out.why_not = std::move(why_not);
  return out;
}

/// Vertices in the order of the coarsest level that has them; and how many each level has.
std::vector<std::uint32_t> coarse_first(const Mesh& mesh, const std::vector<Draft>& drafts,
                                        std::vector<MeshLevel>& levels) {
  std::vector<std::size_t> coarsest(mesh.vertices.size(), 0);
  for (std::size_t l = 0; l < drafts.size(); ++l)
    for (const auto& t : drafts[l].triangles)
      for (const std::uint32_t v : t) coarsest[v] = l;
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return coarsest[a] > coarsest[b]; });
  for (std::size_t l = 0; l < drafts.size(); ++l)
    levels[l].vertex_count =
        static_cast<std::uint32_t>(std::ranges::count_if(coarsest, [&](std::size_t c) { return c >= l; }));
  return order;
}

/// Where the vertices of each level go on the next one.
void find_ways(const std::vector<std::vector<std::uint32_t>>& ways, const std::vector<std::uint32_t>& order,
               MeshLevels& out) {
  out.coarser = out.vertices;
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  for (std::size_t l = 0; l + 1 < out.levels.size(); ++l)
    for (std::uint32_t i = out.levels[l + 1].vertex_count; i < out.levels[l].vertex_count; ++i)
      out.coarser[i] = out.vertices[place[ways[l][order[i]]]];
}

MeshLevels put_together(const Mesh& mesh, const std::vector<Draft>& drafts,
                        const std::vector<std::vector<std::uint32_t>>& ways) {
  MeshLevels out;
  out.levels.resize(drafts.size());
  const std::vector<std::uint32_t> order = coarse_first(mesh, drafts, out.levels);
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    out.vertices.push_back(mesh.vertices[order[i]]);
  }
  for (std::size_t l = 0; l < drafts.size(); ++l) {
    MeshLevel& level = out.levels[l];
    level.error = drafts[l].error;
    level.source = drafts[l].source;
    for (const auto& [a, b, c] : drafts[l].triangles) level.triangles.push_back({place[a], place[b], place[c]});
  }
  find_ways(ways, order, out);
  return out;
}

}  // namespace

MeshLevels make_mesh_levels(const Mesh& mesh, std::span<const int> part_of, const MeshLevelOptions& options) {
  if (!part_of.empty() && part_of.size() != mesh.triangles.size())
    throw std::invalid_argument("another count of parts than of triangles");
  if (mesh.triangles.size() < std::max<std::size_t>(1, options.worth_it)) return only_itself(mesh, "");
  if (!all_finite(mesh)) return only_itself(mesh, "some of its vertices are no numbers; export it anew");
  const EdgeCounts edges = count_edges(mesh);
  if (static_cast<double>(edges.loose) > kLoose * static_cast<double>(mesh.triangles.size()))
    return only_itself(mesh, percent(edges.loose, mesh.triangles.size()) +
                                 " of its triangles are joined to no other; join vertices at the same place");

  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v.cast<double>());
  const double largest_error = options.largest_error * box.sizes().maxCoeff();
  std::vector<Draft> drafts{{mesh.triangles, {}, 0}};
  std::vector<std::vector<std::uint32_t>> ways;  // from each level to the next: the vertex that each of the mesh's is
  EdgeCollapse collapse(mesh, part_of);
  for (bool goes_on = true; goes_on && drafts.back().triangles.size() > options.fewest;) {
    const auto before = static_cast<double>(drafts.back().triangles.size());
    goes_on = collapse.reduce_to(static_cast<std::size_t>(options.share * before), largest_error);
    if (static_cast<double>(collapse.triangles().size()) > kTooAlike * before) break;
    drafts.push_back(draft_of(mesh, collapse, drafts.back().error));
    ways.emplace_back();
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) ways.back().push_back(collapse.vertex_of(v));
  }
  if (drafts.size() == 1) return only_itself(mesh, what_holds(edges));
  return put_together(mesh, drafts, ways);
}

}  // namespace foresight
