#include "session/robot_cameras.hpp"

#include "common/error.hpp"
#include "session/recorder_options.hpp"
#include "session/recording.hpp"

namespace foresight {

std::filesystem::path can_log_beside(const std::filesystem::path& out) {
  return beside_run(out, "-can.log");
}
std::filesystem::path joint_log_beside(const std::filesystem::path& out) {
  return beside_run(out, "-joints.csv");
}

RobotCameras::RobotCameras(const Rig& rig, const RobotDevices& devices, const Robot& robot, Clock& clock,
                           const RobotCameraOptions& options)
    : rig_(rig), devices_(devices), clock_(clock) {
  const StereoConfig config = options.mock ? as_mock(*rig.cameras) : *rig.cameras;
  if (config.mock()) world_ = mock_world(rig, options.scene);
  world_.layout = options.layout;
  if (options.physics) add_physics(config, options.physics_seed);
  if (config.mock() || options.record) ready_ = open(config);
  physics_ = ready_.physics;
  if (options.frames || options.record) {
    scene_ = ready_.mock ? std::make_shared<const LiveScene>(*ready_.mock)
                         : std::make_shared<const LiveScene>(config, &rig, options.scene);
    auto poses = std::make_shared<EncoderPoses>(rig, scene_, robot.cycles());
    const bool posed = poses->has_poses();
    frames_ = std::make_unique<LiveFrames>(std::move(poses), clock, options.live);
    if (options.record) start_recording(rig, *options.record, posed);
  }
  watch_ = std::make_unique<CameraWatch>(
      [this, config] { return ready_.cameras ? std::move(ready_.cameras) : std::move(open(config).cameras); }, clock,
      [this](const StereoPair& pair) {
        if (frames_) frames_->add(pair);
      });
}

void RobotCameras::add_physics(const StereoConfig& config, unsigned seed) {
  if (!config.mock())
    throw InputError("physics", "belongs to the mock lab, and the rig's cameras are real", "use mock cameras");
  sim::PhysicsOptions& physics = world_.physics.emplace();
  physics.hidden.seed = seed;
  physics.jaws.clear();
  for (const RigJoint& joint : rig_.joints)
    if (joint.group == JointGroup::gripper) physics.jaws.push_back(joint.drive.name);
}

void RobotCameras::start_recording(const Rig& rig, const std::filesystem::path& out, bool posed) {
  RecorderOptions options = recorder_options(*scene_);
  options.posed = posed;
  if (rig.calibration) options.tags = rig.calibration->tags;
  const bool stepped = dynamic_cast<SteppedClock*>(&clock_) != nullptr;
  recorder_ =
      std::make_unique<RunRecorder>(out, std::move(options), frames_->subscribe(RunRecorder::kRoom, /*waits=*/stepped));
  out_ = out;
}

RobotCameras::~RobotCameras() = default;

OpenStereo RobotCameras::open(const StereoConfig& config) const {
  const auto shafts = [this](std::string_view joint, RobotTime time) {
    return devices_.shaft_at(shaft_name(rig_, joint), time);
  };
  return open_stereo(config, shafts, clock_, world_);
}

void RobotCameras::start() {
  if (frames_) frames_->start();
  watch_->start();
}

void RobotCameras::step() noexcept {
  watch_->step();
  if (frames_) frames_->step();
}

std::string RobotCameras::registration_trouble() const {
  if (!frames_) return "";
  const std::string fault = frames_->fault(), missing = frames_->missing();
  return fault.empty() && !missing.empty() ? "not known: " + missing + "; drawn where last heard of" : fault;
}

std::string RobotCameras::finish() {
  watch_->stop();
  if (frames_) frames_->stop();
  if (!recorder_) return "";
  const StereoStatus status = watch_->line().status;
  const RecorderCounts counts = recorder_->finish(camera_remarks(status) + registration_remarks(*frames_));
  return counts_text({counts, status, frames_->dropped(), ""}) + out_.string() + "\n";
}

}  // namespace foresight
