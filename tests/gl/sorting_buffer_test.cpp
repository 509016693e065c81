// Fewer changes of state, and nothing lost.
#include "gl/sorting_buffer.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace foresight::gl::sorting_buffer_test {
namespace {

constexpr SortingStrategy kAll[] = {SortingStrategy::round_robin, SortingStrategy::random_choice,
                                    SortingStrategy::least_recently_used, SortingStrategy::bounded_waste};

std::vector<Draw> through(const std::vector<Draw>& draws, std::size_t slots, SortingStrategy strategy) {
  SortingBuffer buffer(slots, strategy);
  std::vector<Draw> out;
  for (const Draw& draw : draws) buffer.put(draw, out);
  buffer.flush(out);
  return out;
}

std::vector<Draw> random_draws(int count, int states) {
  std::mt19937 random(3);
  std::vector<Draw> out;
  for (int i = 0; i < count; ++i) out.push_back({std::uniform_int_distribution(0, states - 1)(random), i});
  return out;
}

TEST(SortingBuffer, WithoutSlotsAllPassAsTheyCome) {
  const auto draws = random_draws(200, 7);
  for (const SortingStrategy strategy : kAll) EXPECT_EQ(through(draws, 0, strategy), draws);
}

TEST(SortingBuffer, NothingIsLostAndDrawsOfOneStateKeepTheirOrder) {
  const auto draws = random_draws(1000, 20);
  for (const SortingStrategy strategy : kAll)
    for (const std::size_t slots : {1, 5, 40, 300}) {
      const auto out = through(draws, slots, strategy);
      auto sorted = out;
      std::ranges::stable_sort(sorted, {}, &Draw::state);
      auto wanted = draws;
      std::ranges::stable_sort(wanted, {}, &Draw::state);
      EXPECT_EQ(sorted, wanted);
      EXPECT_LT(state_changes(out), state_changes(draws)) << slots;
      EXPECT_GE(state_changes(out), 20u);
    }
}

TEST(SortingBuffer, ABufferForAllSortsAll) {
  const auto draws = random_draws(300, 12);
  for (const SortingStrategy strategy : kAll) EXPECT_EQ(state_changes(through(draws, 300, strategy)), 12u);
}

TEST(SortingBuffer, NeverHoldsMoreThanItsSlots) {
  const auto draws = random_draws(500, 9);
  for (const SortingStrategy strategy : kAll) {
    SortingBuffer buffer(16, strategy);
    std::vector<Draw> out;
    for (std::size_t i = 0; i < draws.size(); ++i) {
      buffer.put(draws[i], out);
      EXPECT_LE(i + 1 - out.size(), 16u);
    }
  }
}

// What comes often drives out what comes rarely, though it would gain by waiting: m + 1 changes a round, where 2 m in
// all would do.
TEST(SortingBuffer, TheOldestStateIsTheWorstChoiceForTwoThatTakeTurns) {
  const int m = 6;
  const auto k = static_cast<std::size_t>(m * m + 1);
  std::vector<Draw> draws;
  for (int round = 0; round < m; ++round) {
    for (int c = 0; c < m; ++c) draws.push_back({c, 0});
    for (std::size_t i = 0; i < k; ++i) draws.push_back({round % 2 == 0 ? m : m + 1, 0});
  }
  const std::size_t oldest = state_changes(through(draws, k, SortingStrategy::least_recently_used));
  const std::size_t turns = state_changes(through(draws, k, SortingStrategy::round_robin));
  EXPECT_GT(oldest, 3u * m);
  EXPECT_LT(turns, oldest);
}

}  // namespace
}  // namespace foresight::gl::sorting_buffer_test
