#include "common/priority_mutex.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>

#include "common/real_time.hpp"

namespace foresight::priority_mutex_test {
namespace {

using namespace std::chrono_literals;

// Field 18 of proc(5): negative for real-time threads, -1 - priority.
int priority_of(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  std::string field;
  std::getline(file, field, ')');
  for (int i = 3; i <= 18; ++i) file >> field;
  return std::stoi(field);
}

TEST(PriorityMutex, ItsHolderIsAsUrgentAsWhoWaits) {
  PriorityMutex mutex;
  std::atomic<bool> waits = false;
  std::string refused;
  const int own = priority_of(gettid());
  mutex.lock();
  std::thread urgent([&] {
    refused = make_real_time(priority::kSeat);
    waits = true;
    const std::lock_guard lock(mutex);
  });
  while (!waits) std::this_thread::yield();
  // The other is about to wait for it, whenever the machine lets it.
  constexpr int kLooks = 60'000, kWaitedFor = -1 - priority::kSeat;
  for (int i = 0; i < kLooks && refused.empty() && priority_of(gettid()) != kWaitedFor; ++i)
    std::this_thread::sleep_for(1ms);
  const int waited_for = priority_of(gettid());
  mutex.unlock();
  urgent.join();
  if (!refused.empty()) GTEST_SKIP() << refused;
  EXPECT_EQ(waited_for, kWaitedFor);
  EXPECT_EQ(priority_of(gettid()), own);
}

}  // namespace
}  // namespace foresight::priority_mutex_test
