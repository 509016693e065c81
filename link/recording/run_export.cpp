#include "link/recording/run_export.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "link/dds/topics.hpp"
#include "link/messages/cdr.hpp"
#include "link/operator_side/pair_intake.hpp"
#include "link/operator_view/line_feed.hpp"
#include "link/recording/line_recorder.hpp"
#include "link/recording/mcap_reader.hpp"
#include "link/recording/recorded_stream.hpp"
#include "link/recording/rig_files.hpp"
#include "link/robot_side/robot_messages.hpp"
#include "session/recorder_options.hpp"

namespace foresight::link {
namespace {

namespace fs = std::filesystem;

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
    RecorderOptions options = recorder_options(scene_);
    options.irreplaceable = false;
    RunRecorder recorder(options_.out, std::move(options), queue_);
    McapVisitor visitor;
    visitor.message = [&](const McapMessage& message) {
      take(message);
      return !recorder.stopped();
    };
    const McapOutcome outcome = read(options_.recording, visitor);
    begin_intake(0);  // what the last one has refused counts, too
    if (good_ == 0)
      throw InputError(options_.recording.string(),
                       "has no pair of images that can be used" + (refusal_.empty() ? "" : ": " + refusal_),
                       "record with `foresight record --line` while `foresight robot --serve` runs");
    if (posed_ == 0 && recorder.fault().empty())
      throw InputError(
          options_.recording.string(),
          "has " + counted(good_, "pair") + " of images, and no pose of any, which makes a run of them",
          "home the robot's head before you record; where it is homed, calibrate it (docs/calibration.md)");
    const RecorderCounts counts = recorder.finish("recording: " + options_.recording.filename().string() + "\n");
    return {counts.written, counts.without_pose, remarks(outcome), recorder.fault()};
  }

 private:
  static constexpr std::size_t kRoom = 4;

  std::string remarks(const McapOutcome& outcome) const {
    std::string out;
    if (!outcome.trouble.empty()) out += "the recording is cut: " + outcome.trouble + "\n";
    if (refused_) out += fmt::format("{} pairs left out, the last as {}\n", refused_, refusal_);
    if (pieces_ && decoded_pieces_ == 0) out += std::string(RecordedStream::kNothingWhole) + "\n";
    if (other_lenses_)
      out += fmt::format(
          "{} pairs were taken through lenses of another calibration than this rig's: export with the robot's own\n",
          other_lenses_);
    return out;
  }

  /// For pieces to `reader`, and all pairs that are no pieces.
  void begin_intake(std::uint64_t reader) {
    if (intake_ && intake_->counts().refused) {
      refused_ += intake_->counts().refused;
      refusal_ = intake_->counts().refusal;
    }
    reader_ = reader;
    intake_.emplace(reader, expected_, clock_);
  }

  /// Time goes as it went when the recorder took the messages: the intake judges by it which robot it hears.
  void take(const McapMessage& message) {
    clock_.sleep_until(RobotTime{std::clamp<std::int64_t>(message.log_ns, 0, kLatestLog)});
    const auto is = [&](const Topic& topic) { return message.channel.topic == topic_in_ros(topic.name); };
    if (is(topics::frames())) {
      const auto frame = from_cdr<StereoFrame>(message.data);
      if (!intake_) begin_intake(0);
      if (frame) put(intake_->take(*frame, message.data.size(), RobotClockTracker()));
    } else if (is(topics::pieces())) {
      const auto piece = from_cdr<StereoPiece>(message.data);
      if (!piece) return;
      ++pieces_;
      if (!intake_ || piece->reader != reader_) begin_intake(piece->reader);
      if (const LineFramePtr frame = intake_->take(*piece, RobotClockTracker())) {
        ++decoded_pieces_;
        put(frame);
      }
    }
  }

  void put(const LineFramePtr& line) {
    if (!line || line->image[0].captured <= last_[0] || line->image[1].captured <= last_[1]) return;
    auto frame = std::make_shared<LiveFrame>();
    frame->number = line->number;
    for (const bool right : {false, true}) {
      const LineImage& image = line->image[right ? 1 : 0];
      (right ? frame->pair.right : frame->pair.left) = {image.bgr, line->number, image.captured, image.uncertainty};
      frame->scene[right ? 1 : 0] = scene_at(rig_, scene_, image.captured, line->joints);
      last_[right ? 1 : 0] = image.captured;
    }
    frame->quality = line->quality;
    frame->predicted_px = line->predicted_px;
    if (line->image[0].T_world_camera && line->image[1].T_world_camera) {
      PosedFrame posed;
      posed.left.T_world_camera = *line->image[0].T_world_camera;
      posed.right.emplace().T_world_camera = *line->image[1].T_world_camera;
      frame->posed = std::move(posed);
      ++posed_;
    }
    if (!line->lenses_revision.empty() && line->lenses_revision != lenses_) ++other_lenses_;
    queue_->put(std::move(frame));
    ++good_;
  }

  const RunExportOptions& options_;
  const Rig& rig_;
  const LiveScene& scene_;
  std::shared_ptr<FrameQueue> queue_;
  Expected expected_;
  SteppedClock clock_;
  std::uint64_t reader_ = 0;
  std::optional<PairIntake> intake_;
  std::array<RobotTime, 2> last_{RobotTime{INT64_MIN}, RobotTime{INT64_MIN}};
  const std::string lenses_ = lenses_revision(*scene_.lenses());
  std::uint64_t good_ = 0, posed_ = 0, other_lenses_ = 0, refused_ = 0, pieces_ = 0, decoded_pieces_ = 0;
  std::string refusal_;  // the last
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
