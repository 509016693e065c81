// What asks the program to stop: Ctrl-C (SIGINT), SIGTERM and SIGHUP, all handled alike. Signals are the whole
// process's, and so is what these functions change.
#pragma once

namespace foresight {

inline constexpr int kStopped = 130;  ///< exit code of a program that was asked to stop

/// From now on one of them says so on stderr, removes what remove_when_stopped() lists, and ends the program with the
/// exit code kStopped. A SIGHUP that somebody switched off (nohup) stays off.
void end_on_stop_signals();

enum class SecondSignal {
  ends,   ///< the program at once, as above: for work that may hang in a driver
  waits,  ///< as the first one does
};
/// From now on one of them only makes stop_requested() true (it begins false): for work that looks at it and ends
/// itself.
void poll_stop_signals(SecondSignal second = SecondSignal::ends);
bool stop_requested() noexcept;

/// "Ctrl-C", "SIGTERM", "SIGHUP"; "" before one came.
const char* stopped_by() noexcept;

/// A file, or an empty folder, that would be left behind. `path` must stay valid until keep_when_stopped(path). Any
/// thread; beyond 64 of them, and where the program dies otherwise, they are left.
void remove_when_stopped(const char* path) noexcept;
void keep_when_stopped(const char* path) noexcept;

}  // namespace foresight
