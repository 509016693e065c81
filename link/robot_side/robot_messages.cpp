#include "link/robot_side/robot_messages.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "operators/who_stopped.hpp"
#include "scene/camera_info.hpp"

namespace foresight::link {
namespace {

Vector3 vector(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Quaternion quaternion(const Pose& pose) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
  return {q.x(), q.y(), q.z(), q.w()};
}

TransformStamped transform(const std::string& parent, const std::string& child, const Pose& T_parent_child,
                           RosTime stamp) {
  return {{stamp, parent}, child, {vector(T_parent_child.translation()), quaternion(T_parent_child)}};
}

const std::string& parent_of(const UrdfRobot& robot, const UrdfJoint& joint) {
  const auto child = static_cast<std::size_t>(joint.child);
  return robot.links[static_cast<std::size_t>(robot.links[child].parent)].name;
}

/// Where the joint stands, which may follow another one; nothing where that is not known.
std::optional<double> position_of(const UrdfRobot& robot, std::size_t index, const JointState& joints,
                                  const std::vector<std::string>& names) {
  const JointSource source = source_of(robot, index);
  const std::string& name = robot.joints[static_cast<std::size_t>(source.joint)].name;
  const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  if (at >= joints.positions.size() || !joints.known[at]) return std::nullopt;
  return source.factor * joints.positions[at] + source.offset;
}

CodedImage coded_image(const ColourImage& image, const std::optional<Pose>& T_world_camera) {
  CodedImage out;
  out.capture_ns = image.time.ns;
  out.uncertainty_ns = image.uncertainty.count();
  out.width = static_cast<std::uint32_t>(image.bgr.cols);
  out.height = static_cast<std::uint32_t>(image.bgr.rows);
  out.has_pose = T_world_camera.has_value();
  if (T_world_camera) out.t_world_camera = {vector(T_world_camera->translation()), quaternion(*T_world_camera)};
  return out;
}

Words words(const StateWords& from) {
  return {from.label, from.name, from.cure};
}

double finite_or_0(double value) {
  return std::isfinite(value) ? value : 0;
}

DriveLine drive_line(const DriveFeedback& feedback, const JointMotion& set_point, const JointWords& joint) {
  DriveLine out;
  out.name = joint.name;
  out.unit = joint.unit;
  out.state = words_for(feedback.state).label;
  out.homed = feedback.homed;
  out.limit = feedback.limit;
  out.fault_code = feedback.fault_code;
  out.fault = feedback.fault;
  out.told_ns = feedback.time.ns;
  out.known = feedback.time.ns != 0 && std::isfinite(feedback.position);
  if (!out.known) return out;
  out.position = feedback.position;
  out.velocity = finite_or_0(feedback.velocity);
  out.set_point = finite_or_0(set_point.position);
  return out;
}

DiagnosticStatus diagnostic(const std::string& name, std::uint8_t level, const std::string& message,
                            const std::string& hardware, std::vector<KeyValue> values) {
  return {level, "foresight: " + name, message.empty() ? "ok" : message, hardware, std::move(values)};
}

}  // namespace

std::string camera_frame(Side side) {
  return side == Side::left ? "left_camera" : "right_camera";
}

JointStateMessage joint_states(const JointState& joints, const RobotCycle& cycle, const std::vector<std::string>& names,
                               RosTime stamp) {
  JointStateMessage out;
  out.header.stamp = stamp;
  for (std::size_t i = 0; i < std::min(names.size(), joints.known.size()); ++i) {
    if (!joints.known[i]) continue;
    out.name.push_back(names[i]);
    out.position.push_back(joints.positions[i]);
    if (std::isfinite(cycle.joint[i].velocity)) out.velocity.push_back(cycle.joint[i].velocity);
  }
  if (out.velocity.size() != out.name.size()) out.velocity.clear();
  return out;
}

GateMotion gate_motion(const RobotCycle& cycle, double speed, const TakenSetPoint& taken) {
  GateMotion out;
  out.time_ns = cycle.time.ns;
  out.doing = static_cast<std::uint8_t>(doing_of(cycle.phase, cycle.gate));
  out.speed = std::clamp(finite_or_0(speed), 0.0, 1.0);
  out.commander = taken.from;
  out.set_point = taken.sequence;
  out.set_point_came_ns = taken.came.ns;
  for (std::size_t i = 0; i < cycle.joints; ++i) {
    const JointCycle& joint = cycle.joint[i];
    GateMotionJoint& to = out.joints.emplace_back();
    to.known = joint.homed && joint.time.ns != 0 && std::isfinite(joint.position);
    if (to.known) to.position = joint.position;
    constexpr std::int64_t kMostUs = std::numeric_limits<std::int32_t>::max();
    to.told_us = static_cast<std::int32_t>(std::clamp((cycle.time - joint.time).count() / 1000, -kMostUs, kMostUs));
    to.set_point = finite_or_0(joint.set_point.position);
    to.velocity = static_cast<float>(finite_or_0(joint.set_point.velocity));
    to.acceleration = static_cast<float>(finite_or_0(joint.set_point.acceleration));
  }
  return out;
}

JointTrajectory set_points(const RobotCycle& cycle, const std::vector<std::string>& names, RosTime stamp) {
  JointTrajectory out;
  out.header.stamp = stamp;
  out.points.resize(1);
  for (std::size_t i = 0; i < std::min(names.size(), cycle.joints); ++i) {
    const JointMotion& set_point = cycle.joint[i].set_point;
    if (!std::isfinite(set_point.position) || !std::isfinite(set_point.velocity)) continue;
    out.joint_names.push_back(names[i]);
    out.points[0].positions.push_back(set_point.position);
    out.points[0].velocities.push_back(set_point.velocity);
  }
  return out;
}

TFMessage link_transforms(const UrdfRobot& robot, const JointState& joints, const std::vector<std::string>& names,
                          RosTime stamp) {
  TFMessage out;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const UrdfJoint& joint = robot.joints[i];
    if (joint.kind == UrdfJoint::Kind::fixed) continue;
    const auto position = position_of(robot, i, joints, names);
    if (!position) continue;
    out.transforms.push_back(transform(parent_of(robot, joint), robot.links[static_cast<std::size_t>(joint.child)].name,
                                       joint.T_parent_joint * joint_transform(joint, *position), stamp));
  }
  return out;
}

TFMessage static_transforms(const UrdfRobot& robot, const Pose& T_world_robot, RosTime stamp) {
  TFMessage out;
  if (robot.links.front().name != "world")
    out.transforms.push_back(transform("world", robot.links.front().name, T_world_robot, stamp));
  for (const UrdfJoint& joint : robot.joints)
    if (joint.kind == UrdfJoint::Kind::fixed)
      out.transforms.push_back(transform(parent_of(robot, joint),
                                         robot.links[static_cast<std::size_t>(joint.child)].name, joint.T_parent_joint,
                                         stamp));
  return out;
}

TFMessage camera_transforms(const LiveFrame& frame, RosTime left, RosTime right) {
  TFMessage out;
  if (!frame.posed) return out;
  out.transforms.push_back(transform("world", camera_frame(Side::left), frame.posed->left.T_world_camera, left));
  if (frame.posed->right)
    out.transforms.push_back(transform("world", camera_frame(Side::right), frame.posed->right->T_world_camera, right));
  return out;
}

StereoFrame stereo_frame(const LiveFrame& frame, const std::vector<std::string>& joints) {
  StereoFrame out;
  out.header.frame_id = "world";
  out.number = frame.number;
  out.stamps = {frame.came.ns, frame.registered.ns, 0, 0};
  out.quality = frame.quality;
  if (frame.predicted_px) out.predicted_px = *frame.predicted_px;
  out.joints_status = static_cast<std::uint8_t>(frame.joints.status);
  for (std::size_t i = 0; i < std::min(joints.size(), frame.joints.positions.size()); ++i) {
    const double position = frame.joints.positions[i];
    const bool ever = std::isfinite(position);
    out.joints.push_back({joints[i],
                          frame.joints.known[i] ? JointSample::kKnown
                          : ever                ? JointSample::kLastHeardOf
                                                : JointSample::kNeverKnown,
                          ever ? position : 0});
  }
  std::optional<Pose> left, right;
  if (frame.posed) left = frame.posed->left.T_world_camera;
  if (frame.posed && frame.posed->right) right = frame.posed->right->T_world_camera;
  out.left = coded_image(frame.pair.left, left);
  out.right = coded_image(frame.pair.right, right);
  return out;
}

CameraInfoMessage camera_info(const Lens& lens, const std::string& frame_id, RosTime stamp) {
  const Lens::Parameters& p = lens.parameters();
  CameraInfoMessage out;
  out.header = {stamp, frame_id};
  out.width = static_cast<std::uint32_t>(p.width);
  out.height = static_cast<std::uint32_t>(p.height);
  out.distortion_model = to_string(p.model);
  const std::size_t count = p.model == LensModel::plumb_bob ? 5 : p.model == LensModel::equidistant ? 4 : 8;
  out.d.assign(p.d.begin(), p.d.begin() + static_cast<std::ptrdiff_t>(count));
  out.k = {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1};
  out.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  out.p = {p.fx, 0, p.cx, 0, 0, p.fy, p.cy, 0, 0, 0, 1, 0};
  return out;
}

std::string lenses_revision(const StereoLenses& lenses) {
  const std::string text = camera_info_text({lenses.left, std::nullopt}, "left") +
                           camera_info_text({lenses.right, lenses.T_left_right}, "right");
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return fmt::format("{:016x}", hash);
}

RobotState robot_state(const RobotStatus& status, const Rig& rig, const std::string& line_stopper) {
  const std::vector<JointWords> joints = rig.joint_words();
  const GateStatus& gate = status.gate;
  RobotState out;
  out.time_ns = status.time.ns;
  out.rig = rig.name;
  out.phase = words(words_for(status.phase));
  out.gate = words(words_for(gate.state));
  out.reason = words(words_for(gate.reason));
  const RobotWords doing = describe(status, joints);
  out.doing = {"", name_and_who(doing.name, status, line_stopper), doing.cure};
  out.detail = gate.detail;
  out.hold = hold_text(gate.hold, joints, status.time);
  out.operator_id = gate.operator_id;
  out.accepted = gate.accepted;
  out.dropped = gate.dropped;
  out.last_dropped = words_for(gate.last_dropped).label;
  out.speed = std::clamp(finite_or_0(gate.speed), 0.0, 1.0);
  out.all_homed = status.all_homed;
  out.bus_healthy = status.bus_healthy;
  out.bus_reason = status.bus_reason;
  out.refused = status.refused;
  for (std::size_t i = 0; i < joints.size(); ++i)
    out.drives.push_back(drive_line(status.feedback[i], status.set_point[i], joints[i]));
  out.loop = {rig.rate_hz,
              status.loop.cycles(),
              status.loop.overruns(),
              to_seconds(status.loop.quantile(0.5)),
              to_seconds(status.loop.quantile(0.99)),
              to_seconds(status.loop.worst())};
  return out;
}

CameraLines camera_lines(const CameraLine& line, const std::string& registration, RobotTime now) {
  CameraLines out;
  out.present = true;
  out.fault = line.fault;
  out.last_fault = line.last_fault;
  out.pairs_per_s = line.pairs_per_s;
  if (line.age) out.newest_ns = (now - *line.age).ns;
  out.missed = line.status.dropped;
  out.unpaired = line.status.pairing.unpaired[0] + line.status.pairing.unpaired[1];
  out.damaged = line.status.corrupt[0] + line.status.corrupt[1];
  out.losses = line.losses[0] + line.losses[1];
  out.registration = registration;
  return out;
}

DiagnosticArray diagnostics(const RobotState& state) {
  using S = DiagnosticStatus;
  DiagnosticArray out;
  out.header = state.header;
  const auto text = [](double value) { return fmt::format("{:.4g}", value); };
  const auto count = [](std::uint64_t value) { return fmt::format("{}", static_cast<unsigned long long>(value)); };
  const bool stopped = state.phase.label == words_for(RobotPhase::stopped).label;
  const std::string cure = state.doing.cure.empty() ? "" : "; " + state.doing.cure;
  out.status.push_back(diagnostic("robot",
                                  stopped              ? S::kError
                                  : state.hold.empty() ? S::kOk
                                                       : S::kWarn,
                                  state.doing.name + cure, state.rig,
                                  {{"gate", state.gate.label},
                                   {"reason", state.reason.label},
                                   {"hold", state.hold},
                                   {"accepted", count(state.accepted)},
                                   {"dropped", count(state.dropped)}}));
  for (const DriveLine& drive : state.drives) {
    const bool bad = drive.state == words_for(DriveState::offline).label || !drive.fault.empty();
    out.status.push_back(diagnostic("drive " + drive.name, bad ? S::kError : S::kOk,
                                    drive.fault.empty() ? drive.state : drive.fault, drive.name,
                                    {{"position", drive.known ? text(drive.position) + " " + drive.unit : "unknown"},
                                     {"homed", drive.homed ? "yes" : "no"},
                                     {"fault code", fmt::format("{:#x}", drive.fault_code)}}));
  }
  if (state.cameras.present)
    out.status.push_back(diagnostic("cameras", state.cameras.fault.empty() ? S::kOk : S::kError, state.cameras.fault,
                                    state.rig,
                                    {{"pairs per second", text(state.cameras.pairs_per_s)},
                                     {"missed", count(state.cameras.missed)},
                                     {"registration", state.cameras.registration}}));
  out.status.push_back(diagnostic("control loop", state.loop.overruns == 0 ? S::kOk : S::kWarn,
                                  count(state.loop.overruns) + " overruns", state.rig,
                                  {{"cycles", count(state.loop.cycles)},
                                   {"late p99, ms", text(1e3 * state.loop.late_p99_s)},
                                   {"late worst, ms", text(1e3 * state.loop.late_worst_s)}}));
  return out;
}

}  // namespace foresight::link
