// What a message from elsewhere must keep to before anything uses it. Bytes that decode can still say nonsense.
#pragma once

#include <optional>
#include <string>

#include "link/messages/foresight_messages.hpp"

namespace foresight::link {

/// What the one who receives a message knows. What is not given is not judged.
struct Expected {
  /// The writer's monotonic clock now, as late as it may be: a capture or stamp beyond it comes from the future.
  std::optional<std::int64_t> writer_now_ns = {};
  std::vector<std::string> joints = {};  ///< names, in the rig's order
  /// Of the calibrations of left and right, px.
  std::optional<std::array<std::uint32_t, 4>> image_sizes = {};  ///< left width, height, right width, height
};

inline constexpr std::size_t kMostText = 4096;              ///< characters
inline constexpr std::size_t kMostImageBytes = 16'000'000;  ///< of one image, coded or not
inline constexpr std::size_t kMostPieceBytes = 1200;        ///< of a packet in a piece or report
inline constexpr std::uint32_t kMostPixels = 8192;          ///< along one side

/// Why a text from elsewhere is not taken: longer than `most` characters, or with control characters, which a terminal
/// would obey; "" where it is.
std::string text_objection(const std::string& text, std::size_t most);

/// What is wrong with a message, in words that begin with the field ("joints[2].position is nan"); "" where nothing is.
/// All types: numbers that are not finite, texts that are too long or have control characters, stamps that are none.
/// Beside that, by type: counts that do not fit each other, joints that do not exist or come twice, rotations without
/// unit length, images of another size, instants of the future, enumerations that have no such value.
std::string objection(const JointStateMessage& message, const Expected& expected = {});
std::string objection(const TFMessage& message, const Expected& expected = {});
std::string objection(const PoseStamped& message, const Expected& expected = {});
std::string objection(const Twist& message, const Expected& expected = {});
std::string objection(const ImageMessage& message, const Expected& expected = {});
std::string objection(const CompressedImage& message, const Expected& expected = {});
std::string objection(const CameraInfoMessage& message, const Expected& expected = {});
std::string objection(const JointTrajectory& message, const Expected& expected = {});
std::string objection(const DiagnosticArray& message, const Expected& expected = {});
std::string objection(const StereoFrame& message, const Expected& expected = {});
std::string objection(const StereoPiece& message, const Expected& expected = {});
std::string objection(const StereoReport& message, const Expected& expected = {});
std::string objection(const GateMotion& message, const Expected& expected = {});
std::string objection(const RobotState& message, const Expected& expected = {});

}  // namespace foresight::link
