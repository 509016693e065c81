#include "apps/bench/portal_figures.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "apps/bench/head_lab.hpp"
#include "common/statistics.hpp"
#include "gl/raster_pass.hpp"
#include "gl/read_texture.hpp"
#include "sim/building.hpp"

namespace foresight {
namespace {

constexpr int kRoomsX = 4, kRoomsY = 3;

Lens building_lens() {
  Lens::Parameters p;
  p.width = 320;
  p.height = 240;
  p.fx = p.fy = 260;
  p.cx = 159.5;
  p.cy = 119.5;
  return Lens(p);
}

/// Upright, in a room.
Pose in_a_room(const CellGraph& graph, std::mt19937& random) {
  constexpr double kOffWalls = 0.3;  // m
  std::uniform_real_distribution any(0.0, 1.0);
  const auto rooms = graph.cells().size();
  const Eigen::AlignedBox3d& room = graph.cells()[std::uniform_int_distribution<std::size_t>(0, rooms - 1)(random)].box;
  const Eigen::Vector3d off(kOffWalls, kOffWalls, 1.2), to = room.max() - Eigen::Vector3d(kOffWalls, kOffWalls, 0.9);
  Pose out = Pose::Identity();
  out.translation() =
      room.min() + off + Eigen::Vector3d(any(random), any(random), any(random)).cwiseProduct(to - room.min() - off);
  const double turn = 2 * EIGEN_PI * any(random);
  out.linear() << std::sin(turn), 0, std::cos(turn), -std::cos(turn), 0, std::sin(turn), 0, -1, 0;
  return out;
}

}  // namespace

nlohmann::json portal_figures(const PortalTrial& trial) {
  using LeavesOut = gl::RasterPass::LeavesOut;
  const SceneModel building =
      sim::make_building({.rooms_x = kRoomsX, .rooms_y = kRoomsY, .triangles = trial.triangles, .seed = trial.seed});
  gl::RasterPass raster(std::make_shared<gl::SceneBuffers>(building), true),
      raster_without_cells(std::make_shared<gl::SceneBuffers>(SceneModel(building.nodes(), std::nullopt)), true);
  const gl::FaceImages images(gl::faces_for(building_lens(), 0), true);
  const SceneState rest{{}, StateStatus::exact, building.rest_poses()};
  struct Row {
    gl::RasterPass& raster;
    LeavesOut what;
    const char *key, *words;
    std::vector<double> triangles, cpu_ms;
  };
  std::vector<Row> rows{
      {raster, LeavesOut::nothing, "all", "every node", {}, {}},
      {raster, LeavesOut::out_of_view, "frustum", "those in view", {}, {}},
      {raster, LeavesOut::behind_walls, "portals", "those that portals show", {}, {}},
      {raster, LeavesOut::hidden, "hidden", "of them, those not hidden", {}, {}},
      {raster, LeavesOut::hidden, "hidden_again", "  a view as the last one", {}, {}},
      {raster_without_cells, LeavesOut::hidden, "hidden_without_cells", "in view, not hidden", {}, {}},
      {raster_without_cells, LeavesOut::hidden, "hidden_without_cells_again", "  a view as the last one", {}, {}}};
  std::mt19937 random(trial.seed);
  std::size_t different = 0, ties = 0;
  for (int i = 0; i < trial.views; ++i) {
    const Pose from = in_a_room(*building.cells(), random);
    cv::Mat first, first_depth;
    for (Row& row : rows) {
      row.raster.leave_out(row.what);
      row.cpu_ms.push_back(gpu_cpu_ms([&] { row.raster(from, rest, images); }));
      row.triangles.push_back(static_cast<double>(row.raster.triangles()));
      const cv::Mat seen = gl::read_texture(images.surface), depth = gl::read_texture(images.depth);
      if (first.empty()) first = seen, first_depth = depth;
      different += static_cast<std::size_t>(cv::countNonZero((first != seen) & (first_depth != depth)));
      ties += static_cast<std::size_t>(cv::countNonZero((first != seen) & (first_depth == depth)));
    }
  }
  nlohmann::json out;
  std::printf("a building of %zu triangles, %d views: %zu pixels differ, and %zu ties of depth\n",
              building.triangle_count(), trial.views, different, ties);
  for (const Row& row : rows) {
    const double triangles = std::accumulate(row.triangles.begin(), row.triangles.end(), 0.0) / trial.views;
    out[row.key] = {{"triangles", triangles}, {"cpu_ms", median(row.cpu_ms)}};
    std::printf("  %-26s %10.0f triangles on average, %7.2f CPU-ms (median)\n", row.words, triangles,
                median(row.cpu_ms));
  }
  out["different_pixels"] = different;
  out["ties"] = ties;
  out["views"] = trial.views;
  out["building_triangles"] = building.triangle_count();
  return out;
}

}  // namespace foresight
