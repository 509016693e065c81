#include "gl/sorting_buffer.hpp"

#include <algorithm>

namespace foresight::gl {

SortingBuffer::SortingBuffer(std::size_t slots, SortingStrategy strategy, unsigned seed)
    : slots_(slots), strategy_(strategy), random_(seed) {}

void SortingBuffer::put(const Draw& draw, std::vector<Draw>& out) {
  last_[draw.state] = ++puts_;
  if (slots_ == 0 || (any_left_ && draw.state == current_)) {
    any_left_ = true;
    current_ = draw.state;
    out.push_back(draw);
    return;
  }
  if (held_.size() == slots_) leave(choose(), out);
  if (any_left_ && draw.state == current_)
    out.push_back(draw);
  else
    held_.push_back(draw);
}

void SortingBuffer::flush(std::vector<Draw>& out) {
  while (!held_.empty()) leave(choose(), out);
}

int SortingBuffer::choose() {
  const auto by = [&](const auto& figures, auto better) {
    return std::ranges::min_element(held_, better,
                                    [&](const Draw& draw) {
                                      const auto it = figures.find(draw.state);
                                      return it == figures.end() ? std::uint64_t{0} : it->second;
                                    })
        ->state;
  };
  switch (strategy_) {
    case SortingStrategy::round_robin: {
      turn_ = turn_ % held_.size();
      return held_[turn_++].state;
    }
    case SortingStrategy::random_choice:
      return held_[std::uniform_int_distribution<std::size_t>(0, held_.size() - 1)(random_)].state;
    case SortingStrategy::least_recently_used: return by(last_, std::ranges::less{});
    case SortingStrategy::bounded_waste: return by(waste_, std::ranges::greater{});
  }
  return held_.front().state;
}

void SortingBuffer::leave(int state, std::vector<Draw>& out) {
  const auto left = std::ranges::stable_partition(held_, [&](const Draw& draw) { return draw.state != state; });
  out.insert(out.end(), left.begin(), left.end());
  held_.erase(left.begin(), left.end());
  any_left_ = true;
  current_ = state;
  waste_[state] = 0;
  for (const Draw& draw : held_) ++waste_[draw.state];
}

std::size_t state_changes(const std::vector<Draw>& draws) {
  std::size_t changes = 0;
  for (std::size_t i = 0; i < draws.size(); ++i) changes += i == 0 || draws[i].state != draws[i - 1].state;
  return changes;
}

}  // namespace foresight::gl
