#include "apps/robot/session_report.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::session_report_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Cycles of a robot, as its control loop would hand them out.
class SessionTest : public testing::Test {
 protected:
  RobotCycle cycle(double seconds_s) const {
    RobotCycle out;
    out.time = RobotTime{5'000'000'000} + seconds(seconds_s);
    out.phase = RobotPhase::ready;
    out.gate = GateState::following;
    out.joints = rig_.joints.size();
    out.all_homed = true;
    for (std::size_t j = 0; j < out.joints; ++j)
      out.joint[j] = {out.time,
                      std::sin(seconds_s),
                      std::cos(seconds_s),
                      {std::sin(seconds_s), 0, 0},
                      std::sin(seconds_s) + 0.5,
                      DriveState::enabled,
                      true};
    return out;
  }
  /// From `from` to `to`, each changed by `change`.
  void run(double from, double to, const std::function<void(RobotCycle&)>& change = {}) {
    for (double t = from; t < to; t += 0.004) {
      RobotCycle now = cycle(t);
      if (change) change(now);
      ring_.put(now);
      record_.write({{"arm", CanBusState::active, {}, 0.5}, {"head", CanBusState::active, {}, 0.1}});
    }
  }
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  BroadcastRing<RobotCycle> ring_{64};
  SessionRecord record_{rig_, ring_.reader()};
  TempFolder folder_;
};

TEST_F(SessionTest, IsCutIntoWhatTheRobotDid) {
  run(0, 1, [](RobotCycle& c) { c.phase = RobotPhase::disabled, c.gate = GateState::stopped; });
  run(1, 2);
  run(2, 3, [](RobotCycle& c) {
    c.hold = {.joint = 3,
              .stands = 0.5,
              .asked = 1,
              .since = c.time,
              .parts = "link 'arm_5' comes too close to obstacle 'table'",
              .apart = 0.021,
              .kept_apart = 0.02};
    c.reason = c.time.ns % 8'000'000 == 0 ? GateReason::obstructed : GateReason::none;  // it brakes, and tries again
  });
  run(3, 4, [](RobotCycle& c) {
    c.phase = RobotPhase::stopped, c.gate = GateState::stopped;
    c.reason = GateReason::drive_fault, c.reason_joint = 3, c.detail = "overcurrent";
  });
  using Doing = SessionRecord::Doing;
  ASSERT_EQ(record_.stretches().size(), 4u);
  const Doing expected[] = {Doing::nothing, Doing::following, Doing::held, Doing::stopped};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(record_.stretches()[i].doing, expected[i]) << i;
    EXPECT_NEAR(record_.stretches()[i].from_s, static_cast<double>(i), 0.01);
  }
  EXPECT_THAT(record_.stretches()[2].name, HasSubstr("joint elbow stands at 0.5000 rad and should be at 1.0000 rad"));
  EXPECT_EQ(record_.stretches()[3].name, "stopped: the drive reports a fault (elbow): overcurrent; drives hold");
  EXPECT_THAT(record_.stretches()[3].cure, HasSubstr("reset"));
}

TEST_F(SessionTest, StaysSmallAndLosesNoPeak) {
  run(0, 200, [](RobotCycle& c) {
    const double t = to_seconds(c.time - RobotTime{5'000'000'000});
    if (t > 50 && t < 50.01) c.joint[2].position += 0.09;  // two cycles
    if (t > 150 && t < 150.01) c.joint[2].homed = false;
  });
  const auto& columns = record_.columns();
  EXPECT_LE(columns.size(), SessionRecord::kMostColumns);
  EXPECT_GT(columns.size(), SessionRecord::kMostColumns / 4);
  EXPECT_NEAR(columns.back().time_s, 200, 1);
  EXPECT_NEAR(record_.duration_s(), 200, 0.01);
  double most = 0, elsewhere = 0;
  for (std::size_t i = 1; i < columns.size(); ++i) {
    EXPECT_GT(columns[i].time_s, columns[i - 1].time_s);
    EXPECT_NEAR(columns[i].load[0], 0.5, 1e-12);
    double& largest = std::abs(columns[i].time_s - 50) < 1 ? most : elsewhere;
    largest = std::max(largest, std::abs(columns[i].joints[2].error));
  }
  EXPECT_GT(most, 0.08);
  EXPECT_LT(elsewhere, 0.02) << "a cycle's way, no more";
  EXPECT_LT(std::abs(columns[columns.size() / 4].joints[3].error), 0.01);
}

TEST_F(SessionTest, BecomesAPageWithItsSeriesBesideIt) {
  run(0, 1);
  run(1, 2, [](RobotCycle& c) { c.joint[0].homed = false; });
  const auto file = folder_ / "session.html";
  write_session_report(file, rig_, record_, "The motion of the file: done.", {{"CAN log", "a<b.log"}});
  const std::string page = folder_.read("session.html");
  EXPECT_EQ(malformed(page), "");
  for (const char* words : {"Session of minerva", "foresight robot", "The motion of the file: done.", "a&lt;b.log",
                            "wrist_roll", "following error", "Load of the buses"})
    EXPECT_THAT(page, HasSubstr(words));
  const auto data = nlohmann::json::parse(folder_.read("session.html.plots.json"));
  ASSERT_EQ(data["plots"].size(), 2 + 3 * rig_.joints.size());
  const auto& position = data["plots"][2];
  EXPECT_EQ(position["title"], "shoulder_yaw: position and set-point");
  EXPECT_EQ(position["y"]["unit"], "rad");
  EXPECT_EQ(position["series"][0]["kind"], "bars") << "the gate's band";
  EXPECT_EQ(position["series"][1]["name"], "asked for");
  EXPECT_NEAR(position["series"][1]["y"][0].get<double>(), 0.5, 0.1);
  EXPECT_EQ(position["series"][2]["name"], "set-point");
  EXPECT_EQ(position["series"][3]["name"], "position");
  EXPECT_TRUE(position["series"][3]["y"].back().is_null()) << "not homed: it tells no position";
  EXPECT_FALSE(position["series"][3]["y"][0].is_null());
}

}  // namespace
}  // namespace foresight::session_report_test
