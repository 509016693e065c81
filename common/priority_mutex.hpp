// A lock between threads of different urgency.
#pragma once

#include <pthread.h>

#include <system_error>

namespace foresight {

/// While a more urgent thread waits for it, its holder is as urgent (priority inheritance, POSIX.1-2017 2.9.4): a
/// real-time loop waits for what is done under the lock, never for all that a busy machine does before that. For
/// std::lock_guard, as std::mutex.
class PriorityMutex {
 public:
  PriorityMutex() {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    const int error = pthread_mutex_init(&mutex_, &attributes);
    pthread_mutexattr_destroy(&attributes);
    if (error != 0) throw std::system_error(error, std::generic_category(), "a mutex with priority inheritance");
  }
  ~PriorityMutex() { pthread_mutex_destroy(&mutex_); }
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock() noexcept { pthread_mutex_lock(&mutex_); }
  void unlock() noexcept { pthread_mutex_unlock(&mutex_); }

 private:
  pthread_mutex_t mutex_;
};

}  // namespace foresight
