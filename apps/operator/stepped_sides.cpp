#include "apps/operator/stepped_sides.hpp"

#include <malloc.h>

#include <array>

#include "link/robot_side/rig_identity.hpp"

namespace foresight {
namespace {

LinkConfig network(const link::OwnDomain& domain) {
  LinkConfig out;
  out.domain = domain.number();
  return out;
}

constexpr Duration kTogether = std::chrono::milliseconds(1);  // the two hosts' clocks go on in such steps
constexpr Nonce kNamesOfAStart = 1'000'000'000;

/// The same in each trial: names and stamps are in the notes of pairs, which are deflated, so that others would be of
/// another size, and all that waits for them on a thin line be somewhere else.
link::RobotServer::Start same_start(const Clock& clock, unsigned starts) {
  return {.draw = [next = std::make_shared<Nonce>(1 + kNamesOfAStart * starts)] { return (*next)++; },
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

/// From its start to its end.
struct SteppedRobotSide::Program {
  Program(const Rig& of, const Identity& identity, SteppedRobotSide& side)
      : rig(of),
        devices(rig, clock, mock_drives()),
        shape(rig.shape()),
        robot(rig.gate_options(), shape.get(), devices.networks(), devices.drives()),
        cameras(rig, devices, robot, clock, mock_cameras(side.physics_, side.layout_)),
        server(side.participant_, rig, robot, &cameras, identity, clock, same_start(clock, side.starts_)) {
    devices.bring_up([](const std::string&) {});
    clock.every(kTick, [this, &side](RobotTime) {
      if (!side.cameras_held_ && !side.program_held_) cameras.step();
    });
    clock.every(kTick, [this, &side](RobotTime now) {
      Commander* const commander = &server.commander();
      if (!side.program_held_) serve(std::span(&commander, 1), robot, now);
    });
    clock.every(std::chrono::milliseconds(2), [this, &side](RobotTime now) {
      if (!side.program_held_) server.step(now);
    });
  }
  /// To an instant of the other clock.
  void catch_up(RobotTime there) { clock.sleep_until(there - behind); }

  Rig rig;
  SteppedClock clock;
  Duration behind{0};  // the other clock
  RobotDevices devices;
  std::unique_ptr<RobotShape> shape;
  Robot robot;
  RobotCameras cameras;
  link::RobotServer server;
};

SteppedRobotSide::SteppedRobotSide(const Rig& rig, const std::filesystem::path& file, SteppedClock& clock,
                                   const LineSpec& line, std::optional<unsigned> physics, unsigned layout)
    : rig_(rig),
      clock_(clock),
      identity_(link::rig_identity(rig, file, FORESIGHT_VERSION)),
      line_(std::make_shared<link::PretendedLine>(line, link::PretendedLine::Side::robot, clock)),
      participant_(network(domain_), "robot " + rig.name, link::Role::robot, line_),
      physics_(physics),
      layout_(layout),
      program_(std::make_unique<Program>(rig, identity_, *this)),
      period_(seconds(1 / rig.rate_hz)) {
  clock_.sleep_until(program_->clock.now());
  clock.every(kTogether, [this](RobotTime now) {
    if (program_) program_->catch_up(now);
  });
  clock.every(std::chrono::milliseconds(2), [this](RobotTime) { line_->step(); });
  next_ = clock.now();
}

SteppedRobotSide::~SteppedRobotSide() = default;

void SteppedRobotSide::cycle() {
  next_ = std::max(next_ + period_, clock_.now());
  clock_.sleep_until(next_);
  if (!program_) return;
  program_->catch_up(next_);
  program_->robot.cycle(program_->clock.now());
}

Robot& SteppedRobotSide::robot() {
  return program_->robot;
}

RobotDevices& SteppedRobotSide::devices() {
  return program_->devices;
}

RobotCameras& SteppedRobotSide::cameras() {
  return program_->cameras;
}

// A real program is a process, and its memory goes with it. Here it leaves gaps in a heap that is the operator's, too,
// more with each start, which would be counted as that one's growth.
void SteppedRobotSide::end() {
  program_.reset();
  ::malloc_trim(0);
}

void SteppedRobotSide::start(const Rig& rig, const Identity& identity) {
  end();
  ++starts_;
  program_ = std::make_unique<Program>(rig, identity, *this);
  program_->behind = clock_.now() - program_->clock.now();
}

}  // namespace foresight
