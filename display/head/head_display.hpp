// A head display by OpenXR: opened when it is there, lost and found again, a frame at a time.
//
// The operator's window goes on whatever happens here, and so does the robot's safety: a headset that goes away takes
// its controllers with it, whose switches then count as open.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/clock.hpp"
#include "display/head/head_hands.hpp"
#include "display/head/head_painter.hpp"
#include "input/tracker.hpp"

namespace foresight::head {

struct HeadDisplayOptions {
  bool stage = false;  ///< the room's floor is the origin, where the runtime knows it
  double scale = 1;    ///< of the pixels that the runtime recommends, per axis; 0.1 .. 2
  Duration try_again = std::chrono::seconds(2);
};

/// What there is to say of it.
struct HeadStatus {
  bool shown = false;    ///< somebody sees what is drawn
  bool focused = false;  ///< and has the controllers
  bool ended = false;    ///< closed in the runtime's menu, or by finish(): it is not opened again
  std::string runtime, headset;
  std::string trouble;  ///< what keeps it from showing, or ""
  std::string cure;
  std::uint64_t frames = 0;        ///< of all sessions
  std::uint64_t drawn = 0;         ///< of these, with eyes in them
  std::uint64_t without_pose = 0;  ///< in which nobody knew where the head is
  std::uint64_t time_jumps = 0;
  int losses = 0;      ///< of a headset or a runtime that was there
  double rate_hz = 0;  ///< of the display
  std::optional<OperatorTime> last_frame;
};

/// What somebody who shows it says of it: has it stood still for `most` by now?
bool stands_still(const HeadStatus& status, OperatorTime now, Duration most = std::chrono::milliseconds(500));

/// One thread, in which a context is current that nobody else uses; status() from any.
class HeadDisplay {
 public:
  HeadDisplay(const HeadDisplayOptions& options, const Clock& clock, std::shared_ptr<HeldControllers> hands);
  ~HeadDisplay();
  HeadDisplay(const HeadDisplay&) = delete;
  HeadDisplay& operator=(const HeadDisplay&) = delete;

  /// One round. True: a frame was shown, which took as long as the runtime paced it. False: there was nothing to do;
  /// ask again in some 20 ms. Does not throw for what runtime and headset do; throws what `painter` does.
  bool step(HeadPainter& painter);
  /// Leaves the runtime in its own order, a second at most; then nothing is opened any more.
  void finish();

  HeadStatus status() const;

 private:
  struct Open;
  bool open();
  void poll();
  void take_event(const void* event);
  void close(const std::string& trouble, const std::string& cure, bool lost);
  void count();
  void note(const std::string& trouble, const std::string& cure);

  HeadDisplayOptions options_;
  const Clock& clock_;
  std::shared_ptr<HeldControllers> hands_;
  std::unique_ptr<Open> open_;
  std::optional<RobotTime> next_try_;
  bool over_ = false;
  HeadStatus counted_;  // of sessions that have ended
  mutable std::mutex mutex_;
  HeadStatus status_;
};

}  // namespace foresight::head
