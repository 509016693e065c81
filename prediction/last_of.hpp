// The last few of many values, in their order.
#pragma once

#include <cstddef>
#include <vector>

namespace foresight {

/// A ring that drops the oldest. Allocates at the start only. One thread.
template <typename T>
class LastOf {
 public:
  explicit LastOf(std::size_t most) : values_(most) {}

  std::size_t size() const noexcept { return count_; }
  bool empty() const noexcept { return count_ == 0; }
  /// From the oldest, 0, to the newest, size() - 1.
  const T& operator[](std::size_t i) const noexcept { return values_[place(i)]; }
  T& operator[](std::size_t i) noexcept { return values_[place(i)]; }
  const T& newest() const noexcept { return (*this)[count_ - 1]; }
  T& newest() noexcept { return (*this)[count_ - 1]; }

  /// Room for the next value, which is the newest from now on; it holds what an older one held.
  T& next() noexcept {
    if (count_ < values_.size())
      ++count_;
    else
      first_ = (first_ + 1) % values_.size();
    return newest();
  }
  void drop_oldest() noexcept {
    first_ = (first_ + 1) % values_.size();
    --count_;
  }
  void drop_newest() noexcept { --count_; }
  void clear() noexcept { first_ = count_ = 0; }

 private:
  std::size_t place(std::size_t i) const noexcept {
    const std::size_t straight = first_ + i;
    return straight < values_.size() ? straight : straight - values_.size();
  }

  std::vector<T> values_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace foresight
