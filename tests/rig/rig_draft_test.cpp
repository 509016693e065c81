// The first rig of one's own robot: what is chosen, and that what is written is what works.
#include "rig/rig_draft.hpp"

#include <gmock/gmock.h>

#include "common/error.hpp"
#include "rig/bus_plan.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/six_axis_arm.hpp"

namespace foresight::rig_draft_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// An arm of two joints on a foot, endless wrist and a gripper of two fingers; a fixed tool.
constexpr const char* kArm = R"(<robot name="small arm">
  <link name="foot"><visual><origin xyz="0 0 0.1"/><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
  <link name="lower"><visual><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.04" length="0.3"/></geometry></visual></link>
  <link name="upper"><visual><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.04" length="0.3"/></geometry></visual></link>
  <link name="wrist"/><link name="tool"/><link name="left"/><link name="right"/>
  <joint name="shoulder" type="revolute"><parent link="foot"/><child link="lower"/><origin xyz="0 0 0.25"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="1.5" velocity="10" effort="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="lower"/><child link="upper"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="0.1" upper="2.1" velocity="0.87266463" effort="1"/></joint>
  <joint name="turn: wrist" type="continuous"><parent link="upper"/><child link="wrist"/><origin xyz="0 0 0.4"/><axis xyz="0 0 1"/></joint>
  <joint name="flange" type="fixed"><parent link="wrist"/><child link="tool"/></joint>
  <joint name="grip" type="prismatic"><parent link="tool"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" velocity="0.2" effort="1"/></joint>
  <joint name="grip_2" type="prismatic"><parent link="tool"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" velocity="0.2" effort="1"/><mimic joint="grip"/></joint>
</robot>)";

std::string object(const char* index, int type, const char* value, const char* access = "rw") {
  return std::string("[") + index + "]\nParameterName=x\nObjectType=7\nDataType=" + std::to_string(type) +
         "\nAccessType=" + access + "\nDefaultValue=" + value + "\n";
}

/// An EDS of these objects, each with its section.
std::string sheet_of(const std::vector<std::pair<std::string, std::string>>& objects) {
  std::string list, sections;
  int count = 0;
  for (const auto& [index, section] : objects) {
    list += std::to_string(++count) + "=0x" + index + "\n";
    sections += section;
  }
  return "[OptionalObjects]\nSupportedObjects=" + std::to_string(count) + "\n" + list + sections;
}

std::string array(const std::string& index, int type, const std::vector<std::string>& values) {
  std::string out = "[" + index + "]\nParameterName=x\nObjectType=8\nSubNumber=" + std::to_string(values.size() + 1) +
                    "\n" + object((index + "sub0").c_str(), 5, std::to_string(values.size()).c_str(), "ro");
  for (std::size_t i = 0; i < values.size(); ++i)
    out += object((index + "sub" + std::to_string(i + 1)).c_str(), type, values[i].c_str());
  return out;
}

using Objects = std::vector<std::pair<std::string, std::string>>;
Objects usual_drive() {
  return {{"1000", object("1000", 7, "0x00020192")},
          {"1016", array("1016", 7, {"0"})},
          {"1017", object("1017", 6, "0")},
          {"1018", array("1018", 7, {"0x1234", "0x77", "1", "0"})},
          {"6007", object("6007", 3, "1")},
          {"6098", object("6098", 2, "0")},
          {"608F", array("608F", 7, {"4096", "1"})},
          {"6091", array("6091", 7, {"100", "1"})},
          {"60E3", array("60E3", 3, {"17", "18", "37"})},
          {"6080", object("6080", 7, "300")},
          {"6502", object("6502", 7, "0x1E1")}};
}

class Draft : public testing::Test {
 protected:
  Draft() { options_.urdf = folder_.write("arm.urdf", kArm); }
  Rig written() {
    draft_ = draft_rig(options_);
    text_ = rig_text(draft_, options_, folder_ / "rigs/rig.yaml");
    return read_rig(folder_.write("rigs/rig.yaml", text_));
  }
  std::string error() {
    return input_error([&] { draft_rig(options_); });
  }
  void give_sheet(const Objects& objects) {
    options_.sheet = read_drive_sheet(folder_.write("drive.eds", sheet_of(objects)));
  }
  TempFolder folder_;
  RigDraftOptions options_;
  RigDraft draft_;
  std::string text_;
};

TEST_F(Draft, HasAJointForEachThatMovesOnItsOwn) {
  const Rig rig = written();
  EXPECT_EQ(rig.joint_names(), (std::vector<std::string>{"shoulder", "elbow", "turn: wrist", "grip"}));
  const auto group = [&](std::size_t i) { return rig.joints[i].group; };
  EXPECT_TRUE(group(0) == JointGroup::arm && group(2) == JointGroup::arm && group(3) == JointGroup::gripper);
  EXPECT_EQ(rig.joints[3].unit, "m");
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(rig.joints[i].drive.node, static_cast<int>(i) + 1);
  EXPECT_THAT(text_,
              AllOf(HasSubstr("grip_2 follows grip"), HasSubstr("urdf: ../arm.urdf"), HasSubstr("interface: mock"),
                    HasSubstr("# URDF: 10 rad/s"), HasSubstr("# URDF: continuous; no velocity")));
  EXPECT_EQ(rig.name, "small arm");
}

TEST_F(Draft, TakesLimitsFromTheUrdfAndIsSlowAtFirst) {
  const Rig rig = written();
  const DriveConfig& shoulder = rig.joints[0].drive;
  EXPECT_EQ(shoulder.min_position, -2);
  EXPECT_EQ(shoulder.max_position, 1.5);
  EXPECT_EQ(shoulder.max_velocity, 1) << "a first rig is slow, whatever the URDF says";
  EXPECT_EQ(rig.joints[1].drive.max_velocity, 0.87266463) << "never faster than that, by no digit";
  EXPECT_EQ(rig.joints[2].drive.min_position, -3.1);
  EXPECT_EQ(rig.joints[3].drive.max_velocity, 0.04) << "a second for the whole way";
  for (const RigJoint& joint : rig.joints) {
    const DriveConfig& d = joint.drive;
    EXPECT_LT(d.max_velocity * d.max_velocity / (2 * d.max_acceleration), 0.5 * (d.max_position - d.min_position));
    EXPECT_GT(joint.following_error, 10 * d.max_velocity / rig.rate_hz);
  }
}

TEST_F(Draft, KeepsWithinSoftLimitsAndThoseOfFollowers) {
  std::string urdf = kArm;
  const std::string safety =
      R"(<safety_controller k_velocity="1" soft_lower_limit="-1" soft_upper_limit="3"/></joint>)";
  urdf.replace(urdf.find("</joint>"), 8, safety);
  const std::string mimic = R"(<mimic joint="grip"/>)";
  urdf.replace(urdf.find(mimic), mimic.size(), R"(<mimic joint="grip" multiplier="-2" offset="0.04"/>)");
  folder_.write("arm.urdf", urdf);
  const Rig rig = written();
  EXPECT_EQ(rig.joints[0].drive.min_position, -1);
  EXPECT_EQ(rig.joints[0].drive.max_position, 1.5);
  EXPECT_EQ(rig.joints[3].drive.min_position, 0);
  EXPECT_NEAR(rig.joints[3].drive.max_position, 0.02, 1e-9);
  EXPECT_THAT(text_, HasSubstr("narrower by soft limits"));
}

TEST_F(Draft, NotesWhatCountsAsFixed) {
  std::string urdf = kArm;
  urdf.replace(urdf.find(R"(type="fixed")"), 12, R"(type="floating")");
  folder_.write("arm.urdf", urdf);
  written();
  EXPECT_THAT(text_, HasSubstr("Note: flange is floating or planar: it counts as fixed"));
}

TEST_F(Draft, HomesToASwitchInsideOrAtAnEnd) {
  const Rig rig = written();
  EXPECT_EQ(rig.joints[0].homing_method, 20) << "0 lies inside the range";
  EXPECT_EQ(rig.joints[0].drive.offset, 0);
  EXPECT_EQ(rig.joints[1].homing_method, 20);
  EXPECT_NEAR(rig.joints[1].drive.offset, 1.1, 1e-12) << "0 does not: the middle";
  EXPECT_EQ(rig.joints[3].homing_method, 17) << "a gripper closes";
}

TEST_F(Draft, StandsClearAtHome) {
  Rig rig = written();
  const auto shape = rig.shape();
  shape->surround(rig.surroundings);
  EXPECT_EQ(shape->obstructed(std::vector<double>{0, 1.1, 0, 0.0004}), nullptr);
  EXPECT_FALSE(rig.surroundings.workspace.isEmpty());
  EXPECT_NE(shape->obstructed(std::vector<double>{2, 1.1, 0, 0.0004}), nullptr) << "the floor";
}

TEST_F(Draft, ItsWorkspaceHoldsWhatGuardsALinkThoughNobodySeesIt) {
  std::string urdf = kArm;
  const std::string wrist = R"(<link name="wrist"/>)";
  urdf.replace(
      urdf.find(wrist), wrist.size(),
      R"(<link name="wrist"><collision><origin xyz="0 0 2"/><geometry><box size="0.1 0.1 4"/></geometry></collision></link>)");
  folder_.write("arm.urdf", urdf);
  Rig rig = written();
  const auto shape = rig.shape();
  shape->surround(rig.surroundings);
  EXPECT_EQ(shape->obstructed(std::vector<double>{0, 0.1, 0, 0.0004}), nullptr);
}

// Its root is at the ceiling, or turned over there: below its foot is all that it has.
TEST_F(Draft, LetsARobotThatHangsFromItsRootMove) {
  std::string urdf = kArm;
  urdf.insert(urdf.find("<joint"), R"(<link name="ceiling"/><joint name="mount" type="fixed"><parent link="ceiling"/>
    <child link="foot"/><origin rpy="3.14159265 0 0"/></joint>)");
  folder_.write("arm.urdf", urdf);
  Rig rig = written();
  const auto shape = rig.shape();
  shape->surround(rig.surroundings);
  for (const double shoulder : {-1., 0., 1.})
    EXPECT_EQ(shape->obstructed(std::vector<double>{shoulder, 1.1, 0, 0.0004}), nullptr) << shoulder;
  EXPECT_THAT(text_, HasSubstr("Note: it hangs from its foot"));
}

TEST_F(Draft, GuardsByVisualShapesWhereCollisionMeshesAreMissing) {
  std::string urdf = kArm;
  urdf.insert(urdf.find("</link>"),
              R"(<collision><geometry><mesh filename="meshes/foot.stl"/></geometry></collision>)");
  folder_.write("arm.urdf", urdf);
  const Rig rig = written();
  EXPECT_FALSE(rig.robot->links[0].mesh.vertices.empty());
  EXPECT_TRUE(rig.robot->collision.empty());
  EXPECT_THAT(text_,
              AllOf(HasSubstr("shapes: visual"), HasSubstr("Note: links are guarded by their visual shapes alone"),
                    HasSubstr("'meshes/foot.stl' is missing")));
  EXPECT_THAT(input_error([&] { read_urdf(folder_ / "arm.urdf", MeshSearch{}, UrdfShapes::all); }),
              HasSubstr("'foot' <collision>"));
}

TEST_F(Draft, UsesWhatTheDataSheetTells) {
  give_sheet(usual_drive());
  const Rig rig = written();
  const RigJoint& joint = rig.joints[0];
  EXPECT_NEAR(joint.drive.counts_per_unit, 409600 / (2 * M_PI), 1e-6);
  EXPECT_EQ(joint.drive.vendor, 0x1234u);
  EXPECT_EQ(joint.drive.product, 0x77u);
  EXPECT_NEAR(joint.drive.max_velocity, 300.0 / 60 * 2 * M_PI / 100, 1e-5) << "6080h through the gear";
  EXPECT_EQ(joint.homing_method, 17) << "the first that works from any pose";
  EXPECT_THAT(text_, HasSubstr("608Fh 4096 a turn of the motor x 6091h gear 100"));
  Objects feed = usual_drive();
  feed.push_back({"6092", array("6092", 7, {"36000", "1"})});
  feed[5].second = object("6098", 2, "18");
  give_sheet(feed);
  EXPECT_NEAR(written().joints[0].drive.counts_per_unit, 36000 / (2 * M_PI), 1e-6)
      << "user units per turn of the shaft";
  EXPECT_EQ(written().joints[0].homing_method, 18) << "what the drive is set to";
}

TEST_F(Draft, TakesEncodersForAbsoluteWhereNoMethodSuits) {
  Objects objects = usual_drive();
  objects[8].second = array("60E3", 3, {"33", "35", "37"});
  give_sheet(objects);
  EXPECT_TRUE(written().joints[0].absolute);
  EXPECT_THAT(text_, HasSubstr("no homing method that works from any pose"));
}

TEST_F(Draft, RefusesADriveThatItCouldNotDrive) {
  const auto refusal = [&](std::size_t place, const std::string& section) {
    Objects objects = usual_drive();
    if (section.empty())
      objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(place));
    else
      objects[place].second = section;
    return input_error([&] { give_sheet(objects); });
  };
  EXPECT_THAT(refusal(10, object("6502", 7, "0x43")), says("drive.eds", "6502h is 0x43", "firmware"));
  EXPECT_THAT(refusal(0, object("1000", 7, "0x191")), says("drive.eds", "profile 401", "402"));
  EXPECT_THAT(refusal(1, ""), says("drive.eds", "no consumer heartbeat (1016h)", "choose a drive"));
  EXPECT_THAT(refusal(4, ""), says("drive.eds", "no abort connection option (6007h)", "choose a drive"));
}

TEST_F(Draft, RefusesRobotsOfWhichItCanMakeNone) {
  const auto refusal = [&](const std::string& text, const std::string& instead) {
    std::string urdf = kArm;
    urdf.replace(urdf.find(text), text.size(), instead);
    folder_.write("arm.urdf", urdf);
    return error();
  };
  EXPECT_THAT(refusal(R"(lower="-2" upper="1.5")", R"(lower="0" upper="0")"),
              says("'shoulder'", "cannot move", "<limit"));
  EXPECT_THAT(refusal(R"(lower="-2" upper="1.5")", R"(lower="-170" upper="170")"),
              says("arm.urdf: joint 'shoulder' <limit>", "radians", "-170 degrees are -2.967"));
  EXPECT_THAT(refusal(R"(lower="0" upper="0.04")", R"(lower="0" upper="300")"),
              says("arm.urdf: joint 'grip' <limit>", "metres", "300 mm are 0.3"));
  folder_.write("arm.urdf", "<robot name='r'><link name='a'/></robot>");
  EXPECT_THAT(error(), says("arm.urdf", "none of its joints moves on its own", "<mimic>"));
}

TEST_F(Draft, PutsDrivesOnAsManyBusesAsTheyNeed) {
  const auto arm_of = [&](int joints) {
    std::string urdf = "<robot name='r'><link name='l0'/>";
    for (int i = 1; i <= joints; ++i) {
      const std::string n = std::to_string(i), before = std::to_string(i - 1);
      urdf += "<link name='l" + n + "'/><joint name='j" + n + "' type='revolute'><parent link='l" + before +
              "'/><child link='l" + n +
              "'/><origin xyz='0 0 0.1'/><limit lower='-1' upper='1' velocity='1' effort='1'/></joint>";
    }
    folder_.write("arm.urdf", urdf + "</robot>");
    return written();
  };
  EXPECT_EQ(arm_of(7).buses.size(), 1u) << "seven drives at 250 Hz have room on 1 Mbit/s";
  const Rig eight = arm_of(8);
  ASSERT_EQ(eight.buses.size(), 2u);
  EXPECT_EQ(eight.joints[6].bus, 0u);
  EXPECT_EQ(eight.joints[7].bus, 1u);
  EXPECT_EQ(eight.joints[7].drive.node, 8);
  for (std::size_t bus = 0; bus < 2; ++bus) EXPECT_LE(planned_bus_load(eight, bus), kMostBusLoad);
  options_.protocol = DriveProtocol::powercube;
  EXPECT_EQ(arm_of(8).buses.size(), 1u) << "PowerCube needs less";
}

TEST(RecordedRobotsRigs, AreDraftedAndStandClear) {
  const auto robots = data_folder() / "robots";
  if (!std::filesystem::exists(robots)) GTEST_SKIP() << "no recorded data at " << robots << "; set FORESIGHT_DATA";
  struct Known {
    const char* urdf;
    std::size_t joints, buses;
  };
  TempFolder folder;
  for (const Known& known : {Known{"iiwa7/diff_robot_data/kuka_iiwa/urdf/iiwa7.urdf", 7, 1},
                             Known{"panda/diff_robot_data/panda_description/urdf/panda.urdf", 8, 2}}) {
    RigDraftOptions options;
    options.urdf = robots / known.urdf;
    const RigDraft draft = draft_rig(options);
    const Rig rig = read_rig(folder.write("rig.yaml", rig_text(draft, options, folder / "rig.yaml")));
    EXPECT_EQ(rig.joints.size(), known.joints) << known.urdf;
    EXPECT_EQ(rig.buses.size(), known.buses) << known.urdf;
    std::vector<double> home;
    for (const RigJoint& joint : rig.joints) home.push_back(joint.drive.offset);
    const auto shape = rig.shape();
    shape->surround(rig.surroundings);
    const char* const touching = shape->obstructed(home);
    EXPECT_EQ(touching, nullptr) << known.urdf << ": " << touching;
  }
}

TEST_F(Draft, KeepsLinksApartAsTheArmIsLarge) {
  for (const auto& [size, clearance] : {std::pair{0.1, 0.003}, {0.2, 0.004}, {0.5, 0.011}, {0.9, 0.02}, {3.0, 0.02}}) {
    folder_.write("arm.urdf", six_axis_urdf(size, {.length = 0.06 * size}));
    EXPECT_EQ(written().surroundings.clearance, clearance) << size;
    if (size > 0.1) EXPECT_THAT(draft_.warnings, testing::IsEmpty()) << size;
  }
}

TEST_F(Draft, WarnsOfWhatIsTooCloseAtHomeAndTellsTheCure) {
  folder_.write("arm.urdf", six_axis_urdf(0.2, {.length = 0.06, .thickness = 0.03}));
  written();
  ASSERT_EQ(draft_.warnings.size(), 1u);
  EXPECT_THAT(draft_.warnings[0], AllOf(HasSubstr("at home link 'jaw_"), HasSubstr("too close to link 'wr'"),
                                        HasSubstr("0.003 m apart of 0.004 m"), HasSubstr("A clearance_m of 0.002")));
  EXPECT_THAT(text_, HasSubstr("# Warning: at home"));
  folder_.write("arm.urdf", six_axis_urdf(0.1, {.length = 0.06, .thickness = 0.03}));
  written();
  ASSERT_EQ(draft_.warnings.size(), 1u);
  EXPECT_THAT(draft_.warnings[0], AllOf(HasSubstr("0.000 m apart"), HasSubstr("slimmer <collision> shapes")));
}

}  // namespace
}  // namespace foresight::rig_draft_test
