#include "seat/hand_sight.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kWorthWords = 0.03;  // m: nearer than this, a distance is told
constexpr std::size_t kMostLimits = 2;

SeatLine mode_line(const HandSight& sight, std::span<const std::string> names) {
  if (sight.mode == HandMode::tool) return {"moves", "the tool", ""};
  const std::string name = sight.joint < names.size() ? " (" + names[sight.joint] + ")" : "";
  return {"moves", fmt::format("joint {}{} alone", sight.joint + 1, name), sight.has_tool ? "M: the tool again" : ""};
}

SeatLine touch_line(const HandSight& sight) {
  const GhostHand& ghost = sight.touch.ghost;
  if (!sight.touch.known) return {"hand", ghost.words, "nothing moves until it is known again", Urgency::trouble};
  if (ghost.reason == GhostReason::contact)
    return {"hand", ghost.words, fmt::format("move away; your hand is {:.0f} mm further", 1e3 * ghost.ahead),
            Urgency::note};
  if (ghost.reason == GhostReason::gate)
    return {"hand", "too close: " + ghost.words, "move away; the robot would stop there", Urgency::note};
  return {};
}

SeatLine near_line(const HandSight& sight) {
  if (sight.touch.near.empty() || sight.touch.near.front().distance > kWorthWords) return {};
  const NearPart& nearest = sight.touch.near.front();
  return {"near", fmt::format("{} {:.0f} mm from {}", nearest.part, 1e3 * nearest.distance, nearest.other), ""};
}

SeatLine limits_line(const HandSight& sight, std::span<const std::string> names) {
  SeatLine out{"limits", "", "come another way", Urgency::note};
  for (std::size_t i = 0; i < std::min(sight.limits.size(), kMostLimits); ++i)
    out.words += (i > 0 ? "; " : "") + words_of(sight.limits[i], names);
  return out;
}

}  // namespace

std::vector<NearLimit> near_limits(const HandOptions& hand, const JointValues& positions) {
  std::vector<NearLimit> out;
  for (std::size_t i = 0; i < hand.arm_joints.size(); ++i) {
    const ArmJoint& joint = hand.arm->joints()[i];
    const double position = positions[hand.arm_joints[i]], half = 0.5 * (joint.upper - joint.lower);
    const double share = std::abs(position - 0.5 * (joint.lower + joint.upper)) / half;
    if (std::isfinite(share) && share >= kNearLimit)
      out.push_back({hand.arm_joints[i], std::min(share, 1.0), position, joint.lower, joint.upper});
  }
  std::ranges::stable_sort(out, std::greater<>(), &NearLimit::share);
  return out;
}

std::string words_of(const NearLimit& limit, std::span<const std::string> names) {
  const std::string name = limit.joint < names.size() ? " (" + names[limit.joint] + ")" : "";
  return fmt::format("joint {}{} at {:.0f} % of its range", limit.joint + 1, name, 1e2 * limit.share);
}

std::vector<SeatLine> hand_lines(const HandSight& sight, std::span<const std::string> names) {
  std::vector<SeatLine> out;
  if (sight.phase == HandPhase::driving) out = {touch_line(sight), near_line(sight)};
  if (sight.joints > 0) out.push_back(limits_line(sight, names));
  if (!sight.touch.carried.empty()) out.push_back({"carries", sight.touch.carried, ""});
  if (sight.joints > 0) out.push_back(mode_line(sight, names));
  std::erase_if(out, [](const SeatLine& line) { return line.words.empty(); });
  return out;
}

}  // namespace foresight
