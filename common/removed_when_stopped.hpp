// What is not to be left behind by a program that a stop signal ends at once.
#pragma once

#include <csignal>
#include <filesystem>

namespace foresight {

/// A file, or an empty folder, that such a signal removes while this lives. Any thread.
class RemovedWhenStopped {
 public:
  explicit RemovedWhenStopped(std::filesystem::path path);
  ~RemovedWhenStopped();
  RemovedWhenStopped(const RemovedWhenStopped&) = delete;
  RemovedWhenStopped& operator=(const RemovedWhenStopped&) = delete;

 private:
  std::filesystem::path path_;
};

/// While it lives, stop signals to its thread wait: in a program of one thread, until what is being made can be
/// removed.
class StopSignalsHeld {
 public:
  StopSignalsHeld();
  ~StopSignalsHeld();
  StopSignalsHeld(const StopSignalsHeld&) = delete;
  StopSignalsHeld& operator=(const StopSignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace foresight
