#include "calibration/camera/input_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestLeft = 4;
constexpr std::size_t kNamed = 10;
constexpr double kShareOfCamera = 0.01;  // more corners outside are no single ones: the size is wrong
constexpr double kShareOfView = 0.05;    // and so many of one view and camera: it is of other images
constexpr std::size_t kMostOfView = 2;
constexpr double kFarthest = 0.001;  // so many corners may be wrong where the size is guessed

std::string size_text(const RigViews& views, std::size_t c) {
  return std::to_string(views.width[c]) + "x" + std::to_string(views.height[c]);
}

// One size for both cameras of a pair.
void guess_sizes(RigViews& views, std::vector<std::string>& notes) {
  if (views.width[0] > 0 && (views.cameras == 1 || views.width[1] > 0)) return;
  RigViews all = views;
  for (RigView& view : all.views)
    view.corners[0].insert(view.corners[0].end(), view.corners[1].begin(), view.corners[1].end());
  const auto size = usual_size(all, 0);
  for (std::size_t c = 0; c < static_cast<std::size_t>(views.cameras); ++c)
    if (views.width[c] <= 0) views.width[c] = size[0], views.height[c] = size[1];
  notes.push_back("the size of the images was not given; " + std::to_string(size[0]) + "x" + std::to_string(size[1]) +
                  " is the smallest usual one that holds all corners but the farthest 0.1 % (--size says it)");
}

struct Outside {
  std::vector<std::string> corners;  ///< the name of each
  std::size_t of = 0;                ///< so many corners of the camera
  bool whole_view = false;
};

std::string named(const RigViews& views, int camera, const RigView& view, const Corner& corner) {
  return camera_name(camera, views.cameras) + " view " + view.name + ", corner " + std::to_string(corner.index);
}

// Takes them out, and what a view has left where that is too few to place it.
Outside drop_outside(RigViews& views, int camera) {
  const auto c = static_cast<std::size_t>(camera);
  Outside outside;
  for (RigView& view : views.views) {
    auto& corners = view.corners[c];
    const std::size_t before = corners.size(), named_before = outside.corners.size();
    std::vector<Corner> kept;
    for (const Corner& corner : corners) {
      const Eigen::Vector2d& p = corner.pixel;
      if (p.x() < -0.5 || p.y() < -0.5 || p.x() > views.width[c] - 0.5 || p.y() > views.height[c] - 0.5)
        outside.corners.push_back(named(views, camera, view, corner));
      else
        kept.push_back(corner);
    }
    const std::size_t count = outside.corners.size() - named_before;
    outside.whole_view |= count > kMostOfView && double(count) > kShareOfView * double(before);
    outside.of += before;
    if (count > 0) corners = kept.size() < kFewestLeft ? std::vector<Corner>{} : std::move(kept);
  }
  return outside;
}

void check_size(RigViews& views, int camera, std::vector<std::string>& notes) {
  const auto c = static_cast<std::size_t>(camera);
  const Outside outside = drop_outside(views, camera);
  const std::size_t count = outside.corners.size();
  if (count == 0) return;
  const std::string of_all = std::to_string(count) + " of " + std::to_string(outside.of) + " corners";
  if (outside.whole_view || double(count) > std::max(1.0, kShareOfCamera * double(outside.of)))
    throw InputError(outside.corners.front(),
                     "lies outside the image of " + size_text(views, c) + ", as do " + of_all + " of this camera",
                     "give the size of the images they were found in (--size)");
  for (std::size_t i = 0; i < std::min(count, kNamed); ++i)
    notes.push_back(outside.corners[i] + " lies outside the image of " + size_text(views, c) + " and is not used");
  notes.push_back(of_all + " of the " + camera_name(camera, views.cameras) + (views.cameras == 2 ? " camera" : "") +
                  " lie outside the image and are not used");
}

void drop_empty_views(RigViews& views) {
  std::vector<std::size_t> seen;
  for (std::size_t v = 0; v < views.views.size(); ++v)
    if (!views.views[v].corners[0].empty() || !views.views[v].corners[1].empty()) seen.push_back(v);
  if (seen.size() < views.views.size()) views = subset(views, seen);
}

// The farthest coordinate, but for a few that may be wrong.
double extent(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto few = static_cast<std::size_t>(std::ceil(kFarthest * double(values.size())));
  return values[values.size() - 1 - std::min(few, values.size() - 1)];
}

}  // namespace

int useful_views(const RigViews& views) {
  int count = 0;
  for (const RigView& view : views.views) count += views.cameras == 1 || view.both();
  return count;
}

void check_views(RigViews& views, std::vector<std::string>& notes) {
  guess_sizes(views, notes);
  for (int c = 0; c < views.cameras; ++c) check_size(views, c, notes);
  drop_empty_views(views);
  const int count = useful_views(views);
  if (count < kFewestViews)
    throw InputError(views.cameras == 2 ? "pairs" : "views",
                     "there are " + std::to_string(count) + ", and at least 5 are needed",
                     "take 15 or more, of a board that is tilted and reaches all corners of the image");
  if (views.cameras == 2 && (views.width[0] != views.width[1] || views.height[0] != views.height[1]))
    notes.push_back("the two cameras' images differ in size: " + size_text(views, 0) + " and " + size_text(views, 1));
}

std::array<int, 2> usual_size(const RigViews& views, int camera) {
  static constexpr std::array<std::array<int, 2>, 22> kSizes{{
      {320, 240},   {640, 360},   {512, 512},   {640, 400},   {640, 480},   {752, 480},   {848, 480},   {800, 600},
      {960, 540},   {1024, 768},  {1280, 720},  {1280, 800},  {1024, 1024}, {1280, 960},  {1280, 1024}, {1440, 1080},
      {1600, 1200}, {1920, 1080}, {1920, 1200}, {2048, 1536}, {2448, 2048}, {3840, 2160},
  }};
  std::vector<double> x, y;
  for (const RigView& view : views.views)
    for (const Corner& corner : view.corners[static_cast<std::size_t>(camera)])
      x.push_back(corner.pixel.x()), y.push_back(corner.pixel.y());
  const Eigen::Vector2d most(extent(std::move(x)), extent(std::move(y)));
  std::array<int, 2> best{static_cast<int>(most.x()) + 1, static_cast<int>(most.y()) + 1};
  double area = std::numeric_limits<double>::infinity();
  for (const auto& size : kSizes)
    if (most.x() < size[0] && most.y() < size[1] && double(size[0]) * size[1] < area)
      best = size, area = double(size[0]) * size[1];
  return best;
}

}  // namespace foresight
