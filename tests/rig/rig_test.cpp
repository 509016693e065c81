#include "rig/rig.hpp"

#include "rig/bus_plan.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::rig_test {
namespace {

std::filesystem::path config(const char* name) {
  return source_folder() / "configs" / name;
}

TEST(Rig, TheRigsThatComeWithTheProgramAreValid) {
  for (const char* name : {"minerva.yaml", "cia402.yaml"}) {
    const Rig rig = read_rig(config(name));
    EXPECT_EQ(rig.joints.size(), 10u) << name;
    EXPECT_EQ(rig.buses.size(), 2u);
    ASSERT_TRUE(rig.cameras);
    EXPECT_TRUE(rig.cameras->mock()) << "no hardware needed";
    const auto shape = rig.shape();
    ASSERT_TRUE(shape);
    const GateOptions gate = rig.gate_options();
    shape->surround(gate.surroundings);
    const std::vector<double> home(10, 0);
    EXPECT_EQ(shape->obstructed(home), nullptr) << "stretched upwards";
    std::vector<double> down(10, 0);
    down[1] = 1.9;
    down[3] = 1.2;
    EXPECT_NE(shape->obstructed(down), nullptr) << "into the table";
    EXPECT_TRUE(gate.joints[7].keeps_grip);
    EXPECT_FALSE(gate.joints[0].keeps_grip);
  }
}

TEST(Rig, SaysHowDrivesFollow) {
  const Rig rig = read_rig(config("minerva.yaml"));
  for (const RigJoint& joint : rig.joints) {
    ASSERT_TRUE(joint.response) << joint.drive.name;
    EXPECT_GT(joint.response->dead_time_s + joint.response->lag_s, 0) << joint.drive.name;
    EXPECT_GT(joint.response->sigma_s, 0) << joint.drive.name;
  }
}

TEST(BusPlan, KnowsWhatARigWillSend) {
  Rig rig = read_rig(config("minerva.yaml"));
  // Eight modules, each a set-point and an answer of 8 bytes (111 bits and at most 24 stuffed) 250 times a second.
  EXPECT_NEAR(planned_bus_load(rig, 0), 8 * 250 * 2 * 135 / 1e6, 0.01);
  EXPECT_NO_THROW(require_room_on_buses(rig));
  rig.buses[0].bit_rate = 500'000;
  EXPECT_THAT(
      input_error([&] { require_room_on_buses(rig); }),
      testing::AllOf(testing::HasSubstr("'arm'"), testing::HasSubstr("109 %"), testing::HasSubstr("rate_hz to 156")));
  rig.buses[0].bit_rate = 20'000;
  EXPECT_THAT(input_error([&] { require_room_on_buses(rig); }),
              testing::AllOf(testing::HasSubstr("raise bit_rate"), testing::Not(testing::HasSubstr("rate_hz"))))
      << "no loop is as slow as that";
  const Rig cia402 = read_rig(config("cia402.yaml"));
  EXPECT_LT(planned_bus_load(cia402, 0), kMostBusLoad);
  EXPECT_GT(planned_bus_load(cia402, 0), 0.5);
}

/// A valid rig whose text a test changes.
class BadRig : public testing::Test {
 protected:
  std::string error_with(const std::string& what, const std::string& instead) {
    std::string text = text_;
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), instead);
    const auto file = folder_.write("rig.yaml", text);
    return input_error([&] { read_rig(file); });
  }
  TempFolder folder_;
  std::string text_ = R"(name: small
buses:
  - {name: main, interface: can0, protocol: cia402}
joints:
  - {name: a, group: arm, bus: main, node: 1, unit: rad, encoder: absolute, counts_per_unit: 1000,
     min: -1, max: 1, velocity: 1, acceleration: 2, jerk: 20, following_error: 0.1}
  - {name: b, group: gripper, bus: main, node: 2, unit: m, homing_method: 35, counts_per_unit: 1000,
     min: 0, max: 0.1, velocity: 0.1, acceleration: 2, jerk: 20, following_error: 0.01}
)";
};

TEST_F(BadRig, IsNotBadBeforeItIsChanged) {
  EXPECT_EQ(error_with("name: small", "name: tall"), "no error");
}

TEST_F(BadRig, EveryMistakeHasItsMessage) {
  const auto expect = [&](const char* what, const char* instead, std::initializer_list<const char*> words) {
    const std::string message = error_with(what, instead);
    EXPECT_THAT(message, testing::HasSubstr("rig.yaml")) << instead;
    for (const char* word : words) EXPECT_THAT(message, testing::HasSubstr(word)) << instead;
  };
  expect("velocity: 1,", "velocty: 1,", {"velocty", "velocity"});
  expect("unit: rad, ", "", {"unit", "no unit", "rad"});
  expect("unit: rad", "unit: deg", {"deg", "rad"});
  expect("min: -1, max: 1", "min: 1, max: -1", {"min", "not below max"});
  expect("node: 2", "node: 1", {"node 1", "used twice", "'b'"});
  expect("node: 2", "node: 200", {"200", "1 to 126"});
  expect("name: b", "name: a", {"joints[1].name", "joint 'a' is given twice"});
  expect("protocol: cia402}", "protocol: cia402}\n  - {name: main, interface: can1, protocol: cia402}",
         {"buses[1].name", "bus 'main' is given twice"});
  expect("name: small", "name: sm\xE4ll", {"rig.yaml:1", "not in UTF-8", "iconv"});
  expect("name: small\n", "name: sm\u00E4ll\n---\n", {"rig.yaml:3", "second document", "---"});
  expect("  - {name: main", "\t- {name: main", {"rig.yaml:3", "indented by a tab", "spaces"});
  expect("bus: main, node: 1", "bus: mian, node: 1", {"mian", "main"});
  expect("group: arm", "group: leg", {"leg"});
  expect("protocol: cia402", "protocol: cia403", {"cia403", "cia402"});
  expect("jerk: 20", "jerk: -1", {"jerk", "above 0"});
  expect("following_error: 0.1", "following_error: 0.001", {"following_error", "in one cycle"});
  expect("node: 2", "node: 2, start: 7", {"start", "7 m is beyond", "give "});
  expect("node: 2", "node: 2, response: {lag_s: 0.01}", {"response.sigma_s", "missing"});
  expect("node: 2", "node: 2, response: {lag_s: 12, sigma_s: 0.001}", {"response.lag_s", "12 s", "seconds"});
  expect("node: 2", "node: 2, response: {delay_s: 0.1, sigma_s: 0.001}", {"response.delay_s", "dead_time_s"});
  expect("velocity: 1, acc", "velocity: .nan, acc", {"velocity"});
  expect("encoder: absolute, ", "", {"encoder", "no way to know"});
  expect("encoder: absolute", "homing_method: 35", {"wherever it stands"});
  for (const char* index_pulse : {"homing_method: 33", "homing_method: 34"})
    expect("encoder: absolute", index_pulse, {"joints[0].homing_method", "whichever of the motor's turns", "1 to 14"});
  expect("node: 1,", "node: 1, offset: 90,",
         {"rig.yaml:5: joints[0].offset", "90 rad", "two turns", "-1 to 1 rad", "90 looks like degrees: 1.571 rad"});
  expect("node: 2,", "node: 2, offset: 50,", {"joints[1].offset", "50 m", "10 m", "looks like millimetres: 0.05 m"});
  expect("encoder: absolute", "encoder: relative", {"relative", "absolute"});
  expect("node: 2", "node: 2, serial: 12g", {"12g", "32-bit"});
  expect("node: 2", "node: 2, serial: 0x100000000", {"32-bit"});
  expect("name: small", "name: small\nrobot: {urdf: none.urdf}", {"none.urdf", "no file"});
  expect("name: small", "name: small\nsurroundings: {workspace_m: [-1, -1, 0, 1, 1, 1800]}",
         {"workspace_m", "1800", "1.8 m"});
  expect("name: small", "name: small\nsurroundings: {obstacles: [{name: shelf, box_m: [-460, 0, 0, 1, 1, 1]}]}",
         {"box_m", "460", "0.46 m"});
  expect("name: small", "name: small\ncamera: {}", {"camera", "did you mean 'cameras'"});
  expect("name: small", "name: small\nlink: {domian: 3}", {"rig.yaml:2: link.domian", "did you mean 'domain'"});
  expect("name: small", "name: small\ncameras: {left: {driver: mock}}", {"cameras.right", "missing"});
  expect("name: small", "name: small\ncameras: {left: {driver: mock}, right: {driver: mokc}}",
         {"rig.yaml:2: cameras.right.driver", "mokc", "mock"});
}

// A real drive may keep a home offset of its own; an emulated one looks for home where it says 0.
TEST_F(BadRig, HomeMayLieBeyondTheLimitsOfARealDriveOnly) {
  EXPECT_EQ(error_with("encoder: absolute,", "encoder: absolute, offset: 3,"), "no error");
  EXPECT_EQ(error_with("encoder: absolute,", "homing_method: 20, offset: 3,"), "no error");
  text_.replace(text_.find("can0"), 4, "mock");
  EXPECT_EQ(error_with("encoder: absolute,", "encoder: absolute, offset: 3,"), "no error");
  EXPECT_EQ(error_with("encoder: absolute,", "homing_method: 20, offset: 1,"), "no error");
  EXPECT_THAT(error_with("encoder: absolute,", "homing_method: 20, offset: 3,"),
              testing::AllOf(testing::HasSubstr("rig.yaml:5: joints[0].offset"),
                             testing::HasSubstr("3 rad is beyond the joint's range of -1 to 1 rad")));
}

TEST_F(BadRig, CalibrationNamesItsFiles) {
  const auto error_of = [&](const std::string& section) {
    return error_with("name: small", "name: small\ncalibration: {" + section + "}");
  };
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(error_of("pan_tilt: head.yaml"), AllOf(HasSubstr("calibration.pan_tilt"), HasSubstr("there is no file")));
  folder_.write("head.yaml", "kind: pan-tilt\n");
  EXPECT_THAT(error_of("time: time.yaml"), AllOf(HasSubstr("calibration.pan_tilt"), HasSubstr("missing")));
  EXPECT_THAT(error_of("pan_tilt: head.yaml, tags: tags.txt"),
              AllOf(HasSubstr("calibration.tags"), HasSubstr("there is no file")));
  EXPECT_THAT(error_of("pan_tilt: head.yaml, tag: t"), HasSubstr("did you mean 'tags'"));
  EXPECT_THAT(error_of("pan_tilt: head.yaml"), HasSubstr("0 joints have the group pan_tilt"));
  folder_.write("tags.txt", "");
  EXPECT_EQ(error_of("tags: tags.txt"), "no error") << "tags alone: what the head is to be calibrated with";
}

TEST_F(BadRig, JointsMustBeThoseOfTheUrdf) {
  folder_.write("two.urdf", R"(<robot name='r'><link name='base'/><link name='l1'/><link name='l2'/>
<joint name='a' type='revolute'><parent link='base'/><child link='l1'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>
<joint name='c' type='prismatic'><parent link='l1'/><child link='l2'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>)");
  EXPECT_THAT(error_with("name: small", "name: small\nrobot: {urdf: two.urdf}"),
              testing::HasSubstr("'b' is none that moves"));
  text_.replace(text_.find("name: b"), 7, "name: c");
  EXPECT_EQ(error_with("name: small", "name: small\nrobot: {urdf: two.urdf}"), "no error");
  text_.resize(text_.find("  - {name: c"));
  EXPECT_THAT(error_with("name: small", "name: small\nrobot: {urdf: two.urdf}"),
              testing::HasSubstr("'c' is not in the rig"));
}

// A turning joint a and a sliding one b, whose limits the rig may leave out.
const char* const kLimited = R"(<robot name='r'><link name='base'/><link name='l1'/><link name='l2'/>
<joint name='a' type='revolute'><parent link='base'/><child link='l1'/><axis xyz='0 0 1'/><limit lower='-1.5' upper='1.57' effort='1' velocity='2'/></joint>
<joint name='b' type='prismatic'><parent link='l1'/><child link='l2'/><axis xyz='0 0 1'/><limit lower='0' upper='0.1' effort='1' velocity='0.2'/></joint></robot>)";

class LimitedRig : public BadRig {
 protected:
  LimitedRig() {
    folder_.write("two.urdf", kLimited);
    text_.replace(0, text_.find('\n'), "name: small\nrobot: {urdf: two.urdf}");
  }
  void expect(const char* what, const char* instead, std::initializer_list<const char*> words) {
    const std::string message = error_with(what, instead);
    EXPECT_THAT(message, testing::HasSubstr("rig.yaml:")) << instead;
    for (const char* word : words) EXPECT_THAT(message, testing::HasSubstr(word)) << instead;
  }
  /// What is said of the rig with a URDF that has `instead` in the place of `what`.
  std::string error_of_urdf(const std::string& what, const std::string& instead) {
    std::string urdf = kLimited;
    urdf.replace(urdf.find(what), what.size(), instead);
    folder_.write("two.urdf", urdf);
    return error_with("name: small", "name: tall");
  }
};

TEST_F(LimitedRig, TheUrdfsLimitsAreTheDefaults) {
  text_.replace(text_.find("min: -1, max: 1, velocity: 1,"), 29, "");
  EXPECT_EQ(error_with("name: small", "name: tall"), "no error");
  const Rig rig = read_rig(folder_ / "rig.yaml");
  EXPECT_EQ(rig.joints[0].drive.min_position, -1.5);
  EXPECT_EQ(rig.joints[0].drive.max_position, 1.57);
  EXPECT_EQ(rig.joints[0].drive.max_velocity, 2);
  EXPECT_NEAR(rig.joints[0].drive.homing_velocity, 0.2, 1e-12);
}

TEST_F(LimitedRig, WhatIsRoundedMeansTheUrdfsLimit) {
  EXPECT_EQ(error_with("max: 1, velocity: 1,", "max: 1.570006, velocity: 2.00001,"), "no error");
  const Rig rig = read_rig(folder_ / "rig.yaml");
  EXPECT_EQ(rig.joints[0].drive.max_position, 1.57);
  EXPECT_EQ(rig.joints[0].drive.max_velocity, 2);
}

TEST_F(LimitedRig, WhatIsBeyondTheUrdfIsRefusedWithAGuess) {
  expect("max: 1,", "max: 90,",
         {"joints[0].max", "90 rad is beyond the URDF's 1.57 rad", "90 looks like degrees: 1.571 rad"});
  expect("min: -1,", "min: -85,", {"joints[0].min", "-85 rad", "-1.5 rad", "looks like degrees: -1.484 rad"});
  expect("max: 1,", "max: 1.7,", {"1.7 rad is beyond the URDF's 1.57 rad", "at most that, or correct the URDF"});
  expect("max: 0.1,", "max: 100,", {"joints[1].max", "100 m", "0.1 m", "looks like millimetres: 0.1 m"});
  expect("velocity: 1,", "velocity: 60,", {"velocity", "60 rad/s", "2 rad/s", "60 looks like degrees/s: 1.047 rad/s"});
  expect("velocity: 1,", "velocity: 2.5,", {"2.5 rad/s is beyond the URDF's 2 rad/s"});
  expect("unit: rad", "unit: m", {"unit", "is m, but joint 'a' turns in the URDF", "unit: rad"});
  expect("unit: m", "unit: rad", {"unit", "is rad, but joint 'b' slides in the URDF", "unit: m"});
}

TEST_F(LimitedRig, LimitsOfTheUrdfItselfAreRadiansAndMetres) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(
      error_of_urdf("upper='1.57'", "upper='170'"),
      AllOf(HasSubstr("two.urdf: joint 'a' <limit>: upper is 170"), HasSubstr("radians: 170 degrees are 2.967")));
  EXPECT_THAT(error_of_urdf("upper='0.1'", "upper='300'"),
              AllOf(HasSubstr("two.urdf: joint 'b' <limit>: upper is 300"), HasSubstr("metres: 300 mm are 0.3")));
  EXPECT_EQ(error_of_urdf("lower='-1.5' upper='1.57'", "lower='-1e5' upper='1e5'"), "no error") << "stands for endless";
}

TEST_F(LimitedRig, JointsOfTheUrdfItselfHaveNamesAndArePlacedInMetres) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(error_of_urdf("<child link='l2'/>", "<child link='l2'/><origin xyz='0 0 300'/>"),
              AllOf(HasSubstr("two.urdf: joint 'b' <origin>: is 300 m"), HasSubstr("300 mm are 0.3")));
  EXPECT_THAT(error_of_urdf("joint name='b'", "joint name=''"),
              AllOf(HasSubstr("two.urdf: the <joint> that moves link 'l2' has an empty name"), HasSubstr("name it")));
}

TEST_F(LimitedRig, FollowersKeepWithinTheirLimits) {
  const auto refusal = [&](const std::string& limit, const std::string& mimic) {
    return error_of_urdf(
        "</robot>", "<link name='l3'/><joint name='c' type='prismatic'><parent link='l1'/><child link='l3'/><limit " +
                        limit + " effort='1'/><mimic joint='b' " + mimic + "/></joint></robot>");
  };
  using testing::HasSubstr;
  EXPECT_EQ(refusal("lower='0' upper='0.2' velocity='0.2'", "multiplier='2'"), "no error");
  EXPECT_THAT(refusal("lower='0' upper='0.01' velocity='1'", "multiplier='2'"),
              HasSubstr("joints[1].max: 0.1 m is beyond the URDF's 0.005 m"));
  EXPECT_THAT(refusal("lower='-0.15' upper='0' velocity='1'", "multiplier='-2' offset='-0.01'"),
              HasSubstr("joints[1].max: 0.1 m is beyond the URDF's 0.07 m"));
  EXPECT_THAT(refusal("lower='0' upper='0.2' velocity='0.1'", "multiplier='2'"),
              HasSubstr("joints[1].velocity: 0.1 m/s is beyond the URDF's 0.05 m/s"));
  EXPECT_THAT(refusal("lower='1' upper='2' velocity='1'", ""),
              HasSubstr("joint 'b' <limit>: the limits of the joints"));
  EXPECT_EQ(refusal("lower='0' upper='0' velocity='1'", ""), "no error") << "it was given none";
}

TEST_F(LimitedRig, AbsurdValuesAreRefused) {
  expect("following_error: 0.1", "following_error: 1e6",
         {"following_error", "1e+06 rad is more than 0.5 rad", "hundredths"});
  expect("following_error: 0.1", "following_error: 5", {"5 looks like degrees: 0.08727 rad"});
  expect("following_error: 0.01", "following_error: 10",
         {"10 m is more than 0.05 m", "10 looks like millimetres: 0.01 m"});
  expect("jerk: 20", "jerk: 1e6", {"joints[0].jerk", "less than a quarter of a control cycle", "at most"});
  expect("jerk: 20", "jerk: 1e-9", {"joints[0].jerk", "a jerk of 1e-09", "it has 2 rad", "more jerk"});
  expect("acceleration: 2", "acceleration: 0.1",
         {"joints[0].acceleration", "an acceleration of 0.1", "it has 2 rad", "or less velocity"});
  expect("acceleration: 2", "acceleration: 1e9",
         {"acceleration", "1e+09 rad/s^2", "less than a control cycle of 4 ms"});
  expect("counts_per_unit: 1000,\n     min: -1", "counts_per_unit: 1,\n     min: -1",
         {"joints[0].counts_per_unit", "one count 1 rad", "a tenth of the following error of 0.1 rad", "gear"});
  expect("counts_per_unit: 1000,\n     min: -1", "counts_per_unit: 1e10,\n     min: -1", {"1e+10 counts", "32 bits"});
  expect("name: small", "name: small\ncontrol: {rate_hz: 0}", {"control.rate_hz", "10 to 2000"});
}

// All name file, line and key, what was given, and what may be.
TEST_F(BadRig, OutsideOfTheControlLoopsRangesIsToldWhere) {
  const auto expect = [&](const std::string& instead, std::initializer_list<const char*> words) {
    const std::string message = error_with("name: small", "name: small\n" + instead);
    EXPECT_THAT(message, testing::HasSubstr("rig.yaml:2: ")) << instead;
    for (const char* word : words) EXPECT_THAT(message, testing::HasSubstr(word)) << instead;
  };
  expect("control: {rate_hz: 25}", {"control.rate_hz", "is 25", "bus 'main'", "30 to 2000"});
  expect("control: {rate_hz: 3000}", {"control.rate_hz", "is 3000", "10 to 2000"});
  expect("control: {rate_hz: 50, feedback_age_s: 0.02}",
         {"control.feedback_age_s", "is 0.02 s", "0.02 s; choose more"});
  expect("control: {command_age_s: 5}", {"control.command_age_s", "is 5 s", "at most 2 s"});
  expect("control: {ramp_s: -1}", {"control.ramp_s", "is -1 s", "0 to 60"});
  expect("surroundings: {clearance_m: 3}", {"surroundings.clearance_m", "is 3 m", "less than 1"});
  EXPECT_THAT(error_with("following_error: 0.1}", "following_error: 0.003}"),
              testing::AllOf(testing::HasSubstr("rig.yaml:6: joints[0].following_error"),
                             testing::HasSubstr("0.003 rad is no more than the joint moves in one cycle"),
                             testing::HasSubstr("0.004 rad")));
  text_.replace(text_.find("cia402"), 6, "powercube");
  expect("control: {rate_hz: 25}", {"control.rate_hz", "is 25", "34 to 1000"});
  expect("control: {rate_hz: 1200}", {"control.rate_hz", "is 1200", "34 to 1000"});
}

TEST_F(BadRig, WithoutAUrdfLimitsMustBePlausible) {
  const auto expect = [&](const char* what, const char* instead, std::initializer_list<const char*> words) {
    const std::string message = error_with(what, instead);
    for (const char* word : words) EXPECT_THAT(message, testing::HasSubstr(word)) << instead;
  };
  expect("max: 1,", "max: 90,",
         {"joints[0].max", "90 rad is more than 12.5664 rad", "90 looks like degrees: 1.571 rad"});
  expect("velocity: 1,", "velocity: 100,", {"100 rad/s is more than 30 rad/s", "looks like degrees"});
  expect("max: 0.1,", "max: 100,", {"100 m is more than 10 m", "looks like millimetres: 0.1 m"});
  expect("max: 1,", "", {"max", "missing"});
}

}  // namespace
}  // namespace foresight::rig_test
