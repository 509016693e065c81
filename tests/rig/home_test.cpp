// Where joints stand at home: as the drives have it.
#include "rig/home.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rig/robot_devices.hpp"
#include "tests/support/folders.hpp"

namespace foresight::home_test {
namespace {

RigJoint joint(double low, double high, double offset, bool absolute) {
  RigJoint out;
  out.absolute = absolute;
  out.drive.min_position = low;
  out.drive.max_position = high;
  out.drive.offset = offset;
  return out;
}

TEST(Home, IsWhereAnIncrementalCia402DriveSaysZero) {
  EXPECT_EQ(home_of(joint(-1, 1, 0.4, false), DriveProtocol::cia402), 0.4);
  EXPECT_EQ(home_of(joint(-1, 1, 1.4, false), DriveProtocol::cia402), 1) << "real ones keep an offset of their own";
}

TEST(Home, OfOthersIsTheJointsZeroWhateverTheirOffset) {
  for (const auto protocol : {DriveProtocol::cia402, DriveProtocol::powercube}) {
    const bool absolute = protocol == DriveProtocol::cia402;
    EXPECT_EQ(home_of(joint(-1, 1, 0.4, absolute), protocol), 0);
    EXPECT_EQ(home_of(joint(1, 2, 0.4, absolute), protocol), 1.5);
  }
}

TEST(Home, IsWhereDrivesWithAbsoluteEncodersStandAtFirst) {
  Rig rig = read_rig(source_folder() / "configs/cia402.yaml");
  rig.joints[1].drive.offset = 0.3;
  SteppedClock clock;
  RobotDeviceOptions options;
  options.mock = true;
  RobotDevices devices(rig, clock, options);
  const JointValues home = home_of(rig);
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    EXPECT_NEAR(devices.shaft_at(rig.joints[i].drive.name, clock.now()).value_or(NAN), home[i], 1e-6)
        << rig.joints[i].drive.name;
}

}  // namespace
}  // namespace foresight::home_test
