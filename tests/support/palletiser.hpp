// URDFs of palletising arms: three or four drives, and joints that follow them and keep the hand level.
#pragma once

#include <string>

namespace foresight {

enum class Linkage {
  forearm_by_rods,  ///< the elbow's drive sets the forearm's angle to the ground: a level link stands between
  at_the_wrist,     ///< the elbow is the upper arm's; two joints at the wrist turn back what shoulder and elbow turned
  by_lever,         ///< as forearm_by_rods, but the elbow follows a lever beside the upper arm, which has the drive
  in_two_halves,    ///< two joints follow the elbow, with offsets and by other shares than 1: the hand is not level
};

namespace palletiser {

inline std::string body(const std::string& name, const std::string& middle = "", const std::string& size = "") {
  if (size.empty()) return "<link name='" + name + "'/>";
  const std::string shape = "<origin xyz='" + middle + "'/><geometry><box size='" + size + "'/></geometry>";
  return "<link name='" + name + "'><visual>" + shape + "</visual></link>";
}

inline std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                         const std::string& origin, const std::string& limit, const std::string& more = "") {
  return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin " + origin + "/><axis xyz='0 1 0'/><limit " + limit + " effort='1'/>" + more + "</joint>";
}

inline std::string follows(const std::string& leader, double factor, double offset = 0) {
  return "<mimic joint='" + leader + "' multiplier='" + std::to_string(factor) + "' offset='" + std::to_string(offset) +
         "'/>";
}

}  // namespace palletiser

/// Drives: base_yaw, shoulder, elbow (by_lever: rear_lever) and, with `roll`, wrist_roll, whose link `hand` points down
/// along its z; else the tool is the link `wrist`, level.
inline std::string palletiser_urdf(Linkage linkage, bool roll = true) {
  using namespace palletiser;
  const std::string arm = "lower='-0.6' upper='1.2' velocity='1.5'", wide = "lower='-3' upper='3' velocity='0'",
                    slow = "lower='-3' upper='3' velocity='0.9'";
  std::string out = "<robot name='palletiser'>" + body("foot", "0 0 0.1", "0.3 0.3 0.2") +
                    body("turret", "0 0 0.1", "0.2 0.2 0.2") + body("upper", "0 0 0.3", "0.1 0.12 0.5") +
                    body("forearm", "0.33 0 0", "0.4 0.1 0.1") + body("wrist", "0.03 0 -0.02", "0.12 0.08 0.06") +
                    "<joint name='base_yaw' type='revolute'><parent link='foot'/><child link='turret'/>"
                    "<origin xyz='0 0 0.2'/><axis xyz='0 0 1'/>"
                    "<limit lower='-2.9' upper='2.9' velocity='2' effort='1'/></joint>" +
                    joint("shoulder", "turret", "upper", "xyz='0.05 0 0.2'", arm);
  const std::string at_elbow = "xyz='0 0 0.6'", at_wrist = "xyz='0.6 0 0'", none = "xyz='0 0 0'";
  switch (linkage) {
    case Linkage::by_lever:
    case Linkage::forearm_by_rods: {
      const bool lever = linkage == Linkage::by_lever;
      const std::string drive = lever ? "rear_lever" : "elbow";
      if (lever)
        out += body("lever", "0.15 0 0", "0.3 0.03 0.03") +
               joint("rear_lever", "turret", "lever", "xyz='-0.05 0.15 0.2'", arm);
      out += body("level") +
             joint("rods", "upper", "level", at_elbow, "lower='-1.3' upper='1' velocity='0'", follows("shoulder", -1)) +
             joint("elbow", "level", "forearm", none, arm, lever ? follows(drive, 1) : "") +
             joint("wrist_rods", "forearm", "wrist", at_wrist, "lower='-1.3' upper='1.3' velocity='0.8'",
                   follows(drive, -1));
      break;
    }
    case Linkage::at_the_wrist:
      out += body("level") + joint("elbow", "upper", "forearm", at_elbow, arm) +
             joint("rods", "forearm", "level", at_wrist, wide, follows("shoulder", -1)) +
             joint("wrist_rods", "level", "wrist", none, wide, follows("elbow", -1));
      break;
    case Linkage::in_two_halves:
      out += body("half", "0.15 0 0", "0.2 0.08 0.08") + joint("elbow", "upper", "forearm", at_elbow, arm) +
             joint("rods", "forearm", "half", at_wrist, wide, follows("elbow", -0.5, 0.2)) +
             joint("wrist_rods", "half", "wrist", "xyz='0.3 0 0'", slow, follows("elbow", 0.7, -0.3));
      break;
  }
  if (roll)
    out += body("hand", "0 0 0.04", "0.08 0.06 0.06") +
           "<joint name='wrist_roll' type='revolute'><parent link='wrist'/><child link='hand'/>"
           "<origin xyz='0.1 0 -0.05' rpy='3.14159265358979 0 0'/><axis xyz='0 0 1'/>"
           "<limit lower='-3.1' upper='3.1' velocity='3' effort='1'/></joint>";
  return out + "</robot>";
}

}  // namespace foresight
