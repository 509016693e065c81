// Random and truncated frames into a network whose drives are enabled.
#include <gtest/gtest.h>

#include <random>

#include "drivers/canopen/wire.hpp"
#include "frames.hpp"
#include "scripted_slave.hpp"

namespace foresight::canopen::network_fuzz_test {
namespace {

CanFrame random_frame(std::mt19937& random) {
  // Half of them with identifiers that mean something here.
  const std::uint32_t kIds[] = {0x000, 0x080, 0x081, 0x082, 0x181, 0x182, 0x281, 0x282,
                                0x201, 0x581, 0x582, 0x601, 0x701, 0x702, 0x77f};
  CanFrame f;
  f.id = random() % 2 ? kIds[random() % std::size(kIds)] : random() % 0x800;
  f.size = static_cast<std::uint8_t>(random() % 9);
  for (int b = 0; b < 8; ++b) f.data[static_cast<std::size_t>(b)] = static_cast<std::uint8_t>(random());
  f.remote = random() % 16 == 0;
  f.extended = random() % 16 == 0;
  if (random() % 16 == 0) {
    f.fd = true;
    f.size = static_cast<std::uint8_t>(random() % 65);
  }
  return f;
}

/// The targets that `node` was told to follow since the last call.
std::vector<std::int32_t> followed(CanBus& ear, std::uint32_t node) {
  std::vector<std::int32_t> out;
  while (const auto f = ear.receive(Duration{0}))
    if (f->id == 0x200 + node && f->size == 6 && (f->data[0] & 0x0f) == 0x0f)
      out.push_back(static_cast<std::int32_t>(load(f->payload().subspan(2), 4)));
  return out;
}

// Whatever is heard, a drive that is told to be in operation is told the set-point that was given, or nothing.
TEST(NetworkFuzz, NoFrameChangesASetPoint) {
  std::mt19937 random(5);
  int frames = 0, stopped = 0, checked = 0;
  for (int round = 0; frames < 10000; ++round) {
    CanopenRig rig(2);
    rig.configure();
    rig.enable();
    rig.cycles(3, 1.25);
    for (auto& slave : rig.slaves) slave->mute = true;  // only the fuzz speaks: no lie is corrected
    const auto ear = rig.bus.attach(), other_ear = rig.bus.attach();
    for (int cycle = 0; cycle < 8; ++cycle) {
      for (int i = 0; i < 5; ++i, ++frames) rig.stranger->send(random_frame(random));
      rig.network->receive(rig.clock.now());
      for (Drive* drive : rig.network->drives()) drive->set_point(1.25, 0);
      followed(*ear, 1), followed(*other_ear, 2);  // what the fuzz sent
      rig.network->send(rig.clock.now());
      for (const std::int32_t target : followed(*ear, 1)) ASSERT_EQ(target, 750) << "round " << round;
      for (const std::int32_t target : followed(*other_ear, 2)) ASSERT_EQ(target, -750) << "round " << round;
      checked += rig.feedback(0).state == DriveState::enabled;
      rig.clock.sleep_until(rig.clock.now() + rig.config.cycle);
    }
    stopped += !rig.network->healthy();
  }
  EXPECT_GT(stopped, 10) << "the fuzz reaches what it should";
  EXPECT_GT(checked, 50) << "and does not stop all at once";
}

// Frames that are not CANopen, truncated, or of nobody: the drives do not even notice.
TEST(NetworkFuzz, TruncatedAndForeignFramesChangeNothing) {
  std::mt19937 random(6);
  CanopenRig rig(2);
  rig.configure();
  rig.enable();
  const std::uint32_t kShort[] = {0x181, 0x182, 0x281, 0x282, 0x081, 0x082, 0x581, 0x582};
  for (int i = 0; i < 2000; ++i) {
    for (int n = 0; n < 5; ++n) {
      CanFrame f = random_frame(random);
      f.fd = false;
      if (n < 3) {
        f.id = kShort[random() % std::size(kShort)];
        f.size = static_cast<std::uint8_t>(random() % 5);
      } else if (n == 3) {
        f.extended = true;
        f.size %= 9;
      } else {
        f.id = 0x300 + random() % 0x80;
        f.size %= 9;
      }
      rig.stranger->send(f);
    }
    rig.cycles(1, 1.25);
    ASSERT_EQ(rig.feedback(0).state, DriveState::enabled) << i << ": " << rig.feedback(0).fault;
    ASSERT_EQ(rig.feedback(1).state, DriveState::enabled) << i << ": " << rig.feedback(1).fault;
  }
  EXPECT_TRUE(rig.network->healthy()) << rig.network->reason();
  EXPECT_EQ(rig.slave(0).position, 750);
  EXPECT_EQ(rig.slave(1).position, -750);
}

}  // namespace
}  // namespace foresight::canopen::network_fuzz_test
