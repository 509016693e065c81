// Writes what a stereo camera sees as a run that scene/run_folder.hpp reads.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/lens.hpp"
#include "drivers/camera/stereo_pairing.hpp"
#include "scene/scene_model.hpp"
#include "sim/target_folder.hpp"

namespace foresight {

/// Where camera and scene were at an instant.
struct RecordedPoses {
  Pose T_world_left = Pose::Identity();
  std::vector<std::pair<std::string, Pose>> T_world_node;  ///< of nodes that move, by name
};

/// What a registration says of a pair's left image.
struct RegisteredPose {
  Pose T_world_left = Pose::Identity();
  double predicted_px = 0;  ///< expected error, RMS over the image
  std::string quality;      ///< one word; "lost": there is no pose
};
using PairRegistration = std::function<RegisteredPose(const StereoPair&)>;

struct RecorderOptions {
  Lens left, right;
  Pose T_left_right = Pose::Identity();
  /// Poses at a capture time; called on the thread of add(). Empty: the run gets no trajectory.txt, and whoever
  /// replays it has to add one.
  std::function<RecordedPoses(RobotTime)> poses;
  /// Called on the thread of add(), it takes note of what encoders have told so far, and is quick. What it returns is
  /// called on the writing thread, pair after pair in their order, though not for those that were dropped. Its poses
  /// go before those of `poses`; of each image there is a line in registration.txt. Empty: poses come from `poses`.
  std::function<PairRegistration()> registration;
  std::optional<std::filesystem::path> tags;  ///< map of tags, copied into the run as tags.txt
  /// Writes the scene's files into the folder; empty: the run gets none (`foresight replay --scene`).
  std::function<void(const std::filesystem::path&)> write_scene;
  std::size_t waiting = 8;    ///< pairs in memory, at most; > 0
  bool waits = false;         ///< add() waits for room instead of dropping: for stepped time, where it costs nothing
  double spare_bytes = 16e6;  ///< of the disk that are left free
};

/// What is recorded beside the folder `out`: "run/" and "-joints.csv" give "run-joints.csv".
std::filesystem::path beside_run(std::filesystem::path out, const char* ending);

struct RecorderCounts {
  std::uint64_t written = 0;  ///< pairs
  std::uint64_t dropped = 0;  ///< pairs that came while `waiting` others waited for the disk
  /// Of the written ones, those for which the registration had no pose: they are in without_pose.txt, and no frames of
  /// the run.
  std::uint64_t without_pose = 0;
};

/// add() and finish() from one thread; a thread of its own encodes and writes. All goes into a neighbour folder that
/// takes the target's name in finish(); without finish(), or where it throws, nothing stays.
class RunRecorder {
 public:
  static constexpr const char* kMarker = "record.yaml";  ///< tells our folders from those of others
  static constexpr const char* kMarkerLine = "generator: foresight record";

  /// Throws InputError (a folder of someone else, a place that cannot be written) or RuntimeFailure (disk full).
  RunRecorder(const std::filesystem::path& out, RecorderOptions options);
  ~RunRecorder();

  /// Never waits for the disk, unless told to: a pair that finds no room is dropped and counted. Images must have the
  /// lenses' sizes, and times must ascend: others are InputErrors, which name the side.
  void add(const StereoPair& pair);
  /// The disk is nearly full, or cannot be written: what comes now is not recorded. finish() tells.
  bool stopped() const { return full_ || failed_; }
  bool disk_full() const { return full_; }
  RecorderCounts counts() const;

  /// Waits until all is written and gives the folder its name. `remarks`: lines of YAML for record.yaml. Throws
  /// RuntimeFailure where there is no pair, or something could not be written.
  RecorderCounts finish(const std::string& remarks);

 private:
  struct Job {
    StereoPair pair;
    std::optional<RecordedPoses> left, right;  // at the capture times of the two
    PairRegistration registration;
  };
  void check(const ColourImage& image, const Lens& lens, const char* side, RobotTime last) const;
  void run() noexcept;
  void write(const Job& job);
  /// False: the pair has no pose.
  bool write_registered(const Job& job);
  bool write_given(const Job& job);
  void write_poses(RobotTime time, const RecordedPoses& poses);
  void write_image(const std::string& folder, const ColourImage& image, std::ofstream& list);
  void join();

  RecorderOptions options_;
  sim::TargetFolder target_;
  std::ofstream rgb_, rgb_right_, unplaced_, trajectory_, nodes_, registration_;
  RobotTime last_left_{INT64_MIN}, last_right_{INT64_MIN}, last_pose_{INT64_MIN};

  mutable std::mutex mutex_;  // jobs_, counts_, closing_
  std::condition_variable changed_, written_;
  std::deque<Job> jobs_;
  RecorderCounts counts_;
  bool closing_ = false;
  std::atomic<bool> full_ = false, failed_ = false;
  std::exception_ptr failure_;  // of the writer; read after it ended
  std::jthread writer_;
};

}  // namespace foresight
