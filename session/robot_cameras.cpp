#include "session/robot_cameras.hpp"

#include <fmt/core.h>

#include "common/error.hpp"
#include "session/recorder_options.hpp"
#include "session/recording.hpp"

namespace foresight {

JointLog::JointLog(const std::filesystem::path& file, const Rig& rig) : stream_(file), joints_(rig.joints.size()) {
  if (!stream_) throw RuntimeFailure("cannot write " + file.string(), "choose a folder that can be written");
  stream_ << "time_s";
  for (const std::string& joint : rig.joint_names()) stream_ << ',' << joint;
  stream_ << '\n';
}

void JointLog::add(const RobotStatus& status) {
  if (status.time <= last_ || !status.all_homed) return;
  last_ = status.time;
  stream_ << fmt::format("{:.9f}", to_seconds(status.time - RobotTime{}));
  for (std::size_t i = 0; i < joints_; ++i) stream_ << fmt::format(",{:.7f}", status.feedback[i].position);
  stream_ << '\n';
}

std::filesystem::path can_log_beside(const std::filesystem::path& out) {
  return beside_run(out, "-can.log");
}
std::filesystem::path joint_log_beside(const std::filesystem::path& out) {
  return beside_run(out, "-joints.csv");
}

struct RobotCameras::Recording {
  RunRecorder recorder;
  std::filesystem::path out;
  std::string fault;  // of the watch's thread

  Recording(RecorderOptions options, const std::filesystem::path& folder)
      : recorder(folder, std::move(options)), out(folder) {}
  void add(const StereoPair& pair) noexcept {
    if (!fault.empty()) return;
    try {
      recorder.add(pair);
    } catch (const std::exception& error) {
      fault = error.what();
    }
  }
};

RobotCameras::RobotCameras(const Rig& rig, const RobotDevices& devices, Clock& clock, const RobotCameraOptions& options)
    : devices_(devices), clock_(clock) {
  const StereoConfig config = options.mock ? as_mock(*rig.cameras) : *rig.cameras;
  if (config.mock() && rig.calibration) world_ = mock_world(rig.calibration->tags);
  if (config.mock() || options.record) ready_ = open(config);
  if (options.record) start_recording(rig, config, *options.record);
  watch_ = std::make_unique<CameraWatch>(
      [this, config] { return ready_.cameras ? std::move(ready_.cameras) : std::move(open(config).cameras); }, clock,
      [this](const StereoPair& pair) {
        if (recording_) recording_->add(pair);
      });
}

void RobotCameras::start_recording(const Rig& rig, const StereoConfig& config, const std::filesystem::path& out) {
  const sim::ShaftsAt shafts = [this](std::string_view joint, RobotTime t) { return devices_.shaft_at(joint, t); };
  RecorderOptions recording = recorder_options(config, ready_, shafts);
  recording.waits = dynamic_cast<SteppedClock*>(&clock_) != nullptr;
  if (rig.calibration) recording.tags = rig.calibration->tags;
  if (rig.calibration && rig.calibration->pan_tilt) {
    const StereoLenses lenses{recording.left, recording.right, recording.T_left_right};
    head_ = std::make_unique<HeadRegistration>(rig, lenses);
    recording.registration = [head = head_.get()] { return head->prepare(); };
  }
  recording_ = std::make_unique<Recording>(std::move(recording), out);
}

RobotCameras::~RobotCameras() = default;

OpenStereo RobotCameras::open(const StereoConfig& config) const {
  const auto shafts = [this](std::string_view joint, RobotTime time) { return devices_.shaft_at(joint, time); };
  return open_stereo(config, shafts, clock_, world_);
}

std::string RobotCameras::finish() {
  watch_->stop();
  if (!recording_) return "";
  std::string out = recording_->fault.empty() ? "" : "the recording ended early: " + recording_->fault + "\n";
  const StereoStatus status = watch_->line().status;
  const RecorderCounts counts = recording_->recorder.finish(camera_remarks(status));
  return out + counts_text({counts, status, ""}) + recording_->out.string() + "\n";
}

}  // namespace foresight
