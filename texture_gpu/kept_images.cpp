#include "texture_gpu/kept_images.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kFarthest = 1;  // rad: further away they show other things
constexpr double kAlikeInHue = 1.1;
constexpr Duration kRenewed = std::chrono::seconds(1);
constexpr std::size_t kMostCharts = 500;  // that tell a range

std::uint64_t bytes_of(const PublishedImage& image) {
  const auto texels =
      static_cast<std::uint64_t>(image.still.width()) * static_cast<std::uint64_t>(image.still.height());
  return image.camera->bytes() + texels * sizeof(float);
}

}  // namespace

double typical_range(const SurfacePatches& surface, const Lens& lens, const PosedImage& image) {
  const Pose T_camera_world = image.T_world_camera.inverse();
  std::vector<double> ranges;
  for (std::size_t i = 0; i < surface.charts.size(); i += 1 + surface.charts.size() / kMostCharts) {
    const Chart& chart = surface.charts[i];
    if (chart.radius <= 0) continue;
    const auto node = static_cast<std::size_t>(surface.patches[static_cast<std::size_t>(chart.patch)].node);
    const Eigen::Vector3d p = T_camera_world * image.scene.T_world_node[node] * chart.center;
    const auto pixel = lens.project(p);
    if (pixel && pixel->x() >= 0 && pixel->y() >= 0 && pixel->x() < lens.width() && pixel->y() < lens.height())
      ranges.push_back(p.norm());
  }
  return ranges.empty() ? 1 : median(std::move(ranges));
}

double sight_angle(const Pose& T_world_eye, const Eigen::Vector3d& p_world, double range) {
  const Eigen::Vector3d way = T_world_eye.inverse() * p_world;
  return std::atan2(way.head<2>().norm(), std::max(range - way.z(), 1e-6));
}

double view_distance(const Pose& T_world_a, const Pose& T_world_b, double range) {
  const Eigen::Matrix3d R_a_b = T_world_a.linear().transpose() * T_world_b.linear();
  return std::hypot(sight_angle(T_world_a, T_world_b.translation(), range), Eigen::AngleAxisd(R_a_b).angle());
}

bool are_alike_in_hue(const cv::Mat& left, const cv::Mat& right) {
  const cv::Scalar a = cv::mean(left), b = cv::mean(right);
  double least = INFINITY, most = 0;
  for (int i = 0; i < std::min(left.channels(), right.channels()); ++i) {
    const double ratio = (a[i] + 1) / (b[i] + 1);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  return most < kAlikeInHue * least;
}

std::size_t least_needed(std::span<const ImageStand> images) {
  const auto distance = [&](std::size_t a, std::size_t b) {
    return view_distance(images[a].T_world_camera, images[b].T_world_camera, images[a].range);
  };
  for (std::size_t i = images.size() - 1; i > 0; --i)
    if (distance(0, i) > kFarthest) return i;
  std::size_t least = images.size() - 1;
  double smallest = INFINITY;
  for (std::size_t older = images.size() - 1; older > 1; --older)
    for (std::size_t newer = older - 1; newer > 0; --newer) {
      if (distance(newer, older) >= smallest) continue;
      smallest = distance(newer, older);
      least = images[newer].time - images[older].time > kRenewed ? older : newer;
    }
  return least;
}

KeptImages::KeptImages(int most, std::uint64_t bytes)
    : most_(static_cast<std::size_t>(std::max(most, 1))), bytes_(bytes) {}

void KeptImages::keep(std::shared_ptr<PublishedImage> newest) {
  std::erase_if(kept_, [&](const Kept& one) { return one.image->image.time >= newest->image.time; });
  const std::uint64_t bytes = std::max<std::uint64_t>(bytes_of(*newest), 1);
  kept_.insert(kept_.begin(), Kept{newest, Lease<PublishedImage>(newest)});
  while (kept_.size() > std::clamp<std::size_t>(bytes_ / bytes, 1, most_)) {
    std::vector<ImageStand> stands;
    for (const Kept& one : kept_)
      stands.push_back({one.image->image.time, one.image->image.T_world_camera, one.image->range});
    kept_.erase(kept_.begin() + static_cast<std::ptrdiff_t>(least_needed(stands)));
  }
}

std::vector<std::shared_ptr<const PublishedImage>> KeptImages::images() const {
  std::vector<std::shared_ptr<const PublishedImage>> out;
  for (const Kept& one : kept_) out.push_back(one.image);
  return out;
}

}  // namespace foresight
