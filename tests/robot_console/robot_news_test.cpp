#include "apps/robot/robot_news.hpp"

#include <gmock/gmock.h>

#include "operators/line_operator.hpp"

namespace foresight::robot_news_test {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::system_clock::time_point kNoon{1'795'953'600s + 250ms};  // of 2026-11-29

TEST(RobotNews, TellEveryChangeOnceWithItsInstant) {
  RobotNews news(std::vector<JointWords>{{"yaw", "rad"}});
  news.name(7, "the file");
  RobotStatus status;
  EXPECT_EQ(news.of(status, kNoon), "") << "as every robot begins";
  status.phase = RobotPhase::enabling;
  EXPECT_EQ(news.of(status, kNoon), "2026-11-29T12:00:00.250Z: drives are being enabled");
  status.waiting_for = 0;
  EXPECT_EQ(news.of(status, kNoon), "");
  status.phase = RobotPhase::ready;
  status.waiting_for = -1;
  status.all_homed = true;
  EXPECT_THAT(news.of(status, kNoon), testing::EndsWith("Z: ready; drives hold"));
  status.gate = {.state = GateState::following, .operator_id = 7};
  EXPECT_THAT(news.of(status, kNoon), testing::EndsWith("ready, follows the operator; the file is in charge"));
  status.gate.reason = GateReason::obstructed;
  EXPECT_EQ(news.of(status, kNoon), "") << "it may be so many times a second";
  status.phase = RobotPhase::stopped;
  status.gate = {.state = GateState::stopped, .reason = GateReason::drive_fault, .joint = 0, .detail = "hot"};
  EXPECT_THAT(news.of(status, kNoon), testing::EndsWith("stopped: the drive reports a fault (yaw): hot; drives hold"));
  EXPECT_EQ(news.of(status, kNoon + 10ms), "");
}

TEST(RobotNews, TellWhoStopsTheRobotOverTheLine) {
  RobotNews news(std::vector<JointWords>{{"yaw", "rad"}});
  RobotStatus status;
  status.phase = RobotPhase::stopped;
  status.gate = {.state = GateState::stopped, .reason = GateReason::emergency_stop};
  status.last_request = {RobotRequest::emergency_stop, LineOperator::kId};
  EXPECT_THAT(news.of(status, kNoon, "anna"), testing::EndsWith("hold (asked for over the line by 'anna')"));
  EXPECT_EQ(news.of(status, kNoon, "anna"), "") << "though the request is repeated until it is answered";
  EXPECT_THAT(news.of(status, kNoon, "ben"), testing::EndsWith("by 'ben')")) << "a stop beside hers";
}

}  // namespace
}  // namespace foresight::robot_news_test
