// All types of messages that this program reads, for tools that learn a topic's type only while they run.
#pragma once

#include <span>

#include "link/messages/checks.hpp"

namespace foresight::link {

/// A type by its name on DDS. Plain functions over bytes (cdr.hpp).
struct MessageType {
  const char* name;  ///< "sensor_msgs::msg::dds_::JointState_"
  struct Reading {
    std::string objection;                      ///< also of bytes that do not decode; "" where all is well
    std::optional<std::int64_t> stamp_unix_ns;  ///< of its header, where it has one
    std::string text;                           ///< its fields, one a line, long sequences cut; only where asked for
  };
  Reading (*read)(std::span<const std::uint8_t> cdr, bool with_text);
  /// Is any of this program's checks passed? For tests: decodes, encodes again and compares.
  bool (*round_trips)(std::span<const std::uint8_t> cdr);
};

std::span<const MessageType> message_types();
/// Null: unknown.
const MessageType* find_message_type(std::string_view name);
/// "sensor_msgs/msg/JointState": as ROS 2's tools call it; other names as they are.
std::string ros_name(std::string_view dds_type);

}  // namespace foresight::link
