// How one thread lends what it made to another that draws with it.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>

namespace foresight {

/// Keeps one T, which has `mutable std::atomic<int> leases`, from being written over. Hold it until the GPU has
/// finished the commands that read it (a fence has passed), not only until they are issued. The last one may delete
/// textures: let go of it where a context of their share group is current.
template <typename T>
class Lease {
 public:
  Lease() = default;
  explicit Lease(std::shared_ptr<const T> lent) : lent_(std::move(lent)) {
    if (lent_) lent_->leases.fetch_add(1, std::memory_order_relaxed);
  }
  Lease(Lease&& other) noexcept : lent_(std::move(other.lent_)) {}
  Lease& operator=(Lease&& other) noexcept {
    if (this != &other) {
      reset();
      lent_ = std::move(other.lent_);
    }
    return *this;
  }
  ~Lease() { reset(); }

  explicit operator bool() const { return lent_ != nullptr; }
  const T& operator*() const { return *lent_; }
  const T* operator->() const { return lent_.get(); }

 private:
  void reset() {
    if (lent_) lent_->leases.fetch_sub(1, std::memory_order_release);
    lent_.reset();
  }
  std::shared_ptr<const T> lent_;
};

/// The flip: one pointer, swapped whole. Any thread; holds its lock for a few instructions.
template <typename T>
class Latest {
 public:
  /// The newest one, or an empty lease before the first.
  Lease<T> acquire() const {
    const std::scoped_lock lock(mutex_);
    return Lease<T>(latest_);
  }
  void publish(std::shared_ptr<const T> next) {
    const std::scoped_lock lock(mutex_);
    latest_.swap(next);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const T> latest_;
};

}  // namespace foresight
