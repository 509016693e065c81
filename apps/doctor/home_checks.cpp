#include "apps/doctor/findings.hpp"
#include "rig/home_check.hpp"
#include "rig/joint_groups.hpp"

namespace foresight::doctor {

Findings check_home(const Rig& rig) {
  if (!rig.robot) return {};
  Findings out;
  for (const TooClose& parts : parts_too_close_at_home(rig))
    out.push_back({parts.touch ? Verdict::bad : Verdict::poor, "robot at home", parts.what, parts.cure});
  if (out.empty()) out.push_back({Verdict::good, "robot at home", "stands clear of its surroundings", ""});
  return out;
}

Findings check_groups(const Rig& rig) {
  Findings out;
  for (const std::string& words : words_on_groups(rig))
    out.push_back({Verdict::poor, "joint groups", words, "correct its `group` in the rig file"});
  return out;
}

}  // namespace foresight::doctor
