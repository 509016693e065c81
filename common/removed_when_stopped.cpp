#include "common/removed_when_stopped.hpp"

#include <utility>

#include "common/stop_signal.hpp"

namespace foresight {

RemovedWhenStopped::RemovedWhenStopped(std::filesystem::path path) : path_(std::move(path)) {
  remove_when_stopped(path_.c_str());
}

RemovedWhenStopped::~RemovedWhenStopped() {
  keep_when_stopped(path_.c_str());
}

StopSignalsHeld::StopSignalsHeld() {
  sigset_t held;
  ::sigemptyset(&held);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&held, signal);
  ::pthread_sigmask(SIG_BLOCK, &held, &before_);
}

StopSignalsHeld::~StopSignalsHeld() {
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace foresight
