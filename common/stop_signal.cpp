#include "common/stop_signal.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

namespace foresight {
namespace {

// What a handler may touch: lock-free atomics.
std::atomic<int> asked_by = 0;
std::array<std::atomic<const char*>, 64> to_remove{};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free);

const char* name_of(int signal) {
  switch (signal) {
    case SIGINT: return "Ctrl-C";
    case SIGTERM: return "SIGTERM";
    case SIGHUP: return "SIGHUP";
  }
  return "";
}

void tell(const char* text) {
  [[maybe_unused]] const auto told = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// False: none could be removed.
bool remove_each(int (*remove)(const char*)) {
  bool any = false;
  for (const auto& slot : to_remove)
    if (const char* const path = slot; path && remove(path) == 0) any = true;
  return any;
}

/// Folders go once they are empty: after the files in them, and the inner ones first.
void remove_all() {
  remove_each(::unlink);
  while (remove_each(::rmdir)) {
  }
}

extern "C" void end_now(int signal) {
  remove_all();
  tell("\nforesight: stopped by ");
  tell(name_of(signal));
  tell("\n");
  ::_exit(kStopped);
}

extern "C" void ask(int signal) {
  asked_by = signal;
}

extern "C" void ask_once(int signal) {
  if (asked_by.exchange(signal) != 0) end_now(signal);
}

void handle(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
  }
}

}  // namespace

void end_on_stop_signals() {
  handle(end_now);
}

void poll_stop_signals(SecondSignal second) {
  asked_by = 0;
  handle(second == SecondSignal::ends ? ask_once : ask);
}

bool stop_requested() noexcept {
  return asked_by != 0;
}

const char* stopped_by() noexcept {
  return name_of(asked_by);
}

void remove_when_stopped(const char* path) noexcept {
  for (auto& slot : to_remove)
    if (const char* none = nullptr; slot.compare_exchange_strong(none, path)) return;
}

void keep_when_stopped(const char* path) noexcept {
  for (auto& slot : to_remove)
    if (const char* same = path; slot.compare_exchange_strong(same, nullptr)) return;
}

}  // namespace foresight
