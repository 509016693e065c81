#include "prediction/sighting/thing_search.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr std::size_t kPoints = 60;  // of each camera
constexpr double kAside = 1e-4;      // m along an edge, for its direction in the picture

struct Scored {
  double score;
  Pose T_world_thing;
};

Pose turned(const ThingShape& shape, const Pose& T_world_thing, double angle) {
  const Eigen::Vector3d middle = T_world_thing * shape.middle();
  Pose out = T_world_thing;
  out.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * T_world_thing.linear();
  out.translation() += middle - out * shape.middle();
  return out;
}

double score(std::span<const SeenBy> cameras, const std::vector<VisiblePoint>& points,
             const std::vector<Pose>& T_camera_world, const Pose& T_world_thing) {
  std::size_t near = 0;
  for (const VisiblePoint& visible : points) {
    const SeenBy& camera = cameras[visible.camera];
    const Pose T = T_camera_world[visible.camera] * T_world_thing;
    const auto pixel = camera.lens->project(T * visible.point->p);
    const auto aside = camera.lens->project(T * (visible.point->p + kAside * visible.point->along));
    if (!pixel || !aside) continue;
    const Eigen::Vector2d along = *aside - *pixel;
    near += camera.picture->edge_near(*pixel, {-along.y(), along.x()}) ? 1 : 0;
  }
  return static_cast<double>(near) / static_cast<double>(points.size());
}

/// About kPoints of each camera whose colours are known.
std::vector<SurfaceView> some_views(const ThingShape& shape, std::size_t node, const SurfaceColours& colours,
                                    std::span<const SeenBy> cameras, const Pose& T_world_thing) {
  if (!colours.known()) return {};
  std::vector<SurfaceView> all = surface_views(shape, node, cameras, T_world_thing, false), out;
  std::erase_if(all, [&](const SurfaceView& view) { return !colours.knows(view.point); });
  const std::size_t step = std::max<std::size_t>(1, all.size() / (kPoints * cameras.size()));
  for (std::size_t i = 0; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

}  // namespace

std::vector<Pose> likely_poses(const ThingShape& shape, std::size_t node, const SurfaceColours& colours,
                               std::span<const SeenBy> cameras, const SearchWindow& window, std::size_t most) {
  std::vector<SeenBy> open(cameras.begin(), cameras.end());
  std::vector<Pose> T_camera_world;
  for (SeenBy& camera : open) {
    camera.front = nullptr;  // what hides the middle does not hide the whole window
    T_camera_world.push_back(camera.T_world_camera.inverse());
  }
  std::vector<Scored> all;
  const int steps = static_cast<int>(std::floor(window.reach / window.step));
  for (const double turn : window.turns) {
    const Pose middle = turned(shape, window.T_world_middle, turn);
    const std::vector<SurfaceView> views = some_views(shape, node, colours, open, middle);
    const std::vector<VisiblePoint> points = visible_points(shape, node, open, middle, kPoints);
    if ((colours.known() ? views.size() : points.size()) < kPoints / 4) continue;
    for (int y = -steps; y <= steps; ++y)
      for (int x = -steps; x <= steps; ++x) {
        Pose T = middle;
        T.translation() += window.step * Eigen::Vector3d(x, y, 0);
        const double found = colours.known() ? -colours.coarse_difference(shape, open, views, T)
                                             : score(open, points, T_camera_world, T);
        all.push_back({found, T});
      }
  }
  std::ranges::stable_sort(all, std::ranges::greater(), &Scored::score);
  std::vector<Pose> out;
  for (const Scored& one : all) {
    if (out.size() == most) break;
    const bool apart = std::ranges::none_of(out, [&](const Pose& better) {
      return (better.translation() - one.T_world_thing.translation()).norm() < 1.5 * window.step;
    });
    if (apart) out.push_back(one.T_world_thing);
  }
  return out;
}

}  // namespace foresight
