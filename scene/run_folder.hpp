// Reads a recorded run: a folder in the form of TUM RGB-D runs.
//
//   camera.yaml, rgb.txt, trajectory.txt, scene.ply or scene.yaml;
//   optional: nodes.txt, camera_right.yaml with rgb_right.txt
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// One image of a run, not yet read.
struct RunImage {
  RobotTime time;               ///< capture instant: mid-exposure of the centre row
  std::filesystem::path file;   ///< absolute
  std::string stem;             ///< file name without folder and extension; unique in its list
  Pose T_world_camera;          ///< of this camera (left or right) at `time`
  StateStatus pose_status = StateStatus::invalid;  ///< exact or interpolated
};

/// The left image and, where the run has a second camera that saw the same instant, the right one.
struct RunFrame {
  RunImage left;
  std::optional<RunImage> right;
};

/// A pose over time: `samples` strictly ascending in time.
class PoseTrack {
 public:
  struct Sample {
    RobotTime time;
    Pose pose;
  };
  struct Answer {
    Pose pose = Pose::Identity();
    StateStatus status = StateStatus::invalid;
  };
  static constexpr Duration kExact{1'000'000};     ///< a sample this near is used as it is
  static constexpr Duration kLargestGap{200'000'000};  ///< a larger gap is not interpolated

  PoseTrack() = default;
  explicit PoseTrack(std::vector<Sample> samples);

  const std::vector<Sample>& samples() const { return samples_; }

  /// The nearest sample where it lies within kExact, else linear (position) and spherical
  /// (rotation) interpolation over a gap of up to kLargestGap, else `invalid`.
  Answer at(RobotTime time) const;

 private:
  std::vector<Sample> samples_;
};

/// A run whose text files and model were read and checked. Immutable; safe to share.
class RunFolder {
 public:
  struct Options {
    std::optional<std::filesystem::path> scene;  ///< instead of the run's own; may lie anywhere
  };

  /// Reads and checks everything but the pixels. Throws InputError naming file, line or field,
  /// and the cure. Times ascend strictly; every image has a pose; every path stays in the folder.
  static RunFolder open(const std::filesystem::path& root, const Options& options);

  const std::filesystem::path& root() const { return root_; }
  const Lens& lens_left() const { return lens_left_; }
  const std::optional<Lens>& lens_right() const { return lens_right_; }
  const Pose& T_left_right() const { return T_left_right_; }  ///< identity for a single camera
  const std::vector<RunFrame>& frames() const { return frames_; }
  const std::shared_ptr<const SceneModel>& scene() const { return scene_; }
  std::size_t unpaired_right() const { return unpaired_right_; }  ///< right images without a left one

  /// Where the scene stands at `time`: nodes with a track in nodes.txt follow it (held still
  /// before its first and after its last sample), their descendants without a track move along,
  /// the rest stands in its rest pose.
  SceneState state_at(RobotTime time) const;

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

/// Reads the pixels of one image: 8-bit grey (CV_8UC1) or 8-bit colour (CV_8UC3, BGR), of the
/// size of `lens`. Throws InputError naming the file: missing, truncated or damaged, another
/// depth or channel count, another size.
cv::Mat read_run_image(const RunImage& image, const Lens& lens);

/// Reads every image once, on all cores, only to find the first that read_run_image refuses.
/// Calls `progress(done, total)` from the calling thread. Throws that InputError.
void check_run_images(const RunFolder& run, const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace foresight
