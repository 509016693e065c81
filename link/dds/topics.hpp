// The topics of a line, in one place (docs/line.md has the table). "rt/" is how ROS 2 marks its topics on DDS.
#pragma once

#include "link/dds/participant.hpp"
#include "link/messages/foresight_messages.hpp"

namespace foresight::link::topics {

// From the robot side, for the operator's program.
inline Topic frames() {
  return {"rt/foresight/frames", StereoFrame::kType, Delivery::newest, 1};
}
/// Of pairs that are coded for a thin line. Room for all pieces of a few pairs: a reader that decodes takes none.
inline Topic pieces() {
  return {"rt/foresight/pieces", StereoPiece::kType, Delivery::once, 512};
}
inline Topic robot_state() {
  return {"rt/foresight/robot_state", RobotState::kType, Delivery::kept, 1};
}
/// Each once: the next one is newer.
inline Topic gate_motion() {
  return {"rt/foresight/gate_motion", GateMotion::kType, Delivery::once, 16};
}
// From the operator side.
inline Topic reports() {
  return {"rt/foresight/reports", StereoReport::kType, Delivery::once, 32};
}

// From the robot side, for ROS 2's tools: copies. What is read often has room for a few, as such tools expect.
inline Topic joint_states() {
  return {"rt/joint_states", JointStateMessage::kType, Delivery::newest, 8};
}
inline Topic set_points() {
  return {"rt/foresight/set_points", JointTrajectory::kType, Delivery::newest, 8};
}
inline Topic transforms() {
  return {"rt/tf", TFMessage::kType, Delivery::newest, 16};
}
inline Topic static_transforms() {
  return {"rt/tf_static", TFMessage::kType, Delivery::kept, 1};
}
inline Topic diagnostics() {
  return {"rt/diagnostics", DiagnosticArray::kType, Delivery::newest, 8};
}
/// `side`: "left" or "right".
inline Topic compressed_images(const std::string& side) {
  return {"rt/" + side + "/image_raw/compressed", CompressedImage::kType, Delivery::newest, 1};
}
inline Topic camera_info(const std::string& side) {
  return {"rt/" + side + "/camera_info", CameraInfoMessage::kType, Delivery::newest, 1};
}

}  // namespace foresight::link::topics
