#include "session/run_recorder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "common/error.hpp"
#include "sim/run_files.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

std::string time_text(RobotTime time) {
  return fmt::format("{}.{:09}", static_cast<long long>(time.ns / 1'000'000'000),
                     static_cast<long long>(time.ns % 1'000'000'000));
}

void open_list(std::ofstream& stream, const fs::path& file, const char* heading) {
  stream.open(file);
  stream << "# " << heading << "\n";
}

[[noreturn]] void cannot_write(const fs::path& target, const char* why) {
  throw RuntimeFailure("cannot write " + target.string() + " (" + why + ")", "free some disk space");
}

}  // namespace

fs::path beside_run(fs::path out, const char* ending) {
  if (!out.has_filename()) out = out.parent_path();
  return out.concat(ending);
}

RunRecorder::RunRecorder(const fs::path& out, RecorderOptions options)
    : options_(std::move(options)), target_(out, kMarker, kMarkerLine) {
  target_.require_space(options_.spare_bytes);
  const fs::path& folder = target_.path();
  for (const char* images : {"rgb", "rgb_right"}) fs::create_directory(folder / images);
  sim::write_text(folder / "camera.yaml", sim::camera_yaml(options_.left, "left", nullptr));
  sim::write_text(folder / "camera_right.yaml", sim::camera_yaml(options_.right, "right", &options_.T_left_right));
  if (options_.write_scene) options_.write_scene(folder);
  open_list(rgb_, folder / "rgb.txt", "time[s] file");
  open_list(rgb_right_, folder / "rgb_right.txt", "time[s] file");
  if (options_.tags) fs::copy_file(*options_.tags, folder / "tags.txt");
  if (options_.registration)
    open_list(registration_, folder / "registration.txt",
              "time[s] quality predicted[px]: of the left image's pose, RMS over the image");
  if (options_.poses || options_.registration)
    open_list(trajectory_, folder / "trajectory.txt",
              "time[s] tx ty tz[m] qx qy qz qw: T_world_camera of the left camera");
  writer_ = std::jthread([this] { run(); });
}

RunRecorder::~RunRecorder() {
  {
    const std::lock_guard lock(mutex_);
    jobs_.clear();
  }
  join();
}

void RunRecorder::join() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_one();
  if (writer_.joinable()) writer_.join();
}

void RunRecorder::check(const ColourImage& image, const Lens& lens, const char* side, RobotTime last) const {
  if (image.bgr.cols != lens.width() || image.bgr.rows != lens.height())
    throw InputError(std::string("the ") + side + " camera",
                     fmt::format("delivers {} x {} px, but its lens was calibrated at {} x {}", image.bgr.cols,
                                 image.bgr.rows, lens.width(), lens.height()),
                     "set the camera to the size of its calibration, or calibrate it anew");
  if (image.time <= last)
    throw InputError(std::string("the ") + side + " camera", "delivers images whose times do not ascend",
                     "check the clock of the camera's driver");
}

void RunRecorder::add(const StereoPair& pair) {
  check(pair.left, options_.left, "left", last_left_);
  check(pair.right, options_.right, "right", last_right_);
  last_left_ = pair.left.time;
  last_right_ = pair.right.time;
  Job job{pair, {}, {}, options_.registration ? options_.registration() : PairRegistration{}};
  if (options_.poses) {
    job.left = options_.poses(pair.left.time);
    if (pair.right.time != pair.left.time) job.right = options_.poses(pair.right.time);
  }
  {
    std::unique_lock lock(mutex_);
    if (options_.waits) written_.wait(lock, [this] { return stopped() || jobs_.size() < options_.waiting; });
    if (stopped()) return;
    if (jobs_.size() >= options_.waiting) {
      ++counts_.dropped;
      return;
    }
    jobs_.push_back(std::move(job));
  }
  changed_.notify_one();
}

RecorderCounts RunRecorder::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void RunRecorder::run() noexcept {
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closing_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    const Job job = jobs_.front();  // keeps its place, so that `waiting` counts it
    lock.unlock();
    if (!stopped()) {
      try {
        write(job);
      } catch (...) {
        failure_ = std::current_exception();
        failed_ = true;
      }
    }
    lock.lock();
    if (!jobs_.empty()) jobs_.pop_front();
    if (!stopped()) ++counts_.written;
    written_.notify_one();
  }
}

void RunRecorder::write(const Job& job) {
  std::error_code error;
  const fs::space_info space = fs::space(target_.path(), error);
  if (!error && static_cast<double>(space.available) < options_.spare_bytes) {
    full_ = true;
    return;
  }
  if (options_.slowed_by.count() > 0) std::this_thread::sleep_for(options_.slowed_by);
  const bool placed = job.registration ? write_registered(job) : write_given(job);
  write_image("rgb", job.pair.left, placed ? rgb_ : unplaced_);
  write_image("rgb_right", job.pair.right, placed ? rgb_right_ : unplaced_);
  if (placed) return;
  const std::lock_guard lock(mutex_);
  ++counts_.without_pose;
}

bool RunRecorder::write_given(const Job& job) {
  const bool right_first = job.right && job.pair.right.time < job.pair.left.time;
  if (right_first) write_poses(job.pair.right.time, *job.right);
  if (job.left) write_poses(job.pair.left.time, *job.left);
  if (job.right && !right_first) write_poses(job.pair.right.time, *job.right);
  return true;
}

/// The right image's pose follows from those of the left ones around it: the first pair's has none where it came first.
bool RunRecorder::write_registered(const Job& job) {
  const RobotTime time = job.pair.left.time;
  const bool first = last_pose_.ns == INT64_MIN;
  const RegisteredPose found = job.registration(job.pair);
  registration_ << time_text(time) << ' ' << found.quality << ' ' << fmt::format("{:.4f}", found.predicted_px) << '\n';
  if (found.quality == "lost") return false;
  RecordedPoses poses = job.left.value_or(RecordedPoses{});
  poses.T_world_left = found.T_world_left;
  write_poses(time, poses);
  return !first || job.pair.right.time >= time;
}

void RunRecorder::write_image(const std::string& folder, const ColourImage& image, std::ofstream& list) {
  const std::string name = folder + fmt::format("/{:06}.png", static_cast<unsigned long long>(counts().written));
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image.bgr, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});  // more takes longer than 33 ms
  sim::write_bytes(target_.path() / name, bytes.data(), bytes.size());
  if (!list.is_open())
    open_list(list, target_.path() / "without_pose.txt", "time[s] file: of pairs for which there is no pose");
  list << time_text(image.time) << ' ' << name << '\n';
}

void RunRecorder::write_poses(RobotTime time, const RecordedPoses& poses) {
  if (time <= last_pose_) return;  // readers want ascending times
  last_pose_ = time;
  trajectory_ << time_text(time) << ' ' << sim::pose_text(poses.T_world_left) << '\n';
  if (!poses.T_world_node.empty() && !nodes_.is_open())
    open_list(nodes_, target_.path() / "nodes.txt", "time[s] node tx ty tz[m] qx qy qz qw: T_world_node");
  for (const auto& [node, pose] : poses.T_world_node)
    nodes_ << time_text(time) << ' ' << node << ' ' << sim::pose_text(pose) << '\n';
}

RecorderCounts RunRecorder::finish(const std::string& remarks) {
  join();
  if (failure_) std::rethrow_exception(failure_);
  if (counts_.written == 0)
    throw RuntimeFailure(full_ ? "the disk of " + target_.target().string() + " is full: nothing was recorded"
                               : "no pair of images came: nothing was recorded",
                         full_ ? "free some disk space" : "see what `foresight doctor` says of the cameras");
  for (std::ofstream* list : {&rgb_, &rgb_right_, &unplaced_, &trajectory_, &nodes_, &registration_}) {
    if (!list->is_open()) continue;
    list->close();
    if (!*list) cannot_write(target_.target(), std::strerror(errno));
  }
  sim::write_text(target_.path() / kMarker, fmt::format("{}\npairs: {}\ndropped_by_disk: {}\nwithout_pose: {}\n",
                                                        kMarkerLine, static_cast<unsigned long long>(counts_.written),
                                                        static_cast<unsigned long long>(counts_.dropped),
                                                        static_cast<unsigned long long>(counts_.without_pose)) +
                                                remarks);
  try {
    target_.commit();
  } catch (const fs::filesystem_error& e) {
    cannot_write(target_.target(), e.code().message().c_str());
  }
  return counts_;
}

}  // namespace foresight
