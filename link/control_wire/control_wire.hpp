// Messages of control (link/control/messages.hpp) as bytes and back: what DDS carries of them. idl/control_msgs.idl of
// link/messages has the same fields.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "link/control/messages.hpp"

namespace foresight::link {

/// Types on DDS.
inline constexpr const char* kFromOperatorType = "foresight_msgs::msg::dds_::FromOperator_";
inline constexpr const char* kFromRobotType = "foresight_msgs::msg::dds_::FromRobot_";

std::vector<std::uint8_t> to_bytes(const FromOperator& message);
std::vector<std::uint8_t> to_bytes(const FromRobot& message);

/// Nothing where the bytes are no such message, or say what cannot be meant: an enumeration without that value, more
/// joints than there may be, a text longer than a line, a number that is not finite where it counts. What is old,
/// doubled or a stranger's is for ControlDesk and ControlSeat to know. `why`: null, or gets what is wrong, in words.
/// Of another version's Hello and Welcome what all versions have in common: who that is, and a Welcome's `robot`.
std::optional<FromOperator> from_operator(std::span<const std::uint8_t> bytes, std::string* why = nullptr);
std::optional<FromRobot> from_robot(std::span<const std::uint8_t> bytes, std::string* why = nullptr);

}  // namespace foresight::link
