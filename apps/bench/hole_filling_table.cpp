// Table 7.3: ways to fill holes, by how much there is to fill.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/extraction_tables.hpp"

namespace foresight {
namespace {

using nlohmann::json;
using thesis::HoleFilling;

struct Case {
  const char* title;
  std::shared_ptr<const SceneModel> scene;
  std::optional<std::size_t> node;  // only this one; nothing: all
  std::size_t textured_before;      // images that its textures are made of before
  double thesis_ms[3];              // pyramid, shader without query, with query
};

/// The node as a scene of its own.
std::shared_ptr<const SceneModel> alone(const SceneModel& scene, std::size_t node) {
  Node only = scene.nodes()[node];
  only.parent = -1;
  return std::make_shared<const SceneModel>(std::vector<Node>{only});
}

PosedFrame frame_of(const PosedFrame& frame, std::optional<std::size_t> node) {
  PosedFrame out = frame;
  if (node) out.left.scene.T_world_node = {frame.left.scene.T_world_node[*node]};
  return out;
}

/// Polygons of each node.
std::vector<std::size_t> polygons_per_node(const SceneModel& scene) {
  std::vector<std::size_t> out(scene.nodes().size());
  for (const thesis::Polygon& polygon : thesis::find_polygons(scene)) ++out[static_cast<std::size_t>(polygon.node)];
  return out;
}

/// The node whose number of polygons comes nearest to `wanted`, of those with any.
std::size_t node_of(const std::vector<std::size_t>& polygons, std::size_t wanted) {
  std::size_t best = 0;
  const auto off = [&](std::size_t i) {
    return polygons[i] ? std::max(polygons[i], wanted) - std::min(polygons[i], wanted) : std::size_t{1} << 40;
  };
  for (std::size_t i = 1; i < polygons.size(); ++i)
    if (off(i) < off(best)) best = i;
  return best;
}

/// Frames in whose left image some polygon of the case is in view.
std::vector<std::size_t> frames_of(const BenchSetup& setup, const Case& which) {
  const gl::Faces plane = gl::faces_for(setup.run.lens_left(), 0);
  const auto polygons = thesis::find_polygons(*which.scene);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < setup.frames.size(); ++i) {
    const PosedFrame frame = frame_of(setup.frames[i], which.node);
    const Pose T_camera_world = frame.left.T_world_camera.inverse();
    const auto in_view = [&](const thesis::Polygon& p) {
      const Pose& T_world_node = frame.left.scene.T_world_node[static_cast<std::size_t>(p.node)];
      return thesis::bounding_box(p, T_camera_world * T_world_node, plane).has_value();
    };
    if (std::any_of(polygons.begin(), polygons.end(), in_view)) out.push_back(i);
  }
  return out;
}

double measure(const BenchSetup& setup, const Case& which, HoleFilling method) {
  thesis::Options options;
  options.texels_per_metre = setup.texels_per_metre;
  options.max_texture = setup.max_texture;
  options.profile = true;
  options.hole_filling = which.textured_before ? HoleFilling::pyramid : method;
  // The images before are textured by the quickest way, then the one that is measured.
  const auto in_view = frames_of(setup, which);
  if (in_view.empty()) return 0;
  std::vector<std::size_t> frames;
  for (std::size_t i : spread(in_view.size(), which.textured_before + 1)) frames.push_back(in_view[i]);
  thesis::Pipeline pipeline(which.scene, setup.run.lens_left(), std::nullopt, options, setup.software);
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) pipeline.process(frame_of(setup.frames[frames[i]], which.node));
  pipeline.fill_holes_by(method);
  StageSums sums;
  sums.add(pipeline.process(frame_of(setup.frames[frames.back()], which.node)));
  return sums.mean_of("hole filling");
}

}  // namespace

json bench_hole_filling(const BenchSetup& setup) {
  const SceneModel& scene = *setup.run.scene();
  const auto polygons = polygons_per_node(scene);
  const std::size_t object = node_of(polygons, 139), simple = node_of(polygons, 6);
  const Case cases[] = {
      {"the whole scene, first image", setup.run.scene(), std::nullopt, 0, {66.2, 3014.9, 1752.5}},
      {"an object, partly textured", alone(scene, object), object, 2, {58.3, 892.1, 404.2}},
      {"a simple object, textured before", alone(scene, simple), simple, 16, {4.8, 160.7, 3.7}},
  };
  constexpr std::pair<HoleFilling, const char*> kMethods[] = {{HoleFilling::pyramid, "pyramid"},
                                                              {HoleFilling::shader, "shader, without query"},
                                                              {HoleFilling::shader_query, "shader, with query"}};
  std::printf("\nTable 7.3: hole filling, CPU-ms per image (thesis: ms); objects: %s (%zu polygons), %s (%zu)\n",
              scene.nodes()[object].name.c_str(), polygons[object], scene.nodes()[simple].name.c_str(),
              polygons[simple]);
  json out;
  for (const Case& which : cases) {
    std::printf("%-34s", which.title);
    for (std::size_t m = 0; m < std::size(kMethods); ++m) {
      const double ms = measure(setup, which, kMethods[m].first);
      std::printf("  %s %.1f (%.1f)", kMethods[m].second, ms, which.thesis_ms[m]);
      std::fflush(stdout);
      out.push_back(
          {{"case", which.title}, {"method", kMethods[m].second}, {"cpu_ms", ms}, {"thesis_ms", which.thesis_ms[m]}});
    }
    std::printf("\n");
  }
  return out;
}

}  // namespace foresight
