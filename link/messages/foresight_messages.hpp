// What both sides tell each other where ROS 2 has no message for it; idl/foresight_msgs.idl has the same fields.
//
// Instants `..._ns` are those of the writer's own monotonic clock (RobotTime::ns of the robot's), as only they survive
// a step of the wall clock; a header's stamp is the wall clock's, for ROS 2's tools.
#pragma once

#include "link/messages/ros_messages.hpp"

namespace foresight::link {

/// A joint at the instant of an image.
struct JointSample {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::JointSample_";
  static constexpr std::uint8_t kKnown = 0, kLastHeardOf = 1, kNeverKnown = 2;
  std::string name;
  std::uint8_t status = kNeverKnown;
  double position = 0;  ///< rad or m; 0 where it was never known
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("name", m.name)("status", m.status)("position", m.position);
  }
};

struct CodedImage {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::CodedImage_";
  std::int64_t capture_ns = 0;          ///< middle of the exposure of the middle row
  std::int64_t uncertainty_ns = 0;      ///< of it, half width
  std::uint32_t width = 0, height = 0;  ///< px, of the camera's image, which its lens belongs to
  bool has_pose = false;
  PoseMessage t_world_camera;      ///< T_world_camera at `capture_ns`; means nothing without `has_pose`
  std::vector<std::uint8_t> data;  ///< as StereoFrame::coding says
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("capture_ns", m.capture_ns)("uncertainty_ns", m.uncertainty_ns)("width", m.width)("height", m.height)(
        "has_pose", m.has_pose)("t_world_camera", m.t_world_camera)("data", m.data);
  }
};

/// When the left image's pair came through each stage of the robot side, in this order; 0: was not stamped.
struct StageStamps {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::StageStamps_";
  std::int64_t paired_ns = 0;      ///< both images were there
  std::int64_t registered_ns = 0;  ///< its poses were found
  std::int64_t taken_ns = 0;       ///< the coder took it
  std::int64_t coded_ns = 0;       ///< it was ready to be sent
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("paired_ns", m.paired_ns)("registered_ns", m.registered_ns)("taken_ns", m.taken_ns)("coded_ns", m.coded_ns);
  }
};

inline constexpr const char* kJpegCoding = "jpeg";  ///< StereoFrame::coding
inline constexpr const char* kH264Coding = "h264";

/// A pair of images, and where everything was when it was taken: one message, as separate topics tear.
struct StereoFrame {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::StereoFrame_";
  Header header;              ///< the left image's capture on the wall clock; frame_id "world"
  std::uint64_t session = 0;  ///< of the robot's program: another one means that it was started anew
  std::uint64_t number = 0;   ///< from 1 on, in the order of capture; one that is missing was not sent or was lost
  StageStamps stamps;
  std::string quality;             ///< "tags", "held", "encoders", "given", "lost", "none": how the poses were found
  double predicted_px = -1;        ///< expected error of the left pose, RMS over the image; -1: not known
  std::uint8_t joints_status = 3;  ///< of the worst joint: 0 exact, 1 interpolated, 2 predicted, 3 invalid
  std::vector<JointSample> joints;
  /// "jpeg": each image one JPEG in its own bytes. "h264": both in a coded pair that this message travels with
  /// (link/coding/coded_pair.hpp), and no bytes here.
  std::string coding;
  std::string lenses_revision;  ///< changes with every calibration of either lens; "" without one
  CodedImage left, right;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("session", m.session)("number", m.number)("stamps", m.stamps)("quality", m.quality)(
        "predicted_px", m.predicted_px)("joints_status", m.joints_status)("joints", m.joints)("coding", m.coding)(
        "lenses_revision", m.lenses_revision)("left", m.left)("right", m.right);
  }
};

/// A piece of a coded pair (StereoFrame::coding "h264"), to one reader: packets of link/send_control/packets.hpp. A
/// sample each, sent once: what gets lost is sent again by who knows whether it is still wanted.
struct StereoPiece {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::StereoPiece_";
  std::uint64_t session = 0;       ///< StereoFrame::session
  std::uint64_t reader = 0;        ///< StereoReport::reader whom it is for
  std::uint32_t stream = 0;        ///< from 1 on: another one begins anew, with numbers of its own
  std::vector<std::uint8_t> data;  ///< one packet
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("session", m.session)("reader", m.reader)("stream", m.stream)("data", m.data);
  }
};

/// What a reader received. Each says all again that matters, so that one that is lost does no harm.
struct StereoReport {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::StereoReport_";
  std::uint64_t session = 0;                  ///< StereoFrame::session; 0: none heard of yet
  std::uint64_t reader = 0;                   ///< who reports, chosen at random
  std::uint32_t stream = 0;                   ///< StereoPiece::stream that is acknowledged; 0: none came yet
  std::int64_t sent_ns = 0;                   ///< on the reader's clock
  std::uint64_t newest_shown = 0;             ///< StereoFrame::number; 0: none yet
  std::vector<std::uint8_t> acknowledgement;  ///< one packet; empty: no piece came since
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("session", m.session)("reader", m.reader)("stream", m.stream)("sent_ns", m.sent_ns)(
        "newest_shown", m.newest_shown)("acknowledgement", m.acknowledgement);
  }
};

/// A state or reason: what programs compare, and what people read.
struct Words {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::Words_";
  std::string label;  ///< a word or two that stay the same
  std::string name;   ///< what is the case
  std::string cure;   ///< what to do about it; may be empty
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("label", m.label)("name", m.name)("cure", m.cure);
  }
};

struct DriveLine {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::DriveLine_";
  std::string name, state, unit;  ///< of the joint; "enabled" and so on; "rad" or "m"
  bool homed = false, limit = false;
  std::uint32_t fault_code = 0;
  std::string fault;                  ///< its meaning
  std::int64_t told_ns = 0;           ///< when the drive last told its position; 0: never
  bool known = false;                 ///< it has told; else all below are 0
  double position = 0, velocity = 0;  ///< measured
  double set_point = 0;               ///< sent in the last cycle
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("name", m.name)("state", m.state)("unit", m.unit)("homed", m.homed)("limit", m.limit)("fault_code", m.fault_code)(
        "fault", m.fault)("told_ns", m.told_ns)("known", m.known)("position", m.position)("velocity", m.velocity)(
        "set_point", m.set_point);
  }
};

struct CameraLines {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::CameraLines_";
  bool present = false;           ///< the rig has cameras, and they are to run
  std::string fault, last_fault;  ///< why no pairs come, in words; "" where they do
  double pairs_per_s = 0;
  std::int64_t newest_ns = 0;                                       ///< capture of the newest pair; 0: none yet
  std::uint64_t missed = 0, unpaired = 0, damaged = 0, losses = 0;  ///< of both cameras, since the start
  std::string registration;                                         ///< what the newest pair's poses lack; "" nothing
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("present", m.present)("fault", m.fault)("last_fault", m.last_fault)("pairs_per_s", m.pairs_per_s)(
        "newest_ns", m.newest_ns)("missed", m.missed)("unpaired", m.unpaired)("damaged", m.damaged)("losses", m.losses)(
        "registration", m.registration);
  }
};

/// How punctual the control loop is.
struct LoopLines {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::LoopLines_";
  double rate_hz = 0;
  std::uint64_t cycles = 0, overruns = 0;
  double late_p50_s = 0, late_p99_s = 0, late_worst_s = 0;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("rate_hz", m.rate_hz)("cycles", m.cycles)("overruns", m.overruns)("late_p50_s", m.late_p50_s)(
        "late_p99_s", m.late_p99_s)("late_worst_s", m.late_worst_s);
  }
};

/// A joint in one cycle of the control loop.
struct GateMotionJoint {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::GateMotionJoint_";
  bool known = false;        ///< `position` is that of the joint: homed, and heard of; else 0
  double position = 0;       ///< measured, rad or m
  std::int32_t told_us = 0;  ///< before `time_ns`, when the drive told it
  double set_point = 0;      ///< sent in the cycle
  float velocity = 0;        ///< of the set-point
  float acceleration = 0;    ///< likewise
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("known", m.known)("position", m.position)("told_us", m.told_us)("set_point", m.set_point)("velocity", m.velocity)(
        "acceleration", m.acceleration);
  }
};

/// What the safety gate did in one cycle, for who predicts what it will do (prediction/robot_report.hpp).
struct GateMotion {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::GateMotion_";
  std::uint64_t session = 0;  ///< StereoFrame::session
  std::uint64_t number = 0;   ///< from 1 on
  std::int64_t time_ns = 0;   ///< begin of the cycle
  std::uint8_t doing = 4;     ///< GateDoing: 0 idle, 1 following, 2 stopping, 3 stopped, 4 away
  double speed = 0;           ///< 0 .. 1: where the ramp is
  /// The newest set-point over the line that the gate had by then: whose (his start of his program), its number, when
  /// it came; 0: none.
  std::uint64_t commander = 0, set_point = 0;
  std::int64_t set_point_came_ns = 0;
  std::vector<GateMotionJoint> joints;  ///< all of them, in the rig's order
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("session", m.session)("number", m.number)("time_ns", m.time_ns)("doing", m.doing)("speed", m.speed)(
        "commander", m.commander)("set_point", m.set_point)("set_point_came_ns", m.set_point_came_ns)("joints",
                                                                                                      m.joints);
  }
};

/// What the robot does and why, its drives, its cameras and its loop.
struct RobotState {
  static constexpr const char* kType = "foresight_msgs::msg::dds_::RobotState_";
  Header header;
  std::uint64_t session = 0;  ///< StereoFrame::session
  std::uint64_t number = 0;   ///< from 1 on
  std::int64_t time_ns = 0;   ///< begin of the cycle that it tells of
  std::string rig;            ///< its name
  Words phase, gate, reason;
  Words doing;               ///< all of that in one sentence, and its cure; no label
  std::string detail, hold;  ///< more words to the reason; what holds the robot back
  std::uint64_t operator_id = 0, accepted = 0, dropped = 0;
  std::string last_dropped;  ///< label of why
  double speed = 0;          ///< 0 .. 1: where the ramp is
  bool all_homed = false, bus_healthy = false;
  std::string bus_reason, refused;  ///< why the last request was not followed
  std::vector<DriveLine> drives;
  CameraLines cameras;
  LoopLines loop;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("session", m.session)("number", m.number)("time_ns", m.time_ns)("rig", m.rig)(
        "phase", m.phase)("gate", m.gate)("reason", m.reason)("doing", m.doing)("detail", m.detail)("hold", m.hold)(
        "operator_id", m.operator_id)("accepted", m.accepted)("dropped", m.dropped)("last_dropped", m.last_dropped)(
        "speed", m.speed)("all_homed", m.all_homed)("bus_healthy", m.bus_healthy)("bus_reason", m.bus_reason)(
        "refused", m.refused)("drives", m.drives)("cameras", m.cameras)("loop", m.loop);
  }
};

}  // namespace foresight::link
