#include "link/robot_side/state_sender.hpp"

#include "common/real_time.hpp"
#include "link/dds/topics.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStateLook = 4ms;  // a cycle of the usual rate
constexpr Duration kDiagnostics = 1s;

}  // namespace

StateSender::StateSender(Participant& participant, SenderName name, const Rig& rig, const Robot& robot,
                         const RobotCameras* cameras, WallClock& wall, Clock& clock, const CommandHistory* taken,
                         const LineCapacity* line)
    : name_(std::move(name)),
      rig_(rig),
      robot_(robot),
      cameras_(cameras),
      wall_(wall),
      clock_(clock),
      taken_(taken),
      line_(line),
      joint_period_(seconds(1 / rig.link.joint_rate_hz)),
      state_period_(seconds(1 / rig.link.state_rate_hz)),
      cycles_(robot.cycles()),
      joints_(rig.joints.size()),
      motion_(participant, topics::gate_motion()),
      joint_states_(participant, topics::joint_states()),
      set_points_(participant, topics::set_points()),
      transforms_(participant, topics::transforms()),
      static_transforms_(participant, topics::static_transforms()),
      states_(participant, topics::robot_state()),
      diagnostics_(participant, topics::diagnostics()) {
  if (rig.robot)
    static_transforms_.write(static_transforms(*rig.robot, rig.T_world_robot, ros_time(wall.unix_ns(clock.now()))));
}

void StateSender::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    make_real_time(priority::kLine);  // where allowed
    while (!stop.stop_requested()) {
      step(clock_.now());
      clock_.sleep_until(clock_.now() + kStateLook);
    }
  });
}

void StateSender::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void StateSender::listen() {
  while (const auto cycle = cycles_.take()) {
    changed_ |=
        !newest_ || cycle->phase != newest_->phase || cycle->gate != newest_->gate || cycle->reason != newest_->reason;
    joints_.add(*cycle);
    newest_ = cycle;
  }
}

Duration StateSender::thinned_for_line(Duration asked, const LineShare& share) const {
  return line_ ? thinned(asked, share, line_->bytes_per_s) : asked;
}

void StateSender::step(RobotTime now) noexcept {
  try {
    listen();
    if (newest_ && now >= joints_due_) {
      joints_due_ = std::max(joints_due_ + thinned_for_line(joint_period_, kMotionShare), now);
      send_motion();
      send_joints();
    }
    if (changed_ || now >= state_due_) {
      state_due_ = now + thinned_for_line(state_period_, kWordsShare);
      changed_ = false;
      send_state(now);
    }
  } catch (const std::exception&) {  // no memory: what is due next is newer anyway
  }
}

void StateSender::send_motion() {
  GateMotion motion =
      gate_motion(*newest_, robot_.status().gate.speed, taken_ ? taken_->newest_by(newest_->time) : TakenSetPoint{});
  motion.session = name_.session;
  motion.number = ++motions_;
  motion_.write(motion);
}

void StateSender::send_joints() {
  const RobotTime time = joints_.newest();
  if (time.ns == 0 || time <= sent_joints_) return;
  sent_joints_ = time;
  const RosTime stamp = ros_time(wall_.unix_ns(time));
  const JointState joints = joints_.at(time);
  const JointStateMessage states = joint_states(joints, *newest_, name_.joints, stamp);
  if (!states.name.empty()) joint_states_.write(states);
  if (set_points_.readers() > 0)
    set_points_.write(set_points(*newest_, name_.joints, ros_time(wall_.unix_ns(newest_->time))));
  if (!rig_.robot) return;
  const TFMessage transforms = link_transforms(*rig_.robot, joints, name_.joints, stamp);
  if (!transforms.transforms.empty()) transforms_.write(transforms);
}

void StateSender::send_state(RobotTime now) {
  RobotState state = robot_state(robot_.status(), rig_, taken_ ? taken_->stopper() : "");
  state.header.stamp = ros_time(wall_.unix_ns(now));
  state.session = name_.session;
  state.number = ++number_;
  if (cameras_) state.cameras = camera_lines(cameras_->watch().line(), cameras_->registration_trouble(), now);
  states_.write(state);
  if (now < diagnostics_due_) return;
  diagnostics_due_ = now + kDiagnostics;
  diagnostics_.write(diagnostics(state));
}

}  // namespace foresight::link
