// Reads a recorded run: a folder in the form of TUM RGB-D runs.
//
//   camera.yaml         ROS camera_info of the (left) camera         scene/camera_info.hpp
//   rgb.txt             time file                                    seconds, path in the folder
//   trajectory.txt      time tx ty tz qx qy qz qw                    T_world_camera
//   scene.ply or scene.yaml                                          scene/scene_reader.hpp
//   nodes.txt           time node tx ty tz qx qy qz qw               T_world_node; optional
//   registration.txt    time quality px                              how well a pose is known; optional
//   camera_right.yaml   camera_info and T_left_right                 optional, with
//   rgb_right.txt       time file
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "scene/pose_track.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// One image of a run, not yet read.
struct RunImage {
  RobotTime time;                                  ///< capture instant: mid-exposure of the centre row
  std::filesystem::path file;                      ///< absolute
  std::string stem;                                ///< file name without folder and extension; unique in its list
  Pose T_world_camera;                             ///< of this camera (left or right) at `time`
  StateStatus pose_status = StateStatus::invalid;  ///< exact or interpolated
  std::optional<double> predicted_px = {};         ///< expected error of the pose, where registration.txt tells
};

/// The left image and, where the run has a second camera that saw the same instant, the right one.
struct RunFrame {
  RunImage left;
  std::optional<RunImage> right;

  /// A right image belongs to the nearest left one if no more than this apart, nor more than half
  /// the median interval of the left images. Cameras that free-run at 30 Hz may be 17 ms apart;
  /// in 5 ms a hand that moves at 0.4 m/s covers 2 mm.
  static constexpr Duration kLargestOffset{5'000'000};
};

/// A run whose text files and model were read and checked. Immutable; safe to share.
class RunFolder {
 public:
  struct Options {
    /// Instead of the run's own; may lie anywhere. What it names must lie in its folder.
    std::optional<std::filesystem::path> scene;
  };

  /// Reads and checks everything but the pixels. Throws InputError naming file, line or field,
  /// and the cure. Times ascend strictly; every image exists and has a pose, the name (stem) of
  /// each is unique in its list; every path stays in the folder.
  static RunFolder open(const std::filesystem::path& root, const Options& options);

  const std::filesystem::path& root() const { return root_; }
  const Lens& lens_left() const { return lens_left_; }
  const std::optional<Lens>& lens_right() const { return lens_right_; }
  /// Right camera to left camera coordinates; identity for a single camera.
  const Pose& T_left_right() const { return T_left_right_; }
  const std::vector<RunFrame>& frames() const { return frames_; }
  const std::shared_ptr<const SceneModel>& scene() const { return scene_; }
  std::size_t unpaired_right() const { return unpaired_right_; }  ///< right images without a left one

  /// Where the scene stands at `time`: nodes with a track in nodes.txt follow it (held still
  /// at the nearer sample before its first, after its last, and in a gap too large to
  /// interpolate), their descendants without a track move along, the rest stands in its rest
  /// pose. The status is the worst of the tracked nodes: exact, interpolated, or predicted for
  /// one that is held; never invalid. A sample within `exact` of `time` is used as it is.
  SceneState state_at(RobotTime time, Duration exact = PoseTrack::kExact) const;

 private:
  std::filesystem::path root_;
  Lens lens_left_;
  std::optional<Lens> lens_right_;
  Pose T_left_right_ = Pose::Identity();
  std::vector<RunFrame> frames_;
  std::shared_ptr<const SceneModel> scene_;
  std::vector<std::optional<PoseTrack>> node_tracks_;  // one per node
  std::size_t unpaired_right_ = 0;
};

/// Reads the pixels of one PNG or JPEG: 8-bit grey (CV_8UC1) or 8-bit colour (CV_8UC3, BGR), of
/// the size of `lens`, as stored (EXIF orientation is not applied: the calibration speaks of the
/// sensor's rows). Throws InputError naming the file: missing, truncated or damaged, another
/// format, depth or channel count, another size.
cv::Mat read_run_image(const RunImage& image, const Lens& lens);

/// Reads every image once, on all cores, only to find the first (frame by frame, left before
/// right) that read_run_image refuses, and throws its error. Blocks; calls `progress(done, total)`
/// from the calling thread, with done == total at the end; it may be empty.
void check_run_images(const RunFolder& run, const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace foresight
