#include "apps/bench/sorting_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "gl/sorting_buffer.hpp"

namespace foresight {
namespace {

using gl::Draw;
using gl::SortingStrategy;

constexpr int kDraws = 20'000, kStates = 64;
constexpr std::array<std::size_t, 6> kSlots{0, 4, 16, 64, 256, 1024};

struct Strategy {
  SortingStrategy strategy;
  const char *key, *words;
};
constexpr std::array kStrategies{
    Strategy{SortingStrategy::round_robin, "round_robin", "round robin"},
    Strategy{SortingStrategy::random_choice, "random_choice", "random choice"},
    Strategy{SortingStrategy::least_recently_used, "least_recently_used", "least recently used"},
    Strategy{SortingStrategy::bounded_waste, "bounded_waste", "bounded waste"}};

std::vector<Draw> at_random(std::mt19937& random) {
  std::uniform_int_distribution any(0, kStates - 1);
  std::vector<Draw> out;
  for (int i = 0; i < kDraws; ++i) out.push_back({any(random), i});
  return out;
}

/// The n-th state comes 1 / n times as often as the first.
std::vector<Draw> some_more_often(std::mt19937& random) {
  std::vector<double> weights;
  for (int i = 1; i <= kStates; ++i) weights.push_back(1.0 / i);
  std::discrete_distribution<int> any(weights.begin(), weights.end());
  std::vector<Draw> out;
  for (int i = 0; i < kDraws; ++i) out.push_back({any(random), i});
  return out;
}

/// Objects of a few parts, whose states are those of the room they stand in: eight of all.
std::vector<Draw> object_by_object(std::mt19937& random) {
  std::uniform_int_distribution any(0, kStates - 1), parts(2, 6), of_room(0, 7);
  std::vector<Draw> out;
  while (out.size() < kDraws) {
    std::array<int, 8> room{};
    for (int& state : room) state = any(random);
    for (int object = 0; object < 40; ++object)
      for (int part = parts(random); part > 0; --part)
        out.push_back({room[static_cast<std::size_t>(of_room(random))], static_cast<int>(out.size())});
  }
  out.resize(kDraws);
  return out;
}

double changes_a_draw(const std::vector<Draw>& draws) {
  return static_cast<double>(gl::state_changes(draws)) / static_cast<double>(draws.size());
}

double buffered(const std::vector<Draw>& draws, std::size_t slots, SortingStrategy strategy) {
  gl::SortingBuffer buffer(slots, strategy);
  std::vector<Draw> out;
  for (const Draw& draw : draws) buffer.put(draw, out);
  buffer.flush(out);
  return changes_a_draw(out);
}

}  // namespace

nlohmann::json sorting_figures(unsigned seed) {
  std::mt19937 random(seed);
  struct Stream {
    const char *key, *words;
    std::vector<Draw> draws;
  };
  nlohmann::json out;
  for (const Stream& stream : {Stream{"random", "at random", at_random(random)},
                               Stream{"uneven", "some states more often", some_more_often(random)},
                               Stream{"objects", "object by object", object_by_object(random)}}) {
    std::printf("changes of state a draw, %-24s", stream.words);
    for (const std::size_t slots : kSlots) std::printf(" %6zu", slots);
    std::printf(" slots\n");
    nlohmann::json& rows = out[stream.key];
    rows["slots"] = kSlots;
    for (const Strategy& one : kStrategies) {
      std::printf("  %-46s", one.words);
      for (const std::size_t slots : kSlots) {
        const double changes = buffered(stream.draws, slots, one.strategy);
        rows[one.key].push_back(changes);
        std::printf(" %6.3f", changes);
      }
      std::printf("\n");
    }
    auto sorted = stream.draws;
    std::ranges::stable_sort(sorted, {}, &Draw::state);
    rows["sorted"] = changes_a_draw(sorted);
    std::printf("  %-46s %6.3f\n", "sorted as a whole", changes_a_draw(sorted));
  }
  return out;
}

}  // namespace foresight
