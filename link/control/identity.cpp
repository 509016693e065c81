#include "link/control/identity.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "common/text.hpp"
#include "link/control/messages.hpp"

namespace foresight {
namespace {

constexpr std::size_t kLongestText = 80;

std::string bounded_text(const std::string& text) {
  std::string out = text.substr(0, kLongestText);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, '?');
  return out;
}

void compare(std::vector<Difference>& out, const char* what, std::uint64_t here, std::uint64_t there, bool refuses,
             const char* cure) {
  if (here == there) return;
  const auto side = [](std::uint64_t digest) { return digest == 0 ? "none" : fmt::format("{:08x}", digest >> 32); };
  out.push_back(
      {fmt::format("another {}: the robot has {}, the operator {}", what, side(here), side(there)), cure, refuses});
}

void compare_joints(std::vector<Difference>& out, const Identity& robot, const Identity& other) {
  if (robot.joints == other.joints) return;
  if (robot.joints.size() != other.joints.size()) {
    out.push_back(
        {fmt::format("the robot has {} joints, the operator's model {}", robot.joints.size(), other.joints.size()),
         "give both sides the same rig file", true});
    return;
  }
  const auto at = std::mismatch(robot.joints.begin(), robot.joints.end(), other.joints.begin());
  out.push_back({fmt::format("joint {} is {} on the robot, {} in the operator's model",
                             at.first - robot.joints.begin() + 1, in_quotes(*at.first), in_quotes(*at.second)),
                 "give both sides the same rig file", true});
}

}  // namespace

std::uint64_t digest_of(std::string_view bytes) {
  std::uint64_t out = 0xcbf29ce484222325;
  for (const char c : bytes) out = (out ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return out == 0 ? 1 : out;
}

std::vector<Difference> differences(const Identity& robot, const Identity& other) {
  std::vector<Difference> out;
  if (robot.protocol != other.protocol)
    out.push_back({fmt::format("the robot speaks version {} of the line's protocol, the operator version {}",
                               robot.protocol, other.protocol),
                   robot.protocol < other.protocol ? "update the robot's program" : "update the operator's program",
                   true});
  const bool is_understood = out.empty();
  if (robot.program != other.program)
    out.push_back({fmt::format("the robot runs foresight {}, the operator {}", robot.program, other.program),
                   "update the older one", false});
  if (!is_understood) return out;
  compare(out, "URDF", robot.urdf, other.urdf, true, "copy the robot's URDF to the operator");
  compare(out, "rig file", robot.rig, other.rig, true, "copy the robot's rig file to the operator");
  compare(out, "calibration", robot.calibration, other.calibration, false,
          "copy the robot's calibration results to the operator");
  compare_joints(out, robot, other);
  if (robot.scene != 0 && other.scene != 0)
    compare(out, "scene", robot.scene, other.scene, false,
            "start both sides with the same --scene, --physics and --layout");
  return out;
}

std::string refusal_text(std::span<const Difference> differences) {
  std::string out;
  for (const Difference& d : differences)
    if (d.refuses) out += fmt::format("{}{}; {}", out.empty() ? "" : ". ", d.words, d.cure);
  return out;
}

Identity bounded(Identity from_outside) {
  from_outside.program = bounded_text(from_outside.program);
  from_outside.name = bounded_text(from_outside.name);
  if (from_outside.joints.size() > kMostLineJoints + 1) from_outside.joints.resize(kMostLineJoints + 1);
  for (std::string& joint : from_outside.joints) joint = bounded_text(joint);
  return from_outside;
}

}  // namespace foresight
