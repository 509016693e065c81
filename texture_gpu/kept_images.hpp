// Images that are kept after newer ones have come, so that views can look points up in those that were taken from a
// side that is more like the eye's.
#pragma once

#include <span>
#include <vector>

#include "texture_gpu/published_image.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight {

/// Median distance of what the image's camera may have in view, whether hidden or not, metres; 1 where that is nothing.
double typical_range(const SurfacePatches& surface, const Lens& lens, const PosedImage& image);

/// The angle between the lines of sight of an eye and of another place to what lies `range` metres before the eye.
/// Radians. A way along the line of sight does not change its direction.
double sight_angle(const Pose& T_world_eye, const Eigen::Vector3d& p_world, double range);

/// How differently two cameras see what is `range` metres away: their sight_angle(), and how far their axes are
/// turned against each other. Radians.
double view_distance(const Pose& T_world_a, const Pose& T_world_b, double range);

/// Whether two cameras that see about the same show it in the same hue: red, green and blue are as bright beside each
/// other, on the whole, but for a tenth.
bool are_alike_in_hue(const cv::Mat& left, const cv::Mat& right);

/// What counts about an image that is kept.
struct ImageStand {
  RobotTime time;
  Pose T_world_camera;
  double range = 1;  ///< as PublishedImage::range
};

/// Of images, newest first and at least two, the one to let go of; never the newest. First one that sees something else
/// than the newest does, by more than a radian. Else of the two that see most alike, the newest left out, the
/// older one if it is older by a second, so that places which the camera comes back to are renewed; if not the newer
/// one, as else images would move along with the camera, instead of staying behind it.
std::size_t least_needed(std::span<const ImageStand> images);

/// Belongs to the texture thread.
class KeptImages {
 public:
  /// Up to `most`, as far as they fit into `bytes`.
  KeptImages(int most, std::uint64_t bytes);

  /// From now on it is one of them. Those that are not older than it are forgotten: images came in another order than
  /// they were taken, or clocks have changed.
  void keep(std::shared_ptr<PublishedImage> newest);
  /// Newest first.
  std::vector<std::shared_ptr<const PublishedImage>> images() const;

 private:
  struct Kept {
    std::shared_ptr<const PublishedImage> image;
    Lease<PublishedImage> lease;  // nothing else is written to its place
  };
  std::size_t most_;
  std::uint64_t bytes_;
  std::vector<Kept> kept_;
};

}  // namespace foresight
