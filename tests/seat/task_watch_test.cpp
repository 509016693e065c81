// When a task that a program does began, when it ended, and how.
#include "seat/task_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foresight::task_watch_test {
namespace {

const ScriptState kWaits{}, kDrives{.driving = true}, kDone{.done = true};

RobotTime at(double t) {
  return RobotTime{} + seconds(t);
}
ThingLies in_place() {
  return ThingLies::in_place;
}

TEST(TaskWatch, LastsFromTheFirstPressToTheEndOfTheScript) {
  TaskWatch task(60, TaskWatch::OverTime::ends);
  task.see(at(1), kWaits);
  EXPECT_FALSE(task.began());
  task.see(at(2), kDrives);
  EXPECT_TRUE(task.under_way());
  task.see(at(5), kWaits);  // lost: it lets go, and will press again
  EXPECT_TRUE(task.under_way());
  task.see(at(6), kDrives);
  task.see(at(9), kDone);
  EXPECT_FALSE(task.under_way());
  ASSERT_TRUE(task.ended());
  EXPECT_EQ(*task.ended(), at(9));
  task.see(at(12), kDone);
  const TaskOutcome out = task.outcome(at(12), "", in_place);
  EXPECT_TRUE(out.succeeded);
  EXPECT_EQ(out.failure, "");
  EXPECT_DOUBLE_EQ(out.seconds, 7);
}

TEST(TaskWatch, EndsWhereTheScriptTakesTooLong) {
  TaskWatch task(10, TaskWatch::OverTime::ends);
  task.see(at(0), kDrives);
  task.see(at(10), kDrives);
  EXPECT_TRUE(task.under_way());
  task.see(at(10.1), kDrives);
  EXPECT_TRUE(task.ended());
  EXPECT_TRUE(task.outcome(at(11), "", in_place).succeeded);
}

TEST(TaskWatch, ATaskIsDoneInItsTimeOrNotAtAll) {
  TaskWatch in_time(10, TaskWatch::OverTime::fails), late(10, TaskWatch::OverTime::fails);
  for (TaskWatch* task : {&in_time, &late}) task->see(at(0), kDrives);
  in_time.see(at(9.9), kDone);
  late.see(at(10.1), kDrives);
  late.see(at(10.2), kDone);
  EXPECT_TRUE(in_time.outcome(at(11), "", in_place).succeeded);
  const TaskOutcome out = late.outcome(at(11), "", in_place);
  EXPECT_FALSE(out.succeeded);
  EXPECT_EQ(out.failure, "not done after 10 s; give it more by --seconds");
}

TEST(TaskWatch, TellsHowLongTheRobotWasHeldBack) {
  TaskWatch task(10, TaskWatch::OverTime::ends);
  task.see(at(0), kWaits, "before");
  task.see(at(1), kDrives);
  task.see(at(2), kDrives, "link 'hand' comes too close to obstacle 'floor'");
  task.see(at(3), kDrives);
  task.see(at(5), kDone);
  const TaskOutcome out = task.outcome(at(5), "", in_place);
  EXPECT_TRUE(out.succeeded) << "it went on";
  EXPECT_NEAR(out.held_share, 0.25, 1e-9);
  EXPECT_EQ(out.held_by, "link 'hand' comes too close to obstacle 'floor'");
}

TEST(TaskWatch, DidNotSucceedWhereTheRobotMostlyStood) {
  TaskWatch task(10, TaskWatch::OverTime::ends);
  task.see(at(0), kDrives);
  task.see(at(4), kDrives);
  for (int i = 1; i <= 50; ++i) task.see(at(4 + 0.1 * i), kDrives, "link 'hand' leaves the workspace");
  task.see(at(9.1), kDone);
  const TaskOutcome out = task.outcome(at(10), "", in_place);
  EXPECT_FALSE(out.succeeded);
  EXPECT_EQ(out.failure, "the safety gate held the robot back most of the time: link 'hand' leaves the workspace");
}

TEST(TaskWatch, MoreTimeIsNoCureForARobotThatMostlyStood) {
  TaskWatch task(10, TaskWatch::OverTime::fails);
  task.see(at(0), kDrives);
  task.see(at(4), kDrives);
  for (int i = 1; i <= 61; ++i) task.see(at(4 + 0.1 * i), kDrives, "link 'hand' leaves the workspace");
  EXPECT_EQ(task.outcome(at(11), "", in_place).failure,
            "the safety gate held the robot back most of the time: link 'hand' leaves the workspace");
}

TEST(TaskWatch, DidNotSucceedWhereNoImageHasShownThatItDid) {
  TaskWatch task(10, TaskWatch::OverTime::ends);
  task.see(at(0), kDrives);
  task.see(at(9), kDone);
  const auto outcome = [&](ThingLies lies) { return task.outcome(at(11), "", [lies] { return lies; }); };
  EXPECT_FALSE(outcome(ThingLies::elsewhere).succeeded);
  EXPECT_EQ(outcome(ThingLies::elsewhere).failure, "the thing is not in the tray");
  EXPECT_FALSE(outcome(ThingLies::unseen).succeeded);
  EXPECT_EQ(outcome(ThingLies::unseen).failure, "the model says it lies in the tray, but no image has confirmed it");
}

TEST(TaskWatch, SaysWhyItDidNotSucceedAndAsksForNothingElse) {
  const auto never = [] {
    ADD_FAILURE() << "asked where things are, of a task that did not end";
    return ThingLies::in_place;
  };
  TaskWatch idle(10, TaskWatch::OverTime::ends);
  idle.see(at(0), kWaits);
  EXPECT_THAT(idle.outcome(at(1), "no robot heard of", never).failure, testing::HasSubstr("no robot heard of"));

  TaskWatch stopped(10, TaskWatch::OverTime::ends);
  stopped.see(at(0), kDrives);
  const TaskOutcome half = stopped.outcome(at(3), "", never);
  EXPECT_FALSE(half.succeeded);
  EXPECT_THAT(half.failure, testing::HasSubstr("stopped"));
  EXPECT_DOUBLE_EQ(half.seconds, 3);

  TaskWatch failed(10, TaskWatch::OverTime::ends);
  failed.see(at(0), kDrives);
  failed.see(at(2), {.done = true, .failure = "lost too often"});
  EXPECT_TRUE(failed.failed());
  EXPECT_FALSE(failed.under_way());
  EXPECT_FALSE(failed.ended());
  EXPECT_EQ(failed.outcome(at(2), "", never).failure, "lost too often");
}

}  // namespace
}  // namespace foresight::task_watch_test
