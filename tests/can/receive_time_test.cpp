#include "drivers/can/receive_time.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <random>

namespace foresight::receive_time_test {
namespace {

using namespace std::chrono_literals;

TEST(ReceiveTime, OffsetOfTheClocksIsTheSystems) {
  timespec monotonic{}, real{};
  clock_gettime(CLOCK_MONOTONIC, &monotonic);
  clock_gettime(CLOCK_REALTIME, &real);
  const Duration expected =
      std::chrono::seconds(real.tv_sec - monotonic.tv_sec) + Duration{real.tv_nsec - monotonic.tv_nsec};
  // Between the two readings the thread may lose its core.
  EXPECT_LT(std::abs((realtime_minus_monotonic() - expected).count()), 20'000'000);
}

TEST(ReceiveTime, FollowsADriftingDeviceClock) {
  DeviceClockOffset offset;
  std::mt19937 random(6);
  const Duration device_epoch = 1'700'000'000s;
  for (int i = 0; i < 60'000; ++i) {
    const Duration real = i * 1ms;
    const Duration device{static_cast<std::int64_t>(static_cast<double>(real.count()) * (1 + 50e-6))};
    const Duration late{20'000 + random() % 500'000};  // of the interrupt
    const Duration out = offset.to_kernel(device, device_epoch + real + late) - device_epoch;
    ASSERT_LE(out, real + late);
    ASSERT_LT(std::abs((out - real).count()), 1'100'000) << i;
  }
}

TEST(ReceiveTime, StartsAfreshWhenAClockIsSet) {
  DeviceClockOffset offset;
  EXPECT_EQ(offset.to_kernel(5s, 105s), 105s);
  EXPECT_EQ(offset.to_kernel(6s, 106s + 1ms), 106s);
  EXPECT_EQ(offset.to_kernel(7s, 4000s), 4000s) << "the machine's clock was set";
  EXPECT_EQ(offset.to_kernel(0s, 4001s), 4001s) << "the controller was restarted";
  EXPECT_EQ(offset.to_kernel(1s, 4002s + 1ms), 4002s);
}

}  // namespace
}  // namespace foresight::receive_time_test
