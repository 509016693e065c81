#include "link/dds/pretended_line.hpp"

#include "child.hpp"
#include "link/dds/endpoints.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::pretended_line_test {
namespace {

using namespace std::chrono_literals;

LineSpec line(Duration up, Duration down) {
  LineSpec out;
  out.up.delay = up;
  out.down.delay = down;
  return out;
}

TEST(PretendedLine, EachSideSendsItsOwnWay) {
  SteppedClock clock;
  PretendedLine robot(line(30ms, 10ms), PretendedLine::Side::robot, clock),
      operating(line(30ms, 10ms), PretendedLine::Side::operating, clock);
  std::vector<std::int64_t> came;
  const auto note = [&] { came.push_back(clock.now().ns / 1'000'000); };
  robot.send(100, true, note);
  operating.send(100, true, note);
  EXPECT_EQ(robot.receive(100, true), RobotTime{} + 10ms);
  EXPECT_EQ(operating.receive(100, true), RobotTime{} + 30ms);
  for (int i = 0; i < 50; ++i) {
    clock.sleep_until(clock.now() + 1ms);
    robot.step();
    operating.step();
  }
  EXPECT_EQ(came, (std::vector<std::int64_t>{10, 30}));
}

TEST(PretendedLine, ALargeSampleIsThereWithItsLastDatagram) {
  SteppedClock clock;
  LineSpec thin = line(0ms, 0ms);
  thin.up.bytes_per_s = 100'000;
  PretendedLine robot(thin, PretendedLine::Side::robot, clock);
  bool came = false;
  robot.send(100'000, true, [&] { came = true; });  // 75 datagrams, and 100 bytes more each
  clock.sleep_until(RobotTime{} + 1050ms);
  robot.step();
  EXPECT_FALSE(came);
  clock.sleep_until(RobotTime{} + 1100ms);
  robot.step();
  EXPECT_TRUE(came);
}

TEST(PretendedLine, WhatIsLostComesAgainWhereTheTopicIsReliable) {
  SteppedClock clock;
  LineSpec lossy = line(20ms, 20ms);
  lossy.up.loss = 0.3;
  PretendedLine robot(lossy, PretendedLine::Side::robot, clock);
  std::vector<Duration> reliable, once;
  for (int i = 0; i < 500; ++i) {
    const RobotTime sent = clock.now();
    robot.send(100, true, [&, sent] { reliable.push_back(clock.now() - sent); });
    robot.send(100, false, [&, sent] { once.push_back(clock.now() - sent); });
    clock.sleep_until(clock.now() + 1ms);
    robot.step();
  }
  clock.sleep_until(clock.now() + 1s);
  robot.step();
  EXPECT_GE(reliable.size(), 499u);
  EXPECT_NEAR(static_cast<double>(once.size()), 350, 40);
  EXPECT_EQ(robot.counts().crossed, reliable.size() + once.size());
  EXPECT_NEAR(static_cast<double>(std::ranges::count_if(reliable, [](Duration d) { return d > 50ms; })), 150, 40)
      << "a round trip later";
}

TEST(PretendedLine, AQueueWithoutEndHasAnEndHere) {
  SteppedClock clock;
  LineSpec thin = line(0ms, 0ms);
  thin.up.bytes_per_s = 1000;
  PretendedLine robot(thin, PretendedLine::Side::robot, clock);
  const std::size_t large = PretendedLine::kMostWaiting / 4;
  for (int i = 0; i < 6; ++i) robot.send(large, false, [] {});
  EXPECT_EQ(robot.counts().dropped, 2u);
}

class PretendedDds : public PrivateNetworkTest {};

TEST_F(PretendedDds, WhatNobodyReadsTakesNothingOfTheLine) {
  SteppedClock clock;
  LineSpec thin = line(0ms, 0ms);
  thin.up.bytes_per_s = 1000;
  const auto robot = std::make_shared<PretendedLine>(thin, PretendedLine::Side::robot, clock);
  Participant program(LinkConfig{}, "test", Role::robot, robot);
  const Topic topic{"rt/x", Header::kType, Delivery::newest, 8};
  Writer writer(program, topic);
  for (int i = 0; i < 10; ++i) writer.write(Header{{i, 0}, "a"});
  EXPECT_EQ(robot->counts().crossed, 0u);
  const Reader reader(program, topic);
  for (int i = 0; i < 10; ++i) writer.write(Header{{i, 0}, "a"});
  EXPECT_EQ(robot->counts().crossed, 10u);
}

// One program is the robot's, and hears itself: what it writes goes up, and comes in as if it came down.
TEST_F(PretendedDds, SamplesPassItOnTheirWayOutAndIn) {
  SteppedClock clock;
  const auto pretended = std::make_shared<PretendedLine>(line(30ms, 20ms), PretendedLine::Side::robot, clock);
  Participant program(LinkConfig{}, "test", Role::robot, pretended);
  const Topic topic{"rt/x", Header::kType, Delivery::newest, 8};
  std::optional<Writer> writer(std::in_place, program, topic);
  Reader reader(program, topic);
  EXPECT_TRUE(writer->write(Header{{7, 0}, "a"}));
  std::vector<int> came;  // ms
  for (int ms = 1; ms <= 100; ++ms) {
    clock.sleep_until(clock.now() + 1ms);
    pretended->step();
    if (!reader.wait(0ns)) continue;
    reader.take([&](const Sample& sample) {
      EXPECT_EQ(from_cdr<Header>(sample.cdr)->stamp.sec, 7);
      came.push_back(ms);
    });
  }
  EXPECT_EQ(came, std::vector<int>{50});
  writer->write(Header{{8, 0}, "a"});
  writer.reset();  // what is under way of a writer that has gone goes nowhere
  clock.sleep_until(clock.now() + 1s);
  pretended->step();
  EXPECT_FALSE(reader.wait(0ns));
}

// As without the line: of what is there, a reader gets the newest that its topic has room for.
TEST_F(PretendedDds, TheNewestCountsBehindItToo) {
  SteppedClock clock;
  const auto pretended = std::make_shared<PretendedLine>(line(0ms, 20ms), PretendedLine::Side::robot, clock);
  Participant program(LinkConfig{}, "test", Role::robot, pretended);
  const Topic topic{"rt/x", Header::kType, Delivery::newest, 2};
  Writer writer(program, topic);
  Reader reader(program, topic);
  for (int i = 1; i <= 5; ++i) {
    writer.write(Header{{i, 0}, "a"});
    pretended->step();
    reader.wait(0ns);  // takes it in
    clock.sleep_until(clock.now() + 1ms);
  }
  clock.sleep_until(clock.now() + 1s);
  std::vector<int> came;
  reader.take([&](const Sample& sample) { came.push_back(from_cdr<Header>(sample.cdr)->stamp.sec); });
  EXPECT_EQ(came, (std::vector<int>{4, 5}));
}

// The same in real time: it only has to come.
TEST_F(PretendedDds, ItsThreadDelivers) {
  MonotonicClock clock;
  const auto pretended = std::make_shared<PretendedLine>(line(3ms, 3ms), PretendedLine::Side::robot, clock);
  pretended->start();
  Participant program(LinkConfig{}, "test", Role::robot, pretended);
  const Topic topic{"rt/x", Header::kType, Delivery::once, 8};
  Writer writer(program, topic);
  Reader reader(program, topic);
  writer.write(Header{{7, 0}, "a"});
  int came = 0;
  EXPECT_TRUE(comes_true([&] {
    reader.wait(5ms);
    reader.take([&](const Sample&) { ++came; });
    return came == 1;
  }));
}

}  // namespace
}  // namespace foresight::link::pretended_line_test
