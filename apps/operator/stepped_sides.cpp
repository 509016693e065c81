#include "apps/operator/stepped_sides.hpp"

#include <array>

#include "link/robot_side/rig_identity.hpp"

namespace foresight {
namespace {

LinkConfig network(const link::OwnDomain& domain) {
  LinkConfig out;
  out.domain = domain.number();
  return out;
}

/// The same in each trial: names and stamps are in the notes of pairs, which are deflated, so that others would be of
/// another size, and all that waits for them on a thin line be somewhere else.
link::RobotServer::Start same_start(const Clock& clock) {
  return {.draw = [next = std::make_shared<Nonce>(1)] { return (*next)++; },
          .wall = [&clock] { return clock.now().ns; }};
}

RobotDeviceOptions mock_drives() {
  RobotDeviceOptions out;
  out.mock = true;
  return out;
}

RobotCameraOptions mock_cameras(const std::optional<unsigned>& physics, unsigned layout) {
  RobotCameraOptions out;
  out.mock = true;
  out.frames = true;
  out.physics = physics.has_value();
  out.physics_seed = physics.value_or(1);
  out.layout = layout;
  return out;
}

}  // namespace

SteppedRobotSide::SteppedRobotSide(const Rig& rig, const std::filesystem::path& file, SteppedClock& clock,
                                   const LineSpec& line, std::optional<unsigned> physics, unsigned layout)
    : rig_(rig),
      clock_(clock),
      identity_(link::rig_identity(rig, file, FORESIGHT_VERSION)),
      line_(std::make_shared<link::PretendedLine>(line, link::PretendedLine::Side::robot, clock)),
      participant_(network(domain_), "robot " + rig.name, link::Role::robot, line_),
      devices_(rig, clock, mock_drives()),
      shape_(rig.shape()),
      robot_(std::make_unique<Robot>(rig.gate_options(), shape_.get(), devices_.networks(), devices_.drives())),
      cameras_(std::make_unique<RobotCameras>(rig, devices_, *robot_, clock, mock_cameras(physics, layout))),
      server_(std::make_unique<link::RobotServer>(participant_, rig, *robot_, cameras_.get(), identity_, clock,
                                                  same_start(clock))),
      period_(seconds(1 / rig.rate_hz)),
      next_(clock.now()) {
  devices_.bring_up([](const std::string&) {});
  clock.every(kTick, [this](RobotTime) {
    if (!cameras_held_ && !program_held_) cameras_->step();
  });
  clock.every(kTick, [this](RobotTime now) {
    Commander* const commander = &server_->commander();
    if (!program_held_) serve(std::span(&commander, 1), *robot_, now);
  });
  clock.every(std::chrono::milliseconds(2), [this](RobotTime now) {
    if (!program_held_) server_->step(now);
    line_->step();
  });
  next_ = clock.now();
}

SteppedRobotSide::~SteppedRobotSide() = default;

void SteppedRobotSide::cycle() {
  next_ = std::max(next_ + period_, clock_.now());
  clock_.sleep_until(next_);
  robot_->cycle(clock_.now());
}

}  // namespace foresight
