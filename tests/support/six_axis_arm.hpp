// URDFs of arms of six turning joints, of any size, with grippers of any kind.
#pragma once

#include <fmt/core.h>

#include <string>

namespace foresight {

/// A gripper of two boxes, 0.02 m wide, whose inner faces are `gap` apart where the joints `grip` and `grip2` are at 0.
struct BoxJaws {
  enum class Moves { mimic, two_drives, one };
  Moves moves = Moves::mimic;
  double most = 0.035, gap = 0;            ///< m: of each joint; at 0
  double length = 0.06, thickness = 0.01;  ///< m
  std::string mount_rpy = "0 0 0";         ///< of the link "palm", in which they slide along y and point along z
  std::string type = "prismatic";
};

/// Links base, turret, upper, fore, wr, wp, hand; joints j1 .. j6, all at 0 stretched upwards. The jaws stand on
/// `palm`, which is fixed to `hand`, the last joint's link, 0.03 * size above its origin.
inline std::string six_axis_urdf(double size, const BoxJaws& jaws = {}) {
  const auto body = [](const std::string& name, const std::string& middle, const std::string& geometry) {
    const std::string shape = "<origin xyz='" + middle + "'/><geometry>" + geometry + "</geometry>";
    return "<link name='" + name + "'><visual>" + shape + "</visual><collision>" + shape + "</collision></link>\n";
  };
  const auto rod = [&](const std::string& name, double height, double radius) {
    return body(name, fmt::format("0 0 {}", size * height / 2),
                fmt::format("<cylinder radius='{}' length='{}'/>", size * radius, size * height));
  };
  const auto turns = [&](int number, const char* parent, const char* child, double z, const char* axis, double most) {
    return fmt::format(
        "<joint name='j{}' type='revolute'><parent link='{}'/><child link='{}'/><origin xyz='0 0 {}'/><axis xyz='{}'/>"
        "<limit lower='{}' upper='{}' velocity='2' effort='50'/></joint>\n",
        number, parent, child, size * z, axis, -most, most);
  };
  const auto jaw = [&](const char* name, int side) {
    return body(name, fmt::format("0 {} {}", side * (jaws.gap + jaws.thickness) / 2, jaws.length / 2),
                fmt::format("<box size='0.02 {} {}'/>", jaws.thickness, jaws.length));
  };
  const auto slides = [&](const char* name, const char* child, const char* way, const std::string& more) {
    return fmt::format(
        "<joint name='{}' type='{}'><parent link='palm'/><child link='{}'/><axis xyz='{}'/>"
        "<limit lower='0' upper='{}' velocity='0.1' effort='20'/>{}</joint>\n",
        name, jaws.type, child, way, jaws.most, more);
  };
  std::string out = "<robot name='six'>\n" + rod("base", 0.1, 0.07) + rod("turret", 0.1, 0.06) +
                    turns(1, "base", "turret", 0.1, "0 0 1", 3) + rod("upper", 0.4, 0.05) +
                    turns(2, "turret", "upper", 0.1, "0 1 0", 2) + rod("fore", 0.35, 0.04) +
                    turns(3, "upper", "fore", 0.4, "0 1 0", 2.6) + rod("wr", 0.1, 0.03) +
                    turns(4, "fore", "wr", 0.35, "0 0 1", 3) + rod("wp", 0.08, 0.03) +
                    turns(5, "wr", "wp", 0.1, "0 1 0", 2) + rod("hand", 0.03, 0.035) +
                    turns(6, "wp", "hand", 0.08, "0 0 1", 3.1);
  out += fmt::format(
      "<link name='palm'/><joint name='mount' type='fixed'><parent link='hand'/><child link='palm'/>"
      "<origin xyz='0 0 {}' rpy='{}'/></joint>\n",
      0.03 * size, jaws.mount_rpy);
  out += jaw("jaw_left", 1) + jaw("jaw_right", -1) + slides("grip", "jaw_left", "0 1 0", "");
  switch (jaws.moves) {
    case BoxJaws::Moves::mimic: out += slides("grip2", "jaw_right", "0 -1 0", "<mimic joint='grip'/>"); break;
    case BoxJaws::Moves::two_drives: out += slides("grip2", "jaw_right", "0 -1 0", ""); break;
    case BoxJaws::Moves::one:
      out += "<joint name='anvil' type='fixed'><parent link='palm'/><child link='jaw_right'/></joint>\n";
      break;
  }
  return out + "</robot>\n";
}

}  // namespace foresight
