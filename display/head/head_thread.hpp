// A head display in a thread and a context of its own: nothing that a window or a line waits for holds it up.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "display/head/head_display.hpp"
#include "gl/context.hpp"

namespace foresight::head {

/// Made and destroyed in the thread that made the first context of the share group.
class HeadThread {
 public:
  /// `context`: nobody else's. `painter` is called in the thread, `released` there at its end, the context current.
  /// All that is given by reference must outlive this.
  HeadThread(std::unique_ptr<gl::Context> context, const HeadDisplayOptions& options, Clock& clock,
             std::shared_ptr<HeldControllers> hands, HeadPainter& painter, std::function<void()> released);
  ~HeadThread();

  HeadStatus status() const;
  /// Ends it, in the runtime's order. False: the runtime has not let go within `most`, and may never: the program may
  /// only end at once now (std::_Exit), as its thread still uses all that it was given.
  bool stop(Duration most = std::chrono::seconds(3));

 private:
  void run();

  std::unique_ptr<gl::Context> context_;
  Clock& clock_;
  HeadDisplay display_;
  HeadPainter& painter_;
  std::function<void()> released_;
  std::shared_ptr<HeldControllers> hands_;
  mutable std::mutex mutex_;
  std::string failure_;  // of the painter: the display has ended
  std::atomic<bool> stop_{false}, ended_{false};
  std::thread thread_;
};

}  // namespace foresight::head
