// ROS 2's messages as plain values. Units, frames and meanings are those of ROS 2 Humble's own definitions
// (docs.ros.org, common_interfaces); field for field as in idl/ros_messages.idl, which a test holds against them.
//
// Every message names its fields in order, once, in visit(): the codec (cdr.hpp), the checks and the texts are made
// from it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace foresight::link {

struct RosTime {
  static constexpr const char* kType = "builtin_interfaces::msg::dds_::Time_";
  std::int32_t sec = 0;       ///< since 1970, UTC
  std::uint32_t nanosec = 0;  ///< < 1e9
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("sec", m.sec)("nanosec", m.nanosec);
  }
};
/// Of unix time; saturates where 32 bits of seconds do not hold it.
RosTime ros_time(std::int64_t unix_ns);
std::int64_t unix_ns(const RosTime& time);

struct RosDuration {
  static constexpr const char* kType = "builtin_interfaces::msg::dds_::Duration_";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;  ///< < 1e9
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("sec", m.sec)("nanosec", m.nanosec);
  }
};

struct Header {
  static constexpr const char* kType = "std_msgs::msg::dds_::Header_";
  RosTime stamp;
  std::string frame_id;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("stamp", m.stamp)("frame_id", m.frame_id);
  }
};

struct Vector3 {  // also a geometry_msgs Point, which has the same fields
  static constexpr const char* kType = "geometry_msgs::msg::dds_::Vector3_";
  double x = 0, y = 0, z = 0;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("x", m.x)("y", m.y)("z", m.z);
  }
};

struct Quaternion {
  static constexpr const char* kType = "geometry_msgs::msg::dds_::Quaternion_";
  double x = 0, y = 0, z = 0, w = 1;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("x", m.x)("y", m.y)("z", m.z)("w", m.w);
  }
};

struct PoseMessage {
  static constexpr const char* kType = "geometry_msgs::msg::dds_::Pose_";
  Vector3 position;
  Quaternion orientation;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("position", m.position)("orientation", m.orientation);
  }
};

struct PoseStamped {
  static constexpr const char* kType = "geometry_msgs::msg::dds_::PoseStamped_";
  Header header;
  PoseMessage pose;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("pose", m.pose);
  }
};

struct Transform {
  static constexpr const char* kType = "geometry_msgs::msg::dds_::Transform_";
  Vector3 translation;
  Quaternion rotation;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("translation", m.translation)("rotation", m.rotation);
  }
};

struct TransformStamped {
  static constexpr const char* kType = "geometry_msgs::msg::dds_::TransformStamped_";
  Header header;               ///< `frame_id`: the parent
  std::string child_frame_id;  ///< `transform` maps its coordinates to the parent's: T_parent_child
  Transform transform;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("child_frame_id", m.child_frame_id)("transform", m.transform);
  }
};

struct Twist {
  static constexpr const char* kType = "geometry_msgs::msg::dds_::Twist_";
  Vector3 linear, angular;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("linear", m.linear)("angular", m.angular);
  }
};

struct TFMessage {
  static constexpr const char* kType = "tf2_msgs::msg::dds_::TFMessage_";
  std::vector<TransformStamped> transforms;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("transforms", m.transforms);
  }
};

struct ImageMessage {
  static constexpr const char* kType = "sensor_msgs::msg::dds_::Image_";
  Header header;
  std::uint32_t height = 0, width = 0;  ///< px
  std::string encoding;                 ///< "bgr8", "mono8"
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  ///< bytes from row to row
  std::vector<std::uint8_t> data;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("height", m.height)("width", m.width)("encoding", m.encoding)("is_bigendian", m.is_bigendian)(
        "step", m.step)("data", m.data);
  }
};

struct CompressedImage {
  static constexpr const char* kType = "sensor_msgs::msg::dds_::CompressedImage_";
  Header header;
  std::string format;  ///< "bgr8; jpeg compressed bgr8", as image_transport writes it
  std::vector<std::uint8_t> data;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("format", m.format)("data", m.data);
  }
};

struct RegionOfInterest {
  static constexpr const char* kType = "sensor_msgs::msg::dds_::RegionOfInterest_";
  std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;
  bool do_rectify = false;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("x_offset", m.x_offset)("y_offset", m.y_offset)("height", m.height)("width", m.width)("do_rectify", m.do_rectify);
  }
};

struct CameraInfoMessage {
  static constexpr const char* kType = "sensor_msgs::msg::dds_::CameraInfo_";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;  ///< docs/conventions.md
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  RegionOfInterest roi;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("height", m.height)("width", m.width)("distortion_model", m.distortion_model)("d", m.d)(
        "k", m.k)("r", m.r)("p", m.p)("binning_x", m.binning_x)("binning_y", m.binning_y)("roi", m.roi);
  }
};

struct JointStateMessage {
  static constexpr const char* kType = "sensor_msgs::msg::dds_::JointState_";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;  ///< one per name, or none at all
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("name", m.name)("position", m.position)("velocity", m.velocity)("effort", m.effort);
  }
};

struct JointTrajectoryPoint {
  static constexpr const char* kType = "trajectory_msgs::msg::dds_::JointTrajectoryPoint_";
  std::vector<double> positions, velocities, accelerations, effort;  ///< one per joint, or none at all
  RosDuration time_from_start;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("positions", m.positions)("velocities", m.velocities)("accelerations", m.accelerations)("effort", m.effort)(
        "time_from_start", m.time_from_start);
  }
};

struct JointTrajectory {
  static constexpr const char* kType = "trajectory_msgs::msg::dds_::JointTrajectory_";
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("joint_names", m.joint_names)("points", m.points);
  }
};

struct KeyValue {
  static constexpr const char* kType = "diagnostic_msgs::msg::dds_::KeyValue_";
  std::string key, value;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("key", m.key)("value", m.value);
  }
};

struct DiagnosticStatus {
  static constexpr const char* kType = "diagnostic_msgs::msg::dds_::DiagnosticStatus_";
  static constexpr std::uint8_t kOk = 0, kWarn = 1, kError = 2, kStale = 3;
  std::uint8_t level = kOk;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("level", m.level)("name", m.name)("message", m.message)("hardware_id", m.hardware_id)("values", m.values);
  }
};

struct DiagnosticArray {
  static constexpr const char* kType = "diagnostic_msgs::msg::dds_::DiagnosticArray_";
  Header header;
  std::vector<DiagnosticStatus> status;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("header", m.header)("status", m.status);
  }
};

}  // namespace foresight::link
