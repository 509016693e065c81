// Writes what a stereo camera sees as a run that scene/run_folder.hpp reads.
#pragma once

#include <atomic>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "calibration/registration/tag_correction.hpp"
#include "scene/run_writer.hpp"
#include "scene/target_folder.hpp"
#include "session/live_frames.hpp"

namespace foresight {

struct RecorderOptions {
  StereoLenses lenses;
  /// Null: the run gets none (`foresight replay --scene`). Poses of nodes that may move are written, image by image.
  std::shared_ptr<const SceneModel> scene = {};
  /// Frames have poses; those without are kept apart from the run. False: all are written without a trajectory.txt, and
  /// whoever replays the run has to add one. What moves in the scene is written all the same, where it is known.
  bool posed = true;
  std::optional<std::filesystem::path> tags = {};  ///< map of tags, copied into the run as tags.txt
  double spare_bytes = 16e6;                       ///< of the disk that are left free
  bool irreplaceable = true;                       ///< FolderForm::irreplaceable; false: made of a file that stays
};

/// What is recorded beside the folder `run`: "run/" and "-joints.csv" give "run-joints.csv".
std::filesystem::path beside_run(const std::filesystem::path& run, const char* ending);

struct RecorderCounts {
  std::uint64_t written = 0;  ///< pairs
  std::uint64_t dropped = 0;  ///< pairs that came while as many others as there is room for waited for the disk
  /// Of the written ones, those that came without a pose: they are in without_pose.txt, and no frames of the run.
  std::uint64_t without_pose = 0;
};

/// Only writes: a thread of its own takes frames from its queue, encodes and stores them. All goes into a neighbour
/// folder (unfinished_beside) that takes the target's name in finish(). There all pairs that count are complete, so
/// that a program that is killed leaves a run that can be read; without a pair, nothing stays. One thread constructs,
/// finishes and destroys it.
class RunRecorder {
 public:
  static constexpr const char* kMarker = "record.yaml";  ///< tells our folders from those of others
  static constexpr const char* kMarkerLine = "generator: foresight record";
  static FolderForm form();                ///< of a folder that a new recording may replace
  static constexpr std::size_t kRoom = 8;  ///< pairs in memory: a quarter of a second

  /// `frames`: LiveFrames::subscribe(). Throws InputError (a folder of someone else, a place that cannot be written) or
  /// RuntimeFailure (disk full).
  RunRecorder(const std::filesystem::path& out, RecorderOptions options, std::shared_ptr<FrameQueue> frames);
  ~RunRecorder();

  /// What comes now is not recorded: see fault(). Any thread.
  bool stopped() const { return stopped_; }
  /// "", or why it stopped: the disk is nearly full or cannot be written, an image has not its lens's size, or times do
  /// not ascend. Any thread.
  std::string fault() const;
  RecorderCounts counts() const;

  /// Writes what is in the queue, which nobody fills any more, and gives the folder its name: what came before a
  /// fault(), too. `remarks`: lines of YAML for record.yaml. Throws where there is no pair: what the fault was, or
  /// RuntimeFailure. Throws RuntimeFailure where the folder cannot be finished: it says where the pairs are.
  RecorderCounts finish(const std::string& remarks);

 private:
  void check(const ColourImage& image, const Lens& lens, const char* side, RobotTime last) const;
  void run() noexcept;
  void write(const LiveFrame& frame);
  void close_folder(const RecorderCounts& counts, const std::string& remarks);
  void write_poses(const LiveFrame& frame);
  void write_poses(RobotTime time, const std::optional<Pose>& T_world_left, const SceneState& scene);
  void join();

  RecorderOptions options_;
  std::shared_ptr<FrameQueue> frames_;
  TargetFolder target_;
  RunWriter run_;
  RobotTime last_left_{INT64_MIN}, last_right_{INT64_MIN}, last_pose_{INT64_MIN};

  mutable std::mutex mutex_;  // the next two
  RecorderCounts counts_;
  std::exception_ptr failure_;  // of the writer
  std::atomic<bool> stopped_ = false;
  std::jthread writer_;
};

}  // namespace foresight
