#include "rig/joint_groups.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <ranges>
#include <span>
#include <string_view>

#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kShortStroke = 0.15;           // m: a last link that slides farther is no finger
constexpr double kJawsTurn = std::numbers::pi;  // rad: a last joint that turns farther is a wrist
constexpr double kParallel = 0.99;              // cosine
constexpr double kNewWay = 0.5;                 // of a direction that earlier slides leave

constexpr std::array kJawWords{std::string_view("finger"), std::string_view("fingers"),   std::string_view("jaw"),
                               std::string_view("jaws"),   std::string_view("grip"),      std::string_view("gripper"),
                               std::string_view("claw"),   std::string_view("fingertip"), std::string_view("pad")};
constexpr std::array kAxisWords{std::string_view("wrist"), std::string_view("roll"),     std::string_view("pitch"),
                                std::string_view("yaw"),   std::string_view("rotate"),   std::string_view("lift"),
                                std::string_view("z"),     std::string_view("rotation"), std::string_view("slide")};
constexpr std::array kToolWords{std::string_view("tool"), std::string_view("tcp"),      std::string_view("ee"),
                                std::string_view("eef"),  std::string_view("effector"), std::string_view("tip"),
                                std::string_view("hand"), std::string_view("flange"),   std::string_view("grasp")};
constexpr std::array kSensorWords{std::string_view("camera"), std::string_view("optical"), std::string_view("imu"),
                                  std::string_view("sensor"), std::string_view("laser"),   std::string_view("ft")};
constexpr std::array kArmWords{std::string_view("arm"),   std::string_view("shoulder"), std::string_view("elbow"),
                               std::string_view("wrist"), std::string_view("hand"),     std::string_view("gripper")};
constexpr std::array kHeadWords{std::string_view("head"), std::string_view("neck"), std::string_view("camera"),
                                std::string_view("ptu")};

/// "Finger2_joint" has the words finger and joint; long ones may have something before them, as in "leftfinger".
bool has_word(std::string_view name, std::span<const std::string_view> words) {
  constexpr std::size_t kLong = 5;
  const std::string text = lower(name) + "_";
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] >= 'a' && text[i] <= 'z') continue;
    const std::string_view found = std::string_view(text).substr(begin, i - begin);
    if (std::ranges::any_of(words, [&](std::string_view word) {
          return found == word || (word.size() >= kLong && found.ends_with(word));
        }))
      return true;
    begin = i + 1;
  }
  return false;
}

bool has_word(std::string_view name, std::string_view word) {
  return has_word(name, std::span(&word, 1));
}

class Structure {
 public:
  explicit Structure(const UrdfRobot& robot) : robot_(robot) {
    T_root_link_.resize(robot.links.size(), Pose::Identity());
    body_.resize(robot.links.size());
    leaf_.resize(robot.links.size(), true);
    for (std::size_t link = 1; link < robot.links.size(); ++link) {
      const auto parent = static_cast<std::size_t>(robot.links[link].parent);
      leaf_[parent] = false;
      T_root_link_[link] = T_root_link_[parent] * joint_of(link).T_parent_joint;
      body_[link] = joint_of(link).kind == UrdfJoint::Kind::fixed ? body_[parent] : link;
    }
  }

  bool drives(std::size_t joint) const {
    return robot_.joints[joint].kind != UrdfJoint::Kind::fixed && !robot_.joints[joint].mimic;
  }
  /// What the joint moves moves `link`, too.
  bool carries(std::size_t joint, std::size_t link) const {
    for (; link > 0; link = parent_of(link))
      if (link == joint + 1) return true;
    return false;
  }
  bool carries_joint(std::size_t joint, std::size_t other) const { return other != joint && carries(joint, other + 1); }
  /// The link that stands for all that moves together with what the joint is fixed to.
  std::size_t stands_on(std::size_t joint) const { return body_[parent_of(joint + 1)]; }
  Eigen::Vector3d axis(std::size_t joint) const { return T_root_link_[joint + 1].linear() * robot_.joints[joint].axis; }
  const UrdfJoint& joint(std::size_t index) const { return robot_.joints[index]; }
  std::size_t joints() const { return robot_.joints.size(); }

  /// The joints with drives that carry `joint`.
  std::vector<std::size_t> before(std::size_t joint) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < joints(); ++i)
      if (drives(i) && carries_joint(i, joint)) out.push_back(i);
    return out;
  }
  /// Those that move on their own beyond it.
  std::size_t count_carried(std::size_t joint) const {
    std::size_t out = 0;
    for (std::size_t i = 0; i < joints(); ++i) out += drives(i) && carries_joint(joint, i);
    return out;
  }
  bool follows(std::size_t follower, std::size_t joint) const {
    return robot_.joints[follower].mimic && source_of(robot_, follower).joint == static_cast<int>(joint);
  }
  double factor(std::size_t follower) const { return source_of(robot_, follower).factor; }

  /// A frame without a body, as descriptions have where a tool is held.
  bool is_frame(std::size_t link) const {
    return leaf_[link] && robot_.body(link).vertices.empty() && !has_word(robot_.links[link].name, kSensorWords);
  }
  /// What the joint itself moves may lack its shape only.
  bool has_tool_behind(std::size_t joint) const {
    for (std::size_t link = 1; link < robot_.links.size(); ++link) {
      const std::string& name = robot_.links[link].name;
      if (carries(joint, link) && is_frame(link) && (link != joint + 1 || has_word(name, kToolWords)) &&
          !has_word(name, kJawWords))
        return true;
    }
    return false;
  }
  bool has_tool_beside(std::size_t joint) const {
    for (std::size_t link = 1; link < robot_.links.size(); ++link)
      if (body_[link] == stands_on(joint) && is_frame(link) &&
          (has_word(robot_.links[link].name, kToolWords) || has_word(robot_.links[link].name, kJawWords)))
        return true;
    return false;
  }

 private:
  const UrdfJoint& joint_of(std::size_t link) const { return robot_.joints[link - 1]; }
  std::size_t parent_of(std::size_t link) const { return static_cast<std::size_t>(robot_.links[link].parent); }

  const UrdfRobot& robot_;
  std::vector<Pose> T_root_link_;  // all joints at 0
  std::vector<std::size_t> body_;  // per link
  std::vector<bool> leaf_;         // per link
};

bool ends(const UrdfJoint& joint) {
  return std::isfinite(joint.lower) && std::isfinite(joint.upper);
}

// ---- the head

/// A branch that begins with pan, or a rig of a head alone. At the end of a longer chain only a name tells that no arm
/// looks there.
bool is_head(const Structure& robot, std::size_t pan, std::size_t tilt) {
  const UrdfJoint &first = robot.joint(pan), &second = robot.joint(tilt);
  if (first.kind != UrdfJoint::Kind::rotating || second.kind != UrdfJoint::Kind::rotating) return false;
  if (!robot.carries_joint(pan, tilt) || robot.count_carried(pan) != 1) return false;
  for (std::size_t i = 0; i < robot.joints(); ++i)
    if (robot.joint(i).kind != UrdfJoint::Kind::fixed && robot.carries_joint(tilt, i)) return false;
  if (has_word(first.name, kHeadWords) || has_word(second.name, kHeadWords)) return true;
  if (has_word(first.name, kArmWords) || has_word(second.name, kArmWords)) return false;
  const std::vector<std::size_t> before = robot.before(pan);
  const bool own_branch = std::ranges::all_of(before, [&](std::size_t i) {
    const std::size_t on_the_way = robot.before(i).size() + 1;
    return robot.count_carried(i) > before.size() - on_the_way + 2;
  });
  return own_branch || before.size() <= 1;
}

std::vector<std::size_t> head_of(const Structure& robot) {
  std::vector<std::size_t> out;
  for (std::size_t pan = 0; pan < robot.joints(); ++pan)
    for (std::size_t tilt = 0; tilt < robot.joints(); ++tilt)
      if (robot.drives(pan) && robot.drives(tilt) && has_word(robot.joint(pan).name, "pan") &&
          has_word(robot.joint(tilt).name, "tilt") && is_head(robot, pan, tilt))
        out.insert(out.end(), {pan, tilt});
  return out.size() == 2 ? out : std::vector<std::size_t>{};  // a rig has one
}

// ---- grippers

/// It slides across all that the joints before it can do: those turn about its own direction or slide elsewhere.
bool leads_elsewhere(const Structure& robot, std::size_t joint) {
  const std::vector<std::size_t> before = robot.before(joint);
  Eigen::Vector3d left = robot.axis(joint);
  std::vector<Eigen::Vector3d> slides;
  for (const std::size_t i : before) {
    Eigen::Vector3d axis = robot.axis(i);
    if (robot.joint(i).kind == UrdfJoint::Kind::rotating) {
      if (std::abs(axis.dot(robot.axis(joint))) < kParallel) return false;
      continue;
    }
    for (const Eigen::Vector3d& other : slides) axis -= axis.dot(other) * other;
    if (axis.norm() < 1 - kParallel) continue;
    slides.push_back(axis.normalized());
    left -= left.dot(slides.back()) * slides.back();
  }
  return !before.empty() && left.norm() > kNewWay;
}

/// The end of a chain, with nothing on the other side of what it stands on.
bool is_lone_jaw(const Structure& robot, std::size_t joint) {
  const UrdfJoint& it = robot.joint(joint);
  const bool slides = it.kind == UrdfJoint::Kind::sliding;
  if (!ends(it) || it.upper - it.lower > (slides ? kShortStroke : kJawsTurn)) return false;
  const bool behind = robot.has_tool_behind(joint), beside = robot.has_tool_beside(joint);
  if (behind != beside) return beside;
  if (has_word(it.name, kJawWords) && !has_word(it.name, kAxisWords)) return true;
  return slides && !leads_elsewhere(robot, joint);
}

bool ends_chain(const Structure& robot, std::size_t joint) {
  return robot.count_carried(joint) == 0;
}

/// A lever that moves a joint beyond `branch` by a rod, beside it.
bool moves_from_beside(const Structure& robot, std::size_t lever, std::size_t branch) {
  for (std::size_t i = 0; i < robot.joints(); ++i)
    if (robot.follows(i, lever) && robot.carries_joint(branch, i) && !robot.carries_joint(lever, i)) return true;
  return false;
}

/// Something turns back what the joint turns, beyond it.
bool is_levelled(const Structure& robot, std::size_t joint) {
  for (std::size_t i = 0; i < robot.joints(); ++i)
    if (robot.follows(i, joint) && robot.carries_joint(joint, i) && robot.factor(i) < 0 &&
        robot.axis(i).dot(robot.axis(joint)) > kParallel)
      return true;
  return false;
}

/// Branches that stand on the same body and are shorter than the way to it are fingers; longer ones are arms.
bool are_fingers(const Structure& robot, const std::vector<std::size_t>& branches) {
  if (branches.size() < 2) return false;
  const std::size_t depth = robot.before(branches.front()).size();
  for (const std::size_t first : branches) {
    if (std::ranges::any_of(branches, [&](std::size_t other) { return moves_from_beside(robot, other, first); }))
      return false;
    std::size_t longest = 0;
    for (std::size_t i = 0; i < robot.joints(); ++i)
      if (robot.drives(i) && (i == first || robot.carries_joint(first, i))) {
        if (!ends(robot.joint(i))) return false;  // a wheel
        longest = std::max(longest, robot.before(i).size() - depth + 1);
      }
    if (longest > 1 && longest >= depth) return false;
  }
  return true;
}

bool is_followed_jaw(const Structure& robot, std::size_t joint) {
  bool followed = false;
  for (std::size_t i = 0; i < robot.joints(); ++i) {
    if (!robot.follows(i, joint)) continue;
    if (robot.stands_on(i) == robot.stands_on(joint)) return true;  // on the other side
    followed = followed || robot.carries_joint(joint, i);
  }
  if (!followed) return false;
  // A finger's own links, or a telescope, or what keeps a tool level.
  const bool behind = robot.has_tool_behind(joint), beside = robot.has_tool_beside(joint);
  if (behind != beside) return beside;
  if (has_word(robot.joint(joint).name, kJawWords)) return true;
  return robot.joint(joint).kind == UrdfJoint::Kind::rotating && !is_levelled(robot, joint);
}

// ---- groups that were given

bool is_farther_than_jaws(const UrdfJoint& joint) {
  const double most = joint.kind == UrdfJoint::Kind::sliding ? kShortStroke : kJawsTurn;
  return !ends(joint) || joint.upper - joint.lower > most;
}

bool is_named_as_jaw(const std::string& name) {
  return has_word(name, kJawWords) && !has_word(name, kAxisWords);
}

/// Why `joint`, in the group `given`, belongs to `guess` beyond doubt; "" where there is doubt.
std::string certain_of(const UrdfJoint& joint, JointGroup given, JointGroup guess, bool carries_others) {
  if (guess == JointGroup::pan_tilt) return "it is named and placed as one";
  if (guess == JointGroup::gripper) return is_named_as_jaw(joint.name) ? "it is named and placed as one" : "";
  if (carries_others) return "others of other groups move with it";
  if (given == JointGroup::pan_tilt || is_named_as_jaw(joint.name)) return "";
  return is_farther_than_jaws(joint) ? "it moves farther than jaws do" : "";
}

}  // namespace

std::vector<std::string> words_on_groups(const Rig& rig) {
  if (!rig.robot) return {};
  const Structure robot(*rig.robot);
  const std::vector<JointGroup> guesses = guess_joint_groups(*rig.robot);
  std::map<std::string, JointGroup> groups;
  for (const RigJoint& joint : rig.joints) groups[joint.drive.name] = joint.group;
  std::vector<std::string> out;
  for (std::size_t i = 0; i < guesses.size(); ++i) {
    const auto given = groups.find(robot.joint(i).name);
    if (given == groups.end() || given->second == guesses[i]) continue;
    const auto is_carried_other = [&](std::size_t other) {
      const auto its = groups.find(robot.joint(other).name);
      return its != groups.end() && its->second != given->second && robot.carries_joint(i, other);
    };
    const bool carries_others = std::ranges::any_of(std::views::iota(std::size_t{0}, robot.joints()), is_carried_other);
    const std::string why = certain_of(robot.joint(i), given->second, guesses[i], carries_others);
    if (!why.empty())
      out.push_back(fmt::format("joint '{}' is in the group {}, but looks as if it belonged to {}: {}", given->first,
                                to_string(given->second), to_string(guesses[i]), why));
  }
  return out;
}

std::vector<JointGroup> guess_joint_groups(const UrdfRobot& urdf) {
  const Structure robot(urdf);
  std::vector<JointGroup> out(urdf.joints.size(), JointGroup::arm);
  for (const std::size_t joint : head_of(robot)) out[joint] = JointGroup::pan_tilt;
  const auto is_open = [&](std::size_t joint) { return robot.drives(joint) && out[joint] != JointGroup::pan_tilt; };
  for (std::size_t joint = 0; joint < out.size(); ++joint) {
    if (!is_open(joint)) continue;
    std::vector<std::size_t> branches;
    for (std::size_t other = 0; other < out.size(); ++other)
      if (is_open(other) && robot.stands_on(other) == robot.stands_on(joint)) branches.push_back(other);
    const bool lone = branches.size() == 1 && ends_chain(robot, joint);
    if ((ends_chain(robot, joint) && is_followed_jaw(robot, joint)) || (lone && is_lone_jaw(robot, joint)))
      out[joint] = JointGroup::gripper;
    if (!are_fingers(robot, branches)) continue;
    for (std::size_t i = 0; i < out.size(); ++i)
      if (is_open(i) && (i == joint || robot.carries_joint(joint, i))) out[i] = JointGroup::gripper;
  }
  return out;
}

}  // namespace foresight
