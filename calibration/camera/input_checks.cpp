#include "calibration/camera/input_checks.hpp"

#include <limits>

#include "common/error.hpp"

namespace foresight {
namespace {

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
                  " is the smallest usual one that holds all corners");
}

void check_size(const RigViews& views, int camera) {
  const auto c = static_cast<std::size_t>(camera);
  for (const RigView& view : views.views)
    for (const Corner& corner : view.corners[c])
      if (corner.pixel.x() < -0.5 || corner.pixel.y() < -0.5 || corner.pixel.x() > views.width[c] - 0.5 ||
          corner.pixel.y() > views.height[c] - 0.5)
        throw InputError(
            camera_name(camera, views.cameras) + " view " + view.name + ", corner " + std::to_string(corner.index),
            "lies outside the image of " + size_text(views, c), "give the size of the images it was found in");
}

}  // namespace

int useful_views(const RigViews& views) {
  int count = 0;
  for (const RigView& view : views.views) count += views.cameras == 1 || view.both();
  return count;
}

void check_views(RigViews& views, std::vector<std::string>& notes) {
  const int count = useful_views(views);
  if (count < kFewestViews)
    throw InputError(views.cameras == 2 ? "pairs" : "views",
                     "there are " + std::to_string(count) + ", and at least 5 are needed",
                     "take 15 or more, of a board that is tilted and reaches all corners of the image");
  guess_sizes(views, notes);
  for (int c = 0; c < views.cameras; ++c) check_size(views, c);
  if (views.cameras == 2 && (views.width[0] != views.width[1] || views.height[0] != views.height[1]))
    notes.push_back("the two cameras' images differ in size: " + size_text(views, 0) + " and " + size_text(views, 1));
}

std::array<int, 2> usual_size(const RigViews& views, int camera) {
  static constexpr std::array<std::array<int, 2>, 22> kSizes{{
      {320, 240},   {640, 360},   {512, 512},   {640, 400},   {640, 480},   {752, 480},   {848, 480},   {800, 600},
      {960, 540},   {1024, 768},  {1280, 720},  {1280, 800},  {1024, 1024}, {1280, 960},  {1280, 1024}, {1440, 1080},
      {1600, 1200}, {1920, 1080}, {1920, 1200}, {2048, 1536}, {2448, 2048}, {3840, 2160},
  }};
  Eigen::Vector2d most = Eigen::Vector2d::Zero();
  for (const RigView& view : views.views)
    for (const Corner& corner : view.corners[static_cast<std::size_t>(camera)]) most = most.cwiseMax(corner.pixel);
  std::array<int, 2> best{static_cast<int>(most.x()) + 1, static_cast<int>(most.y()) + 1};
  double area = std::numeric_limits<double>::infinity();
  for (const auto& size : kSizes)
    if (most.x() < size[0] && most.y() < size[1] && double(size[0]) * size[1] < area)
      best = size, area = double(size[0]) * size[1];
  return best;
}

}  // namespace foresight
