#include "session/run_recorder.hpp"

#include <sstream>

#include "common/error.hpp"
#include "common/partial_path.hpp"
#include "scene/files.hpp"
#include "scene/scene_writer.hpp"
#include "session/stop_latency.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

FolderForm form_of(const RecorderOptions& options) {
  FolderForm out = RunRecorder::form();
  out.irreplaceable = options.irreplaceable;
  return out;
}

constexpr int kCompression = 1;  // more takes longer than 33 ms

}  // namespace

fs::path beside_run(const fs::path& run, const char* ending) {
  return without_end_slash(run).concat(ending);
}

FolderForm RunRecorder::form() {
  return {kMarker, kMarkerLine,
          [](const fs::path& relative) { return relative == kMarker || is_file_of_run(relative); }};
}

RunRecorder::RunRecorder(const fs::path& out, RecorderOptions options, std::shared_ptr<FrameQueue> frames)
    : options_(std::move(options)),
      frames_(std::move(frames)),
      target_(out, form_of(options_)),
      run_(target_.path(), options_.lenses.left, "left") {
  target_.require_space(options_.spare_bytes);
  run_.add_right_camera(options_.lenses.right, options_.lenses.T_left_right, "right");
  if (options_.scene) write_model(target_.path(), *options_.scene);
  if (options_.tags) fs::copy_file(*options_.tags, target_.path() / "tags.txt");
  writer_ = std::jthread([this] { run(); });
}

RunRecorder::~RunRecorder() {
  stopped_ = true;  // nobody wants what still waits
  join();
  if (counts_.written > 0 && options_.irreplaceable) target_.keep();
}

void RunRecorder::join() {
  frames_->close();
  if (writer_.joinable()) writer_.join();
}

void RunRecorder::check(const ColourImage& image, const Lens& lens, const char* side, RobotTime last) const {
  if (image.bgr.cols != lens.width() || image.bgr.rows != lens.height())
    throw InputError(std::string("the ") + side + " camera",
                     "delivers " + std::to_string(image.bgr.cols) + " x " + std::to_string(image.bgr.rows) +
                         " px, but its lens was calibrated at " + std::to_string(lens.width()) + " x " +
                         std::to_string(lens.height()),
                     "set the camera to the size of its calibration, or calibrate it anew");
  if (image.time <= last)
    throw InputError(std::string("the ") + side + " camera", "delivers images whose times do not ascend",
                     "check the clock of the camera's driver");
}

std::string RunRecorder::fault() const {
  const std::lock_guard lock(mutex_);
  if (failure_) try {
      std::rethrow_exception(failure_);
    } catch (const std::exception& error) {
      return error.what();
    }
  return "";
}

RecorderCounts RunRecorder::counts() const {
  const std::lock_guard lock(mutex_);
  RecorderCounts out = counts_;
  out.dropped = frames_->dropped();
  return out;
}

void RunRecorder::run() noexcept {
  for (;;) {
    const auto frame = frames_->take(kStopLatency);
    if (!frame && frames_->closed()) return;
    if (!frame || stopped()) continue;  // what waits goes all the same: nobody may wait for room for ever
    try {
      write(**frame);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      stopped_ = true;
    }
  }
}

void RunRecorder::write(const LiveFrame& frame) {
  std::error_code error;
  const fs::space_info space = fs::space(target_.path(), error);
  if (!error && static_cast<double>(space.available) < options_.spare_bytes)
    throw RuntimeFailure("the disk of " + target_.target().string() + " is nearly full", "free some disk space");
  check(frame.pair.left, options_.lenses.left, "left", last_left_);
  check(frame.pair.right, options_.lenses.right, "right", last_right_);
  last_left_ = frame.pair.left.time;
  last_right_ = frame.pair.right.time;
  const bool placed = frame.posed || !options_.posed;
  if (options_.posed && frame.predicted_px)
    run_.add_registration(frame.pair.left.time, frame.quality, *frame.predicted_px);
  write_poses(frame);
  const std::uint64_t number = counts().written;
  const auto image_of = [&](bool right) -> const ColourImage& { return right ? frame.pair.right : frame.pair.left; };
  for (const bool right : {false, true})
    run_.write_image(RunWriter::image_name(right, number), image_of(right).bgr, kCompression);
  for (const bool right : {false, true}) {
    const std::string name = RunWriter::image_name(right, number);
    placed ? run_.add_image(right, image_of(right).time, name) : run_.add_unplaced(image_of(right).time, name);
  }
  run_.flush();
  const std::lock_guard lock(mutex_);
  ++counts_.written;
  if (!placed) ++counts_.without_pose;
}

/// Of both instants, where they differ: a reader then has the right image's pose without guessing between two left
/// ones.
void RunRecorder::write_poses(const LiveFrame& frame) {
  const bool posed = frame.posed && options_.posed;
  const auto write_side = [&](bool right) {
    std::optional<Pose> T_world_left;
    if (posed && !right) T_world_left = frame.posed->left.T_world_camera;
    if (posed && right) T_world_left = frame.posed->right->T_world_camera * options_.lenses.T_left_right.inverse();
    write_poses(right ? frame.pair.right.time : frame.pair.left.time, T_world_left, frame.scene[right ? 1 : 0]);
  };
  const bool right_first = frame.pair.right.time < frame.pair.left.time;
  write_side(right_first);
  write_side(!right_first);
}

void RunRecorder::write_poses(RobotTime time, const std::optional<Pose>& T_world_left, const SceneState& scene) {
  if (time <= last_pose_) return;  // readers want ascending times
  last_pose_ = time;
  if (T_world_left) run_.add_pose(time, *T_world_left);
  if (!options_.scene) return;
  const auto& nodes = options_.scene->nodes();
  for (std::size_t i = 0; i < std::min(nodes.size(), scene.T_world_node.size()); ++i)
    if (nodes[i].may_move) run_.add_node(time, nodes[i].name, scene.T_world_node[i]);
}

RecorderCounts RunRecorder::finish(const std::string& remarks) {
  join();
  const RecorderCounts counts = this->counts();
  if (counts.written == 0) {
    if (failure_) std::rethrow_exception(failure_);
    throw RuntimeFailure("no pair of images came: nothing was recorded",
                         "see what `foresight doctor` says of the cameras");
  }
  try {
    close_folder(counts, remarks);
  } catch (const RuntimeFailure& failure) {
    throw RuntimeFailure("what was recorded is in " + target_.keep().string(), failure.what());
  }
  return counts;
}

void RunRecorder::close_folder(const RecorderCounts& counts, const std::string& remarks) {
  run_.flush();
  std::ostringstream text;
  text << kMarkerLine << "\npairs: " << counts.written << "\ndropped_by_disk: " << counts.dropped
       << "\nwithout_pose: " << counts.without_pose << "\n"
       << remarks;
  write_text(target_.path() / kMarker, text.str());
  try {
    target_.commit();
  } catch (const fs::filesystem_error& e) {
    throw RuntimeFailure("cannot write " + target_.target().string() + " (" + e.code().message() + ")",
                         "free some disk space");
  }
}

}  // namespace foresight
