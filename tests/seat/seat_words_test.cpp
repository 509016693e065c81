// What an operator reads at his seat.
#include "seat/seat_words.hpp"

namespace foresight::seat_words_test {
namespace {

using Phase = ControlSeatStatus::Phase;

SeatStatus driving() {
  SeatStatus out;
  out.control.phase = Phase::holding;
  out.control.follows = true;
  out.held = out.engaged = true;
  out.robot.emplace();
  out.robot->doing.name = "follows";
  out.robot->bus_healthy = true;
  out.robot_age = Duration{0};
  out.line.clock = OffsetInterval{0, 0};
  out.shown.status = StateStatus::predicted;
  return out;
}

const SeatLine* find(const std::vector<SeatLine>& lines, const std::string& label) {
  for (const SeatLine& line : lines)
    if (line.label == label) return &line;
  return nullptr;
}

TEST(SeatWords, WhereAllIsWellNothingIsUrgent) {
  for (const SeatLine& line : seat_lines(driving(), {}, "")) EXPECT_NE(line.urgency, Urgency::trouble) << line.label;
  EXPECT_EQ(next_step(driving()).words, "driving");
}

TEST(SeatWords, ASwitchThatDoesNotCountSaysWhatToDo) {
  SeatStatus status = driving();
  status.engaged = false;
  EXPECT_EQ(next_step(status).urgency, Urgency::trouble);
  EXPECT_NE(next_step(status).cure.find("press again"), std::string::npos);
  const auto lines = seat_lines(status, {}, "");
  ASSERT_TRUE(find(lines, "in command"));
  EXPECT_EQ(find(lines, "in command")->urgency, Urgency::trouble);
}

// Held since before the robot was ready: what to do first is said of the robot, then of the switch.
TEST(SeatWords, ASwitchThatWasPressedTooEarlySaysWhatToDo) {
  SeatStatus status = driving();
  status.held = status.engaged = status.control.follows = false;
  status.refused = true;
  status.robot->doing.name = "disabled";
  status.robot->doing.cure = "enable the drives (e)";
  EXPECT_EQ(next_step(status).words, "disabled");
  status.robot_control.ready = true;
  EXPECT_EQ(next_step(status).cure, "let go, and press again");
  status.refused = false;
  EXPECT_EQ(next_step(status).words, "ready");
}

TEST(SeatWords, TroubleIsToldWithoutColour) {
  SeatStatus status = driving();
  status.robot_age = std::chrono::seconds(5);
  status.shown.status = StateStatus::invalid;
  status.shown.reason = FutureReason::stale;
  const auto lines = seat_lines(status, {}, "NO IMAGE for 3.0 s");
  for (const char* label : {"robot", "images", "prediction"}) {
    ASSERT_TRUE(find(lines, label)) << label;
    EXPECT_EQ(find(lines, label)->urgency, Urgency::trouble) << label;
  }
  EXPECT_STRNE(mark(Urgency::trouble), mark(Urgency::fine));
  EXPECT_STRNE(mark(Urgency::note), mark(Urgency::fine));
}

// As when its program was killed: all that is known of it is old, and none of it may look as if it were not.
TEST(SeatWords, WhatIsOldOfTheRobotIsToldAsOld) {
  SeatStatus fine = driving();
  fine.robot_control.ready = true;
  fine.held = fine.engaged = false;
  fine.control.state_age = Duration{0};
  EXPECT_EQ(next_step(fine).words, "ready");
  SeatStatus without_control = fine, without_words = fine;
  without_control.control.state_age = std::chrono::milliseconds(600);
  without_words.robot_age = std::chrono::milliseconds(1600);
  for (const SeatStatus& status : {without_control, without_words}) {
    EXPECT_EQ(next_step(status).urgency, Urgency::trouble);
    EXPECT_EQ(next_step(status).words, "nothing is heard of the robot");
    const auto lines = seat_lines(status, {}, "");
    for (const char* label : {"robot", "line", "drives"}) {
      ASSERT_TRUE(find(lines, label)) << label;
      EXPECT_NE(find(lines, label)->urgency, Urgency::fine) << label;
      EXPECT_NE(find(lines, label)->words.find(" s"), std::string::npos) << find(lines, label)->words;
    }
  }
  // The line may be so thin that words of the robot come once a second.
  fine.control.state_age = std::chrono::milliseconds(400);
  fine.robot_age = std::chrono::milliseconds(1200);
  EXPECT_EQ(next_step(fine).words, "ready");
  EXPECT_EQ(find(seat_lines(fine, {}, ""), "drives")->urgency, Urgency::fine);
}

TEST(SeatWords, ADelayIsToldOnceItIsKnown) {
  SeatStatus status = driving();
  const auto words = [&] { return find(seat_lines(status, {}, ""), "line")->words; };
  EXPECT_NE(words().find("not known yet"), std::string::npos) << words();
  status.delay = {0.25, 0.002, true};
  EXPECT_NE(words().find("after 250 ± 4 ms"), std::string::npos) << words();
}

TEST(SeatWords, ErrorsOfJointsAreNumbersForPeople) {
  SeatStatus status = driving();
  for (const auto& [error, words] :
       {std::pair{1.9e-14, "within 0.1 mrad"}, {0.00234, "within 2.3 mrad"}, {0.1234, "within 123 mrad"}}) {
    status.outlook.error = error;
    const std::string said = find(seat_lines(status, {}, ""), "prediction")->words;
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
}

TEST(SeatWords, WhoDoesNotCommandIsNotToldKeysThatDoNothing) {
  SeatStatus status = driving();
  status.robot->doing = {"", "drives hold", "home them (h)"};
  EXPECT_EQ(find(seat_lines(status, {}, ""), "robot")->cure, "home them (H)");
  status.held = status.engaged = false;
  status.control.phase = Phase::connected;
  EXPECT_EQ(find(seat_lines(status, {}, ""), "robot")->cure, "");
}

TEST(SeatWords, ARobotWithOtherFilesIsRefusedOnce) {
  SeatStatus status = driving();
  status.held = status.engaged = false;
  status.control.phase = Phase::connected;
  status.control.wanted = true;
  status.control.differences = {{"another URDF", "copy it", true}, {"another calibration", "copy that", false}};
  status.control.words = "another URDF; copy it";
  status.fates.push_back({1, LineRequest::home, RequestOutcome::not_holder});
  const auto lines = seat_lines(status, {}, "");
  EXPECT_FALSE(find(lines, "refused")) << "who commands says it";
  EXPECT_EQ(find(lines, "differs")->cure, "copy that");
  EXPECT_EQ(find(lines, "asked")->cure, "copy it") << "waiting for control would not help";
}

// Its states name joints that this side does not know, and are refused; its lease and its images come.
TEST(SeatWords, ARobotThatIsHeardAndNotUnderstoodIsNotCalledSilent) {
  SeatStatus status = driving();
  status.held = status.engaged = status.control.follows = false;
  status.control.phase = Phase::connected;
  status.control.differences = {{"joint 10 is 'nod'", "give both sides the same rig file", true}};
  status.control.state_age = Duration{0};
  status.robot_age = std::chrono::seconds(30);
  for (const bool heard_before : {true, false}) {
    if (!heard_before) status.robot.reset(), status.robot_age.reset();
    const auto lines = seat_lines(status, {}, "");
    EXPECT_EQ(find(lines, "robot")->words, "it is another one, and what it says of itself is not taken");
    EXPECT_EQ(find(lines, "robot")->cure, "give both sides the same rig file");
    EXPECT_EQ(find(lines, "line")->words.find("nothing comes"), std::string::npos) << find(lines, "line")->words;
  }
  status.control.state_age = std::chrono::seconds(1);  // now it has gone
  EXPECT_NE(find(seat_lines(status, {}, ""), "line")->words.find("nothing comes"), std::string::npos);
}

// Of two operators: G asks for control, but takes the request back of who has asked already.
TEST(SeatWords, WhoWaitsForControlIsNotToldToAskForIt) {
  SeatStatus status = driving();
  status.held = status.engaged = false;
  status.control.phase = Phase::connected;
  status.control.words = "connected";
  status.control.cure = "ask for control";
  EXPECT_EQ(next_step(status).cure, "ask for control (G)");
  status.control.wanted = true;
  status.control.words = "'anna' commands; wait";
  status.control.cure = "";
  status.fates.push_back({1, LineRequest::enable, RequestOutcome::not_holder});
  const auto lines = seat_lines(status, {}, "");
  for (const std::string& cure : {next_step(status).cure, find(lines, "in command")->cure, find(lines, "asked")->cure})
    EXPECT_EQ(cure.find("ask for control"), std::string::npos) << cure;
  EXPECT_NE(next_step(status).cure.find("G takes your request back"), std::string::npos);
  EXPECT_NE(find(lines, "asked")->cure.find("wait"), std::string::npos);
}

// What he asked for before he had control is over: G would now give it away.
TEST(SeatWords, WhoHasControlIsNotToldToAskForIt) {
  SeatStatus status = driving();
  status.fates.push_back({1, LineRequest::home, RequestOutcome::not_holder});
  EXPECT_FALSE(find(seat_lines(status, {}, ""), "asked"));
}

TEST(SeatWords, WhoMayNotMoveAnythingYetIsNotToldToPressTheSwitch) {
  SeatStatus status = driving();
  status.held = status.engaged = status.control.follows = false;
  status.control.words = "the switch is open";
  status.control.cure = "press the switch";
  EXPECT_EQ(find(seat_lines(status, {}, ""), "in command")->cure, "");
  status.robot_control.ready = true;
  EXPECT_EQ(find(seat_lines(status, {}, ""), "in command")->cure, "press the switch");
}

TEST(SeatWords, TheOtherOperatorIsNamedOnceAndWithTheKey) {
  SeatStatus status = driving();
  status.robot_control.asking_name = "anna";
  EXPECT_THAT(find(seat_lines(status, {}, ""), "in command")->words, testing::HasSubstr("anna asks for it: T"));
  status.control.phase = Phase::connected;
  status.robot_control.holder_name = "anna";
  status.control.words = "'anna' commands; wait";
  EXPECT_EQ(find(seat_lines(status, {}, ""), "in command")->words, "'anna' commands; wait");
  status.control.words = "connected";
  EXPECT_EQ(find(seat_lines(status, {}, ""), "in command")->words, "connected; anna commands");
}

TEST(SeatWords, WhileJointsLookForHomeNobodyIsToldToHomeThem) {
  SeatStatus status = driving();
  const std::string fault = "no pose: 3 of 10 joints tell no position; home them (H)";
  EXPECT_EQ(find(seat_lines(status, {}, fault), "images")->words, fault);
  status.robot->phase.label = "homing";
  EXPECT_EQ(find(seat_lines(status, {}, fault), "images")->words,
            "no pose: 3 of 10 joints tell no position; they look for home");
}

TEST(SeatWords, DrivesWithTheSameTroubleAreTogetherAndTheWorstCounts) {
  SeatStatus status = driving();
  const auto drive = [](const char* name, const char* fault) {
    link::DriveLine out;
    out.name = name;
    out.state = "offline";
    out.fault = fault;
    return out;
  };
  status.robot->drives = {drive("yaw", "overcurrent"), drive("elbow", ""), drive("wrist", "overcurrent")};
  const auto lines = seat_lines(status, {}, "");
  EXPECT_EQ(find(lines, "drives")->words, "yaw, wrist: overcurrent; elbow: offline, not homed");
  EXPECT_EQ(find(lines, "drives")->urgency, Urgency::trouble) << "whatever comes after it";
}

TEST(SeatWords, WhoWantsToSeeThePictureIsToldWhatIsNotWell) {
  SeatStatus status = driving();
  status.robot->hold = "joint elbow stands";
  auto lines = seat_lines(status, {}, "no image has come");
  ASSERT_TRUE(find(lines, "drives"));
  leave_out_fine(lines);
  EXPECT_FALSE(find(lines, "drives"));
  for (const char* label : {"in command", "robot", "images"}) EXPECT_TRUE(find(lines, label)) << label;
}

TEST(SeatWords, BeforeAnythingIsHeardTheRobotIsLookedFor) {
  SeatStatus status;
  status.control.words = "looking for the robot";
  status.control.cure = "see that its program runs with --serve on domain 3, interface lo";
  EXPECT_EQ(next_step(status).words, "looking for the robot");
  const auto lines = seat_lines(status, {}, "");
  ASSERT_TRUE(find(lines, "robot"));
  EXPECT_EQ(find(lines, "robot")->urgency, Urgency::trouble);
  EXPECT_EQ(find(lines, "robot")->cure, status.control.cure);
}

TEST(SeatWords, ARequestThatIsNotFollowedSaysWhy) {
  SeatStatus status = driving();
  EXPECT_FALSE(find(seat_lines(status, {}, ""), "asked"));
  status.fates.push_back({1, LineRequest::set_up, RequestOutcome::before_stop});
  const auto lines = seat_lines(status, {}, "");
  ASSERT_TRUE(find(lines, "asked"));
  EXPECT_NE(find(lines, "asked")->words.find("set up: "), std::string::npos);
  EXPECT_NE(find(lines, "asked")->cure, "");
  status.fates.push_back({2, LineRequest::set_up, std::nullopt});
  const auto unanswered = seat_lines(status, {}, "");
  ASSERT_TRUE(find(unanswered, "asked"));
  EXPECT_NE(find(unanswered, "asked")->words.find("no answer"), std::string::npos);
  status.fates.push_back({3, LineRequest::set_up, RequestOutcome::taken});
  EXPECT_FALSE(find(seat_lines(status, {}, ""), "asked"));
}

}  // namespace
}  // namespace foresight::seat_words_test
