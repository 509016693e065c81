#include "link/recording/run_export.hpp"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "link/dds/topics.hpp"
#include "link/messages/cdr.hpp"
#include "link/recording/line_recorder.hpp"
#include "link/recording/mcap_reader.hpp"
#include "link/recording/rig_files.hpp"
#include "link/robot_side/robot_messages.hpp"
#include "scene/image_structure.hpp"
#include "session/recorder_options.hpp"

namespace foresight::link {
namespace {

namespace fs = std::filesystem;

Pose pose_of(const PoseMessage& message) {
  const Quaternion& q = message.orientation;
  Pose out = Pose::Identity();
  out.translate(Eigen::Vector3d(message.position.x, message.position.y, message.position.z));
  out.rotate(Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
  return out;
}

/// As the robot's program sent it, with its pictures decoded. Throws InputError where they are no whole JPEGs of that
/// size.
ColourImage decoded(const CodedImage& image, const std::string& where) {
  const std::string_view bytes(reinterpret_cast<const char*>(image.data.data()), image.data.size());
  const ImageForm form = read_image_form(bytes, where);
  if (form.width != static_cast<int>(image.width) || form.height != static_cast<int>(image.height))
    throw InputError(where, "is a picture of another size than its message says", "record anew");
  ColourImage out;
  out.bgr = cv::imdecode(image.data, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (out.bgr.empty()) throw InputError(where, "cannot be decoded", "record anew");
  out.time = RobotTime{image.capture_ns};
  out.uncertainty = Duration{image.uncertainty_ns};
  return out;
}

McapOutcome read(const fs::path& file, const McapVisitor& visitor) {
  std::ifstream stream = open_input(file, UINTMAX_MAX);
  return read_mcap(stream, file.string(), visitor);
}

class Exporter {
 public:
  Exporter(const RunExportOptions& options, const Rig& rig, const LiveScene& scene)
      : options_(options), rig_(rig), scene_(scene), queue_(std::make_shared<FrameQueue>(kRoom, /*waits=*/true)) {
    const Lens &left = scene.lenses()->left, &right = scene.lenses()->right;
    const auto px = [](int size) { return static_cast<std::uint32_t>(size); };
    expected_.image_sizes = {px(left.width()), px(left.height()), px(right.width()), px(right.height())};
  }

  RunExport run() {
    RunRecorder recorder(options_.out, recorder_options(scene_), queue_);
    const std::string frames = topic_in_ros(topics::frames().name);
    McapVisitor visitor;
    visitor.message = [&](const McapMessage& message) {
      if (message.channel.topic == frames) take(message);
      return !recorder.stopped();
    };
    const McapOutcome outcome = read(options_.recording, visitor);
    if (good_ == 0)
      throw InputError(options_.recording.string(), "has no pair of images that can be used" + words(),
                       "record with `foresight record --line` while `foresight robot --serve` runs");
    const RecorderCounts counts = recorder.finish("recording: " + options_.recording.filename().string() + "\n");
    RunExport out{counts.written, counts.without_pose, ""};
    if (!outcome.trouble.empty()) out.remarks += "the recording is cut: " + outcome.trouble + "\n";
    for (const auto& [why, count] : refused_) out.remarks += fmt::format("{} pairs left out: {}\n", count, why);
    if (other_lenses_)
      out.remarks += fmt::format(
          "{} pairs were taken through lenses of another calibration than this rig's: export with the robot's own\n",
          other_lenses_);
    if (out.without_pose == out.pairs)
      out.remarks +=
          "no pair has a pose, which `foresight replay` needs: the head was not homed, or is not calibrated\n";
    if (recorder.disk_full()) out.remarks += "the disk is full: what came later is not in the run\n";
    return out;
  }

 private:
  static constexpr std::size_t kRoom = 4;

  std::string words() const { return refused_.empty() ? "" : ": " + refused_.begin()->first; }

  void take(const McapMessage& message) {
    const auto frame = from_cdr<StereoFrame>(message.data);
    std::string wrong = frame ? objection(*frame, expected_) : "bytes are no such message";
    if (wrong.empty() && frame->coding != kJpegCoding)
      wrong = "coding " + in_quotes(frame->coding) + " is not known here";
    if (wrong.empty() && (frame->left.capture_ns <= last_[0] || frame->right.capture_ns <= last_[1]))
      wrong = "older than the one before";
    try {
      if (wrong.empty()) return put(*frame);
    } catch (const InputError& error) {
      wrong = error.what();
    }
    if (refused_.size() < 20 || refused_.contains(wrong)) ++refused_[wrong];
  }

  void put(const StereoFrame& message) {
    auto frame = std::make_shared<LiveFrame>();
    frame->number = message.number;
    frame->pair = {decoded(message.left, "a left image"), decoded(message.right, "a right image")};
    last_ = {message.left.capture_ns, message.right.capture_ns};
    frame->quality = message.quality;
    if (message.predicted_px >= 0) frame->predicted_px = message.predicted_px;
    const auto known = [&](std::string_view joint) -> std::optional<double> {
      for (const JointSample& sample : message.joints)
        if (sample.name == shaft_name(rig_, joint) && sample.status != JointSample::kNeverKnown) return sample.position;
      return std::nullopt;
    };
    const auto status = static_cast<StateStatus>(std::min<int>(message.joints_status, int(StateStatus::invalid)));
    frame->scene = {scene_.state_at(frame->pair.left.time, known, status),
                    scene_.state_at(frame->pair.right.time, known, status)};
    if (message.left.has_pose && message.right.has_pose) {
      PosedFrame posed;
      posed.left.T_world_camera = pose_of(message.left.t_world_camera);
      posed.right.emplace().T_world_camera = pose_of(message.right.t_world_camera);
      frame->posed = std::move(posed);
    }
    if (!message.lenses_revision.empty() && message.lenses_revision != lenses_) ++other_lenses_;
    queue_->put(std::move(frame));
    ++good_;
  }

  const RunExportOptions& options_;
  const Rig& rig_;
  const LiveScene& scene_;
  std::shared_ptr<FrameQueue> queue_;
  Expected expected_;
  std::array<std::int64_t, 2> last_{INT64_MIN, INT64_MIN};
  const std::string lenses_ = lenses_revision(*scene_.lenses());
  std::uint64_t good_ = 0, other_lenses_ = 0;
  std::map<std::string, std::uint64_t> refused_;
};

/// The rig file that the recording was made with, and what it says besides.
struct RecordedRig {
  UnpackedRig files;
  std::optional<fs::path> rig;
  bool mock = false;
};

void unpack(const fs::path& recording, RecordedRig& out) {
  McapVisitor visitor;
  visitor.attachment = [&](const std::string& name, const std::string&, std::vector<std::uint8_t> data) {
    out.files.take(name, data);
  };
  visitor.metadata = [&](const std::string& name, const std::map<std::string, std::string>& texts) {
    if (name != kRecordingFacts) return;
    if (const auto rig = texts.find("rig"); rig != texts.end()) out.rig = out.files.file(rig->second);
    if (const auto mock = texts.find("mock"); mock != texts.end()) out.mock = mock->second == "yes";
  };
  visitor.message = [](const McapMessage&) { return false; };  // the head is before all messages
  read(recording, visitor);
}

}  // namespace

RunExport export_run(const RunExportOptions& options) {
  RecordedRig recorded;
  unpack(options.recording, recorded);
  const std::optional<fs::path>& file = options.rig ? options.rig : recorded.rig;
  if (!file)
    throw InputError(options.recording.string(), "has no rig in it, which knows lenses and scene",
                     "give it with --rig");
  const Rig rig = read_rig(*file);
  if (!rig.cameras) throw InputError(file->string(), "the rig has no cameras", "give the rig of the recorded robot");
  const LiveScene scene = live_scene_of(rig, options.mock || recorded.mock, options.scene);
  if (!scene.lenses())
    throw InputError(file->string(), "the cameras have no calibration", "add it as `lens` (docs/rig-files.md)");
  return Exporter(options, rig, scene).run();
}

}  // namespace foresight::link
