#include "link/operator_side/line_frame.hpp"

#include <algorithm>
#include <limits>

namespace foresight::link {
namespace {

Pose pose_of(const PoseMessage& message) {
  const auto& [p, q] = message;
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(p.x, p.y, p.z);
  out.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return out;
}

LineImage image_of(const CodedImage& image) {
  LineImage out;
  out.captured = RobotTime{image.capture_ns};
  out.uncertainty = Duration{image.uncertainty_ns};
  if (image.has_pose) out.T_world_camera = pose_of(image.t_world_camera);
  return out;
}

LineJoints joints_of(const StereoFrame& message) {
  LineJoints out;
  out.status = static_cast<StateStatus>(message.joints_status);
  for (const JointSample& joint : message.joints) {
    const bool ever = joint.status != JointSample::kNeverKnown;
    out.names.push_back(joint.name);
    out.positions.push_back(ever ? joint.position : std::numeric_limits<double>::quiet_NaN());
    out.known.push_back(joint.status == JointSample::kKnown);
  }
  return out;
}

std::optional<Duration> age_at(std::int64_t stamp_ns, const StereoFrame& message) {
  return stamp_ns == 0 ? std::nullopt : std::optional(Duration{stamp_ns - message.left.capture_ns});
}

}  // namespace

std::optional<double> LineJoints::position(std::string_view name) const {
  const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  return at < names.size() && std::isfinite(positions[at]) ? std::optional(positions[at]) : std::nullopt;
}

LineFrame line_frame(const StereoFrame& message, const RobotClockTracker& clock, OperatorTime arrived,
                     OperatorTime decoded) {
  LineFrame out;
  out.session = message.session;
  out.number = message.number;
  out.image = {image_of(message.left), image_of(message.right)};
  out.captured = clock.to_here(out.image[0].captured);
  out.arrived = arrived;
  out.decoded = decoded;
  out.joints = joints_of(message);
  out.quality = message.quality;
  if (message.predicted_px >= 0) out.predicted_px = message.predicted_px;
  out.lenses_revision = message.lenses_revision;
  out.ages = {age_at(message.stamps.paired_ns, message),   age_at(message.stamps.registered_ns, message),
              age_at(message.stamps.taken_ns, message),    age_at(message.stamps.coded_ns, message),
              clock.delay(out.image[0].captured, arrived), clock.delay(out.image[0].captured, decoded)};
  return out;
}

std::optional<PosedFrame> posed_frame(const LineFrame& frame,
                                      const std::function<SceneState(RobotTime, const LineJoints&)>& scene_at,
                                      double margin_px) {
  const auto posed = [&](const LineImage& image) {
    PosedImage out{image.bgr, image.captured, *image.T_world_camera, scene_at(image.captured, frame.joints)};
    out.lost = image.lost;
    if (frame.predicted_px) out.margin_px = margin_for(margin_px, *frame.predicted_px);
    return out;
  };
  if (!frame.image[0].T_world_camera || !frame.image[1].T_world_camera) return std::nullopt;
  return PosedFrame{posed(frame.image[0]), posed(frame.image[1])};
}

}  // namespace foresight::link
