#include "session/joint_log.hpp"

#include <sys/resource.h>

#include <csignal>

#include "calibration/robot/robot_poses.hpp"
#include "common/text.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::joint_log_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kCycle = 4ms;

class JointLogTest : public testing::Test {
 protected:
  /// Joint j goes at (1 + j) rad/s, and each cycle is told where it was j milliseconds before.
  static double position(std::size_t joint, RobotTime time) {
    return static_cast<double>(1 + joint) * to_seconds(time - RobotTime{});
  }
  RobotCycle cycle(int number, bool homed = true) const {
    RobotCycle out;
    out.time = RobotTime{} + 1s + number * kCycle;
    out.all_homed = homed;
    out.joints = rig_.joints.size();
    for (std::size_t j = 0; j < out.joints; ++j) {
      out.joint[j].homed = homed;
      out.joint[j].time = out.time - Duration(std::chrono::milliseconds(j));
      out.joint[j].position = position(j, out.joint[j].time);
    }
    return out;
  }
  std::vector<FieldRow> rows() const { return read_field_rows(folder_ / "joints.csv"); }

  const TempFolder folder_;
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  BroadcastRing<RobotCycle> ring_{1024};
};

TEST_F(JointLogTest, AFileThatCannotBeWrittenToGoes) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto usual = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit none{0, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &none);
  {
    JointLog log(folder_ / "joints.csv", rig_, ring_.reader());
    EXPECT_NE(log.fault(), "");
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, usual);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "joints.csv"));
}

TEST_F(JointLogTest, HasAllJointsAtTheInstantOfTheRow) {
  {
    JointLog log(folder_ / "joints.csv", rig_, ring_.reader());
    for (int i = 0; i < 5; ++i) ring_.put(cycle(i, false));
    for (int i = 5; i < 105; ++i) ring_.put(cycle(i));
    log.write();
    log.write();
    EXPECT_LE(log.dropped(), 3u) << "the first, before the joints that are behind had told of it";
  }
  const auto all = rows();
  ASSERT_GE(all.size(), 95u);
  EXPECT_EQ(all[0].fields[0], "time_s");
  EXPECT_EQ(all[0].fields[9], "pan");
  for (std::size_t i = 1; i < all.size(); ++i) {
    const RobotTime time = RobotTime{} + *parse_seconds(all[i].fields[0]);
    ASSERT_EQ(all[i].fields.size(), rig_.joints.size() + 1);
    for (std::size_t j = 0; j < rig_.joints.size(); ++j)
      EXPECT_NEAR(*parse_number(all[i].fields[j + 1]), position(j, time), 1e-6)
          << "row " << i << ", joint " << j << ": by the cycle's time it would be "
          << 1e-3 * static_cast<double>(j * (1 + j)) << " off";
  }
}

TEST_F(JointLogTest, AJointThatFallsSilentIsNotGuessed) {
  {
    JointLog log(folder_ / "joints.csv", rig_, ring_.reader());
    for (int i = 0; i < 100; ++i) ring_.put(cycle(i));
    const RobotCycle last = cycle(99);
    for (int i = 100; i < 400; ++i) {
      RobotCycle silent = cycle(i);
      silent.joint[3] = last.joint[3];
      ring_.put(silent);
    }
    log.write();
    EXPECT_GT(log.dropped(), 150u);
  }
  const double last_s = to_seconds(cycle(99).time - RobotTime{});
  const auto all = rows();
  for (std::size_t i = 1; i < all.size(); ++i)
    ASSERT_LT(*parse_number(all[i].fields[0]), last_s + 0.025) << "no further than its speed may be carried on";
}

}  // namespace
}  // namespace foresight::joint_log_test
