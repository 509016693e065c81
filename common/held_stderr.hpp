// Keeps the terminal to ourselves while a library is called that writes what it thinks straight to the error stream,
// without a handler that could be replaced: OpenXR's loader, libcamera.
#pragma once

#include <mutex>
#include <string>

namespace foresight {

/// While it lives, what the process writes to its error stream is kept instead of shown. For moments: words of other
/// threads are kept, too. Any thread; a second one waits.
class HeldStderr {
 public:
  HeldStderr();
  ~HeldStderr();
  HeldStderr(const HeldStderr&) = delete;
  HeldStderr& operator=(const HeldStderr&) = delete;

  /// What was written so far, at most 4096 bytes of it.
  std::string text() const;

 private:
  std::unique_lock<std::mutex> lock_;
  int terminal_ = -1, kept_ = -1;  // -1: could not be opened, and nothing is held
};

}  // namespace foresight
