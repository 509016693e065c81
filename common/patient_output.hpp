// What a program says where it must not wait for who reads: a terminal stands (Ctrl-S), a line of ssh stalls, a pipe is
// full, and whoever serves the robot has more to do than to write.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "common/time.hpp"

namespace foresight {

/// Hands text to a file descriptor in a thread of its own. Any thread; nothing throws but the constructor, and only
/// finish() waits.
class PatientOutput {
 public:
  static constexpr std::size_t kRoom = 1000;  ///< lines that wait

  /// `fd` is not closed, and must stay open for the program's life: where its reader stands, the thread outlives this.
  explicit PatientOutput(int fd);
  /// finish(), for half a second at most.
  ~PatientOutput();
  PatientOutput(const PatientOutput&) = delete;
  PatientOutput& operator=(const PatientOutput&) = delete;

  /// All that is said is written, in its order. Beyond kRoom the oldest go, and the output says how many.
  void say(std::string text) noexcept;
  /// After what was said; of several that wait only the last.
  void show(std::string picture) noexcept;
  /// Waits until all is written. False: it is not, after `patience`.
  bool finish(Duration patience) noexcept;

 private:
  struct Shared;
  static void write_all(const std::shared_ptr<Shared>& shared) noexcept;

  std::shared_ptr<Shared> shared_;
  std::thread writer_;
};

/// Of the process, for programs that drive something. Whoever mixes them with stdio calls finish() between.
PatientOutput& patient_stdout();
PatientOutput& patient_stderr();

/// In the end, what was said on both is waited for, half a second each at most: the program's last words come after it.
/// In the beginning it starts their threads: later, they would inherit real-time priority, or write to what HeldStderr
/// has put in the terminal's place.
struct WaitsForReaders {
  WaitsForReaders();
  WaitsForReaders(const WaitsForReaders&) = delete;
  WaitsForReaders& operator=(const WaitsForReaders&) = delete;
  ~WaitsForReaders();
};

}  // namespace foresight
