// Writes a recorded run: the files that scene/run_folder.hpp reads.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "scene/camera_info.hpp"

namespace foresight {

/// The files of a run but for its scene (scene/scene_writer.hpp), row by row. Times ascend in each list; what is never
/// added has no file. Rows are kept until flush(). Whatever is read back is what was added: numbers are written with
/// all digits that count. One thread; write_image() any.
class RunWriter {
 public:
  /// `folder` exists. Writes camera.yaml. Throws RuntimeFailure where that cannot be written.
  RunWriter(std::filesystem::path folder, const Lens& left, const std::string& name);

  /// Writes camera_right.yaml. Throws as the constructor.
  void add_right_camera(const Lens& right, const Pose& T_left_right, const std::string& name);

  /// "rgb/000012.png", or in rgb_right/.
  static std::string image_name(bool right, std::uint64_t number);
  /// The file of an image, BGR or grey, as PNG; `compression` 0 .. 9, or OpenCV's own choice. Throws RuntimeFailure.
  void write_image(const std::string& name, const cv::Mat& pixels, std::optional<int> compression = {}) const;

  /// Rows of rgb.txt (rgb_right.txt), without_pose.txt, trajectory.txt, nodes.txt and registration.txt.
  void add_image(bool right, RobotTime time, const std::string& name);
  void add_unplaced(RobotTime time, const std::string& name);
  void add_pose(RobotTime time, const Pose& T_world_left);
  void add_node(RobotTime time, const std::string& node, const Pose& T_world_node);
  void add_registration(RobotTime time, std::string_view quality, double predicted_px);

  /// Writes the rows that were added since the last time, those that name images after all others: what is in the
  /// files is a run at any instant. Throws RuntimeFailure where they cannot be written; then they are dropped, and the
  /// files have whole rows.
  void flush();

  const std::filesystem::path& folder() const { return folder_; }

 private:
  struct List {
    const char *file, *heading;
    std::string rows = {};    // that flush() will write
    std::uintmax_t size = 0;  // bytes that it has written
  };
  std::string& row(List& list, RobotTime time);
  void write(List& list);
  std::array<List*, 6> lists() { return {&registration_, &nodes_, &trajectory_, &unplaced_, &right_, &left_}; }

  std::filesystem::path folder_;
  List left_{"rgb.txt", "time[s] file"}, right_{"rgb_right.txt", "time[s] file"};
  List unplaced_{"without_pose.txt", "time[s] file: of pairs for which there is no pose"};
  List trajectory_{"trajectory.txt", "time[s] tx ty tz[m] qx qy qz qw: T_world_camera of the left camera"};
  List nodes_{"nodes.txt", "time[s] node tx ty tz[m] qx qy qz qw: T_world_node"};
  List registration_{"registration.txt", "time[s] quality predicted[px]: of the left image's pose, RMS over the image"};
};

/// Whether a run that was written here, and its scene (scene/scene_writer.hpp), may have a file of this name.
bool is_file_of_run(const std::filesystem::path& relative);

/// Seconds to the nanosecond: "12.000000001".
std::string time_text(RobotTime time);

/// "tx ty tz qx qy qz qw".
std::string pose_text(const Pose& pose);

}  // namespace foresight
