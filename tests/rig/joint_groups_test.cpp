// Whose joint it is, of robots of several kinds. Names tell nothing where the structure does: most are j1, j2, ...
#include "rig/joint_groups.hpp"

#include <gmock/gmock.h>

#include "tests/support/folders.hpp"

namespace foresight::joint_groups_test {
namespace {

/// A URDF in the making; each joint hangs a link on another, whose name is the joint's and "_l" ("base" for the root).
class Built {
 public:
  Built& turns(const std::string& name, const std::string& on, const std::string& axis, double upper = 2.8) {
    return joint("revolute", name, on, axis, -upper, upper);
  }
  Built& slides(const std::string& name, const std::string& on, const std::string& axis, double stroke) {
    return joint("prismatic", name, on, axis, 0, stroke);
  }
  Built& rolls(const std::string& name, const std::string& on) { return joint("continuous", name, on, "0 1 0", 0, 0); }
  Built& follows(const std::string& name, const std::string& on, const std::string& leader, double factor = 1) {
    const std::string mimic = "<mimic joint='" + leader + "' multiplier='" + std::to_string(factor) + "'/>";
    const bool slides = text_.find("type='prismatic' name='" + leader + "'") != std::string::npos;
    return joint(slides ? "prismatic" : "revolute", name, on, "0 1 0", -1, 1, mimic);
  }
  Built& fixed(const std::string& name, const std::string& on) { return joint("fixed", name, on, "", 0, 0); }
  /// An empty link.
  Built& frame(const std::string& name, const std::string& on) {
    text_ += "<link name='" + name + "'/><joint type='fixed' name='to_" + name + "'><parent link='" + link(on) +
             "'/><child link='" + name + "'/></joint>";
    return *this;
  }
  /// Joints j1 .. j`count` that turn, about z and y in turn.
  Built& arm(int count, const std::string& prefix = "j", const std::string& on = "base") {
    for (int i = 1; i <= count; ++i)
      turns(prefix + std::to_string(i), i == 1 ? on : prefix + std::to_string(i - 1), i % 2 != 0 ? "0 0 1" : "0 1 0");
    return *this;
  }
  UrdfRobot robot() const {
    const TempFolder folder;
    return read_urdf(folder.write("robot.urdf", text_ + "</robot>"));
  }
  /// "j1 a, finger g": joints with drives, in their order here, and the first letters of their groups.
  std::string groups() const {
    const UrdfRobot robot = this->robot();
    const std::vector<JointGroup> groups = guess_joint_groups(robot);
    std::map<std::size_t, std::string> found;  // by the place in the text
    for (std::size_t i = 0; i < groups.size(); ++i)
      if (robot.joints[i].kind != UrdfJoint::Kind::fixed && !robot.joints[i].mimic)
        found[text_.find("name='" + robot.joints[i].name + "'")] = robot.joints[i].name + " " + to_string(groups[i])[0];
    std::string out;
    for (const auto& [at, words] : found) out += (out.empty() ? "" : ", ") + words;
    return out;
  }

 private:
  static std::string link(const std::string& joint) { return joint == "base" ? joint : joint + "_l"; }
  static std::string body(const std::string& name) {
    return "<link name='" + name + "'><visual><geometry><box size='.05 .05 .1'/></geometry></visual></link>";
  }
  Built& joint(const std::string& type, const std::string& name, const std::string& on, const std::string& axis,
               double lower, double upper, const std::string& more = "") {
    text_ += body(link(name)) + "<joint type='" + type + "' name='" + name + "'><parent link='" + link(on) +
             "'/><child link='" + link(name) + "'/><origin xyz='0 0 .1'/>";
    if (!axis.empty()) text_ += "<axis xyz='" + axis + "'/>";
    if (upper > lower)
      text_ += "<limit lower='" + std::to_string(lower) + "' upper='" + std::to_string(upper) +
               "' velocity='1' effort='1'/>";
    text_ += more + "</joint>";
    return *this;
  }

  std::string text_ = "<robot name='r'>" + body("base");
};

TEST(JointGroups, JawsThatTurnAreAGripper) {
  // Robotiq's: one knuckle has the drive, five links follow it, on its own side and on the other.
  EXPECT_EQ(Built()
                .arm(6)
                .frame("tool0", "j6")
                .fixed("coupling", "j6")
                .turns("knuckle", "coupling", "0 1 0", 0.8)
                .follows("left_finger", "knuckle", "knuckle", -1)
                .follows("left_inner", "coupling", "knuckle")
                .follows("right_knuckle", "coupling", "knuckle", -1)
                .follows("right_finger", "right_knuckle", "knuckle")
                .groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, j6 a, knuckle g");
  EXPECT_EQ(Built().arm(4).turns("j5", "j4", "0 1 0", 0.6).turns("j6", "j4", "0 1 0", 0.6).groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 g, j6 g")
      << "a drive on each side";
  EXPECT_EQ(Built().arm(5).frame("tcp", "j5").turns("j6", "j5", "0 1 0", 1).groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, j6 g")
      << "one jaw against a fixed one: the tool's frame is before it";
  EXPECT_EQ(Built().arm(5).turns("jaw", "j5", "0 1 0", 1).groups(), "j1 a, j2 a, j3 a, j4 a, j5 a, jaw g")
      << "nothing but its name tells";
  EXPECT_EQ(Built().arm(5).turns("j6", "j5", "0 1 0", 0.7).follows("j7", "j6", "j6").groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, j6 g")
      << "a finger of two links against a fixed one";
}

TEST(JointGroups, FingersOfSeveralDrivesAreAGripper) {
  Built hand;
  hand.arm(6);
  for (const std::string finger : {"a", "b", "c"})
    hand.turns(finger + "1", "j6", "0 1 0", 1).turns(finger + "2", finger + "1", "0 1 0", 1);
  EXPECT_EQ(hand.groups(), "j1 a, j2 a, j3 a, j4 a, j5 a, j6 a, a1 g, a2 g, b1 g, b2 g, c1 g, c2 g");
  EXPECT_EQ(Built().slides("j1", "base", "0 1 0", 0.2).slides("j2", "base", "0 1 0", 0.2).groups(), "j1 g, j2 g")
      << "a gripper alone, however wide";
}

TEST(JointGroups, TheLastJointOfAnArmIsTheArms) {
  EXPECT_EQ(Built().arm(6).groups(), "j1 a, j2 a, j3 a, j4 a, j5 a, j6 a");
  EXPECT_EQ(Built().arm(5).turns("j6", "j5", "0 1 0", 1.2).frame("tool0", "j6").groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, j6 a")
      << "the tool is behind it, however little it turns";
  EXPECT_EQ(Built().arm(5).turns("j6", "j5", "0 1 0", 1.2).frame("tcp_camera", "j5").groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, j6 a")
      << "a camera on the forearm is no tool";
  EXPECT_EQ(Built().arm(5).turns("gripper_roll", "j5", "0 0 1", 1.2).groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, gripper_roll a");
}

TEST(JointGroups, ALastShortSlideOfAnArmIsTheArms) {
  const Built gantry = Built().slides("j1", "base", "1 0 0", 0.6).slides("j2", "j1", "0 1 0", 0.4);
  EXPECT_EQ(Built(gantry).slides("j3", "j2", "0 0 -1", 0.1).groups(), "j1 a, j2 a, j3 a");
  EXPECT_EQ(Built(gantry).slides("j3", "j2", "0 0 -1", 0.1).slides("j4", "j3", "0 1 0", 0.03).groups(),
            "j1 a, j2 a, j3 a, j4 g")
      << "a gantry's one jaw goes nowhere new";
  const Built scara = Built().turns("j1", "base", "0 0 1").turns("j2", "j1", "0 0 1");
  EXPECT_EQ(Built(scara).slides("j3", "j2", "0 0 1", 0.12).groups(), "j1 a, j2 a, j3 a");
  EXPECT_EQ(Built(scara).turns("j3", "j2", "0 0 1").slides("j4", "j3", "0 0 -1", 0.12).groups(),
            "j1 a, j2 a, j3 a, j4 a");
  EXPECT_EQ(Built(scara).slides("j3", "j2", "0 0 1", 0.12).turns("j4", "j3", "0 0 1").groups(),
            "j1 a, j2 a, j3 a, j4 a");
  EXPECT_EQ(Built(scara).slides("j3", "j2", "0 0 1", 0.12).slides("j4", "j3", "0 1 0", 0.02).groups(),
            "j1 a, j2 a, j3 a, j4 g")
      << "a SCARA's jaw";
  EXPECT_EQ(Built().arm(4).slides("j5", "j4", "1 0 0", 0.1).frame("flange", "j5").groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a")
      << "the tool is behind it";
  EXPECT_EQ(Built().arm(4).slides("j5", "j4", "1 0 0", 0.4).groups(), "j1 a, j2 a, j3 a, j4 a, j5 a") << "far";
}

TEST(JointGroups, JawsThatSlideAreAGripper) {
  EXPECT_EQ(Built().arm(6).slides("j7", "j6", "0 1 0", 0.04).groups(), "j1 a, j2 a, j3 a, j4 a, j5 a, j6 a, j7 g");
  EXPECT_EQ(Built().arm(3).slides("j4", "j3", "0 1 0", 0.04).follows("other", "j3", "j4").groups(),
            "j1 a, j2 a, j3 a, j4 g");
  EXPECT_EQ(Built().arm(3).slides("j4", "j3", "0 1 0", 0.2).slides("j5", "j3", "0 1 0", 0.2).groups(),
            "j1 a, j2 a, j3 a, j4 g, j5 g");
}

TEST(JointGroups, AHeadIsABranchOfItsOwn) {
  EXPECT_EQ(Built().arm(5).turns("pan", "base", "0 0 1").turns("tilt", "pan", "0 1 0").groups(),
            "j1 a, j2 a, j3 a, j4 a, j5 a, pan p, tilt p");
  EXPECT_EQ(Built()
                .slides("torso", "base", "0 0 1", 0.4)
                .arm(5, "j", "torso")
                .turns("pan", "torso", "0 0 1")
                .turns("tilt", "pan", "0 1 0")
                .groups(),
            "torso a, j1 a, j2 a, j3 a, j4 a, j5 a, pan p, tilt p");
  EXPECT_EQ(
      Built().turns("head_pan_joint", "base", "0 0 1").turns("head_tilt_joint", "head_pan_joint", "0 1 0").groups(),
      "head_pan_joint p, head_tilt_joint p");
  EXPECT_EQ(Built()
                .turns("shoulder_pan", "base", "0 0 1")
                .arm(3, "j", "shoulder_pan")
                .turns("pan", "base", "0 0 1")
                .turns("tilt", "pan", "0 1 0")
                .groups(),
            "shoulder_pan a, j1 a, j2 a, j3 a, pan p, tilt p")
      << "a shoulder that pans does not hide the head";
}

TEST(JointGroups, AnArmThatPansAndTiltsIsNoHead) {
  EXPECT_EQ(Built()
                .turns("shoulder_pan", "base", "0 0 1")
                .turns("elbow", "shoulder_pan", "0 1 0")
                .turns("wrist_tilt", "elbow", "0 1 0")
                .groups(),
            "shoulder_pan a, elbow a, wrist_tilt a");
  EXPECT_EQ(Built().turns("shoulder_pan", "base", "0 0 1").turns("wrist_tilt", "shoulder_pan", "0 1 0").groups(),
            "shoulder_pan a, wrist_tilt a");
  EXPECT_EQ(Built().arm(3).turns("pan", "j3", "0 0 1").turns("tilt", "pan", "0 1 0").groups(),
            "j1 a, j2 a, j3 a, pan a, tilt a")
      << "the end of the only chain";
  EXPECT_EQ(Built()
                .turns("pan", "base", "0 0 1")
                .turns("tilt", "pan", "0 1 0")
                .slides("j1", "tilt", "0 1 0", 0.03)
                .follows("j2", "tilt", "j1")
                .groups(),
            "pan a, tilt a, j1 g")
      << "it grips";
  EXPECT_EQ(Built().arm(3).turns("pan", "j3", "0 0 1").turns("tilt", "pan", "0 1 0").arm(4, "k").groups(),
            "j1 a, j2 a, j3 a, pan a, tilt a, k1 a, k2 a, k3 a, k4 a")
      << "one of two arms";
}

TEST(JointGroups, WheelsAndArmsOfATorsoAreNoFingers) {
  EXPECT_EQ(Built().rolls("left", "base").rolls("right", "base").arm(3).groups(), "left a, right a, j1 a, j2 a, j3 a");
  EXPECT_EQ(Built().turns("torso", "base", "0 0 1").arm(3, "l", "torso").arm(3, "r", "torso").groups(),
            "torso a, l1 a, l2 a, l3 a, r1 a, r2 a, r3 a");
}

TEST(JointGroups, WhatKeepsAHandLevelIsTheArms) {
  const Built upper = Built().turns("j1", "base", "0 0 1").turns("j2", "j1", "0 1 0").follows("rods", "j2", "j2", -1);
  EXPECT_EQ(Built(upper).turns("j3", "rods", "0 1 0").follows("level", "j3", "j3", -1).groups(), "j1 a, j2 a, j3 a");
  EXPECT_EQ(Built(upper).turns("finger", "rods", "0 1 0").follows("level", "finger", "finger", -1).groups(),
            "j1 a, j2 a, finger g")
      << "fingers have links that stay level, too";
  Built lever =
      Built(upper).turns("lever", "j1", "0 1 0").follows("j3", "rods", "lever").follows("level", "j3", "lever", -1);
  EXPECT_EQ(lever.groups(), "j1 a, j2 a, lever a") << "it ends its chain, but moves the other one";
  EXPECT_EQ(Built(lever).turns("roll", "level", "0 0 1").groups(), "j1 a, j2 a, lever a, roll a");
  EXPECT_EQ(Built(lever)
                .slides("jaw", "level", "0 1 0", 0.04)
                .follows("other", "level", "jaw")
                .turns("cap", "j1", "0 0 1")
                .groups(),
            "j1 a, j2 a, lever a, jaw g, cap a");
}

class WordsOnGroups : public testing::Test {
 protected:
  std::vector<std::string> words(const std::string& joint, JointGroup group) {
    Rig rig = read_rig(source_folder() / "configs/minerva.yaml");
    std::ranges::find(rig.joints, joint, [](const RigJoint& j) { return j.drive.name; })->group = group;
    return words_on_groups(rig);
  }
};

TEST_F(WordsOnGroups, RigsAsTheyShouldBeRaiseNone) {
  for (const char* rig : {"minerva.yaml", "cia402.yaml"})
    EXPECT_THAT(words_on_groups(read_rig(source_folder() / "configs" / rig)), testing::IsEmpty()) << rig;
  Rig no_robot = read_rig(source_folder() / "configs/minerva.yaml");
  no_robot.robot.reset();
  EXPECT_THAT(words_on_groups(no_robot), testing::IsEmpty());
}

TEST_F(WordsOnGroups, AHeadAmongTheArmsJointsIsNamed) {
  Rig rig;
  rig.robot = Built().arm(4).turns("pan", "base", "0 0 1").turns("tilt", "pan", "0 1 0").robot();
  for (const UrdfJoint& joint : rig.robot->joints) rig.joints.emplace_back().drive.name = joint.name;
  EXPECT_THAT(words_on_groups(rig), testing::UnorderedElementsAre(testing::HasSubstr("'pan' is in the group arm"),
                                                                  testing::HasSubstr("'tilt' is in the group arm")));
}

TEST_F(WordsOnGroups, JointsInWrongGroupsAreNamedAndWhy) {
  const auto says = [](const char* joint, const char* group, const char* why) {
    return testing::ElementsAre(testing::AllOf(testing::HasSubstr(std::string("joint '") + joint + "'"),
                                               testing::HasSubstr(std::string("belonged to ") + group),
                                               testing::HasSubstr(why)));
  };
  EXPECT_THAT(words("wrist_roll", JointGroup::gripper), says("wrist_roll", "arm", "farther than jaws"));
  EXPECT_THAT(words("wrist_pitch", JointGroup::gripper), says("wrist_pitch", "arm", "move with it"));
  EXPECT_THAT(words("elbow", JointGroup::pan_tilt), says("elbow", "arm", "move with it"));
  EXPECT_THAT(words("finger", JointGroup::arm), says("finger", "gripper", "named and placed"));
}

}  // namespace
}  // namespace foresight::joint_groups_test
