// AprilTags on a wall and on a table, as a camera sees them: quick pictures for tests and benches of
// the registration.
#pragma once

#include <opencv2/core.hpp>

#include "common/lens.hpp"
#include "sim/print.hpp"

namespace foresight::sim {

/// Tags of the family tag36h11 on grey planes with some wood grain. Immutable; safe to share.
class TagRoom {
 public:
  struct Tag {
    int id = 0;
    /// Tag frame: origin in the middle, x right and y down in print, z into what it is stuck to.
    Pose T_world_tag = Pose::Identity();
    double size_m = 0.1;  ///< side of the black border
  };

  explicit TagRoom(const std::vector<Tag>& tags);

  /// The mock lab's head sees this: tags on the table (z = 0) and the wall behind it (x = 0.6).
  static std::vector<Tag> lab_tags();

  /// Corners of the black borders, world; lower left, lower right, upper right, upper left in print.
  TagCorners corners() const;

  /// CV_64FC3: rays through the corners of the lens's pixels, one more than pixels each way.
  static cv::Mat corner_rays(const Lens& lens);

  /// CV_8UC1; box-filtered over 3 x 3 rays a pixel, normal noise of `noise` 8-bit values. `rays`:
  /// corner_rays(); the lens must see all of its image.
  cv::Mat picture(const cv::Mat& rays, const Pose& T_world_camera, double noise, unsigned seed) const;

 private:
  struct Sheet {
    Tag tag;
    Pose T_tag_world;
    cv::Mat bits;  // CV_8UC1, one pixel a bit, with the white border
  };
  /// What a ray meets of table and wall.
  struct Place {
    Eigen::Vector3d p;
    bool on_table = false, nowhere = false;
  };
  static Place met(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);
  static double unprinted(const Place& place);
  bool is_near_a_tag(const Place& place, double within) const;
  double grey(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  std::vector<Sheet> sheets_;
};

}  // namespace foresight::sim
