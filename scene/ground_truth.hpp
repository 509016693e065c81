// Reads the truth that a synthetic run keeps of its images: which surface point each pixel sees.
//
//   truth/truth.yaml          depth_unit_m, readout_s (first to last row), nodes (how many)
//   truth/trajectory.txt      time tx ty tz qx qy qz qw         true T_world_camera of this camera
//   truth/depth/<stem>.png    16 bit: depth along the optical axis in units of depth_unit_m; 0: nothing
//   truth/node/<stem>.png     16 bit: index of the node in the run's SceneModel, plus 1; 0: nothing
//   truth_right/              the same for the right camera
//
// The ray of a pixel goes through its centre, at the middle of the exposure of its row. An image's
// time is that of its centre row; with a readout of zero it is every row's.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/run_folder.hpp"

namespace foresight {

/// Immutable; safe to share between threads. The run must outlive it.
class GroundTruth {
 public:
  struct Point {
    int node = -1;           ///< index into the run's SceneModel
    Eigen::Vector3d p_node;  ///< true surface point in the node's own frame at the capture instant, metres
  };

  /// The truth of one image. Owns its pixels.
  class Surface {
   public:
    int width() const { return depth_.cols; }
    int height() const { return depth_.rows; }
    /// What the centre of pixel (u, v) sees; nothing where there is no surface. u and v must lie in the image.
    std::optional<Point> at(int u, int v) const;
    /// Depth along the optical axis, metres; 0 where there is nothing.
    double depth(int u, int v) const { return unit_ * depth_.at<std::uint16_t>(v, u); }

   private:
    friend class GroundTruth;
    Lens lens_;
    double unit_ = 0;
    cv::Mat depth_, node_;                          // CV_16UC1
    std::vector<std::vector<Pose>> T_node_camera_;  // per row, or one for all; per node
  };

  static bool exists(const RunFolder& run);

  /// Reads everything but the pixels. Throws InputError naming file and field: missing, odd, or
  /// made of a scene with another number of nodes.
  static GroundTruth open(const RunFolder& run);

  /// The truth of image `frame` of the run's frames(), of the left or the right camera. Throws
  /// InputError naming the file: missing, damaged, another size or depth, an unknown node; and
  /// where the run has no right image of this frame, or no truth of it.
  Surface read(std::size_t frame, bool right) const;

  /// True pose of that camera at its image's time. Throws like read().
  Pose T_world_camera(std::size_t frame, bool right) const;

 private:
  struct Camera {
    std::filesystem::path folder;
    double unit = 0;  // metres
    Duration readout{0};
    PoseTrack track;
  };
  explicit GroundTruth(const RunFolder& run) : run_(&run) {}
  static Camera open_camera(const RunFolder& run, bool right);
  const Camera& camera(bool right) const;
  const RunImage& image(std::size_t frame, bool right) const;
  Pose pose_at(const Camera& camera, RobotTime time) const;

  const RunFolder* run_;
  Camera left_;
  std::optional<Camera> right_;
};

}  // namespace foresight
