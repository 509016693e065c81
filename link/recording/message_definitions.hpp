// What a recording says about the types of its messages, made from the IDL of link/messages.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace foresight::link {

struct MessageDefinition {
  std::string name;  ///< "sensor_msgs/msg/JointState"
  std::string
      encoding;      ///< MCAP's names (mcap.dev/spec/registry): "ros2msg", or "omgidl" where ROS 2 cannot say it; ""
  std::string text;  ///< the type's definition, and those of all types in it
};

/// By the type's name on DDS, "sensor_msgs::msg::dds_::JointState_". Of a type that the IDL does not have: its name
/// alone.
MessageDefinition message_definition(std::string_view dds_type);

namespace detail {
/// The texts of link/messages/idl. Embedded by CMake.
std::span<const char* const> idl_texts();
}  // namespace detail

}  // namespace foresight::link
