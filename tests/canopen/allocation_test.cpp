// The loop must not allocate: every allocation of this thread is counted.
#include <gtest/gtest.h>

#include "scripted_slave.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::canopen::allocation_test {
namespace {

TEST(Loop, DoesNotAllocate) {
  CanopenRig rig(3);
  rig.configure();
  std::size_t inside = 0;
  int homed = 0;
  for (int i = 0; i < 400; ++i) {
    rig.clock.sleep_until(rig.clock.now() + rig.config.cycle);
    if (i == 250) rig.slave(1).fail(0x8611);
    const std::size_t before = allocations();
    rig.network->receive(rig.clock.now());
    for (Drive* drive : rig.network->drives()) {
      if (i == 2) drive->request(DriveRequest::enable);
      if (i == 50) drive->request(DriveRequest::home);
      if (i == 300) drive->request(DriveRequest::quick_stop);
      if (i == 320) drive->request(DriveRequest::reset_fault);
      drive->set_point(0.001 * i, 0);
      homed += drive->feedback().homed;
    }
    rig.network->send(rig.clock.now());
    inside += allocations() - before;
  }
  EXPECT_EQ(inside, 0);
  EXPECT_GT(homed, 0);
  EXPECT_EQ(rig.feedback(0).state, DriveState::stopping);
  EXPECT_GT(allocations(), 100u) << "they are counted";
}

}  // namespace
}  // namespace foresight::canopen::allocation_test
