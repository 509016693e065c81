// From a source of frames to a drawn view, instant by instant, and whoever looks on.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "display/frame_source.hpp"
#include "display/view_session.hpp"

namespace foresight {

/// What happened at one instant.
struct ViewStep {
  ShownInstant instant;
  bool drawn = false;                          ///< ViewSession::picture() is the view of the instant
  double draw_cpu_ms = 0;                      ///< of all threads
  std::vector<ExtractionReport> reports = {};  ///< of frames that were finished since the step before, oldest first
  /// Of the last of the reports: from its frame's arrival to its textures.
  std::optional<double> arrival_to_publish_ms = {};
  /// From the arrival of the newest frame to the end of the drawing in which it is seen for the first time; only where
  /// a frame arrived, and not in real time. CPU: of all threads.
  std::optional<double> arrival_to_visible_ms = {}, arrival_to_visible_cpu_ms = {};
};

/// Looks on; called in the loop's thread, with the session's context current.
class ViewObserver {
 public:
  virtual ~ViewObserver() = default;
  virtual void arrived(const PosedFrame& /*frame*/) {}  ///< before it becomes textures
  virtual void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) = 0;
  virtual void waiting(FrameSource& /*source*/, ViewSession& /*session*/) {}  ///< for the next instant
  virtual bool wants_more() const { return true; }                            ///< false: the loop ends
};

/// One thread, the session's.
class ViewLoop {
 public:
  /// All must outlive this. `observers` are called in their order. `stopped`: asked often; true ends the loop.
  ViewLoop(ViewSession& session, FrameSource& source, std::vector<ViewObserver*> observers,
           std::function<bool()> stopped);

  /// The next instant: hands over the frames that have arrived and draws. What the source's advance() returned;
  /// `ended` also where somebody wants no more. Throws what the source and the session do.
  SourceState step();
  void run() {
    while (step() != SourceState::ended) {
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool done() const;
  struct Arrival {
    Clock::time_point time;
    double cpu_ms;
  };
  void feed(ViewStep& step);
  void follow(ViewStep& step);
  void submit(PosedFrame frame);
  std::optional<double> latency(const ExtractionReport& report);
  void draw(ViewStep& step);

  ViewSession& session_;
  FrameSource& source_;
  std::vector<ViewObserver*> observers_;
  std::function<bool()> stopped_;
  std::deque<std::pair<Clock::time_point, RobotTime>> submitted_;  // real time: when each frame came
  std::optional<Arrival> arrival_;                                 // not in real time: of a frame whose textures follow
};

}  // namespace foresight
