// An operator's seat at a desktop: the window, its pictures and its words.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/clock.hpp"
#include "display/frame_pacer.hpp"
#include "display/view_loop.hpp"
#include "display/view_window.hpp"
#include "gl/glfw_window.hpp"
#include "seat/hand_overlay.hpp"
#include "seat/hud.hpp"
#include "seat/predicted_source.hpp"
#include "seat/screenshot.hpp"
#include "seat/seat_log.hpp"
#include "seat/seat_views.hpp"
#include "seat/stage_times.hpp"
#include "seat/view_trust.hpp"

namespace foresight {

struct SeatWindowOptions {
  std::string title;
  std::vector<std::string> joints;  ///< names
  double font_scale = 1;
  ViewTrust* trust = nullptr;  ///< outlives the window; null: only what cannot be predicted gives way
  SeatViewsSetup views;
  std::vector<std::pair<std::string, std::string>> keys;
  /// Is told when a picture is drawn and when swapped; outlives the window. Null: nobody.
  FramePacer* pacer = nullptr;
  /// Keys, mouse and focus since the last picture. The window's thread.
  std::function<void(const gl::WindowInput&)> input = {};
  std::function<std::vector<SeatLine>()> more_lines = {};    ///< of devices
  std::function<void(const std::string&)> log = {};          ///< of what changes
  std::function<HandPicture()> hand = {};                    ///< drawn over the robot as it will be
  std::function<std::optional<Duration>()> input_took = {};  ///< StageTimes::to_set_point
};

/// Shows the robot as it will be; where that cannot be trusted, the newest image that came, and says so. Belongs to the
/// window's context.
class SeatWindow final : public ViewObserver {
 public:
  /// All must outlive this.
  SeatWindow(gl::Window& window, Seat& seat, PredictedSource& source, SeatWindowOptions options);

  void arrived(const PosedFrame& frame) override;
  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override;
  void waiting(FrameSource& source, ViewSession& session) override;
  bool wants_more() const override { return !window_.should_close(); }

  /// What the operator has done by now, before a picture is drawn.
  void take_input();
  SeatViews& views() { return views_; }
  /// SeatViews::warm_up(), where a picture has been drawn; between pictures.
  bool warm_up(ViewSession& session) { return views_.warm_up(session, window_target(window_)); }
  /// keys_after(); after none of them, only the lines that are not well, too.
  void next_words();
  void next_marks();
  /// The next picture goes into a file, too: ScreenshotWriter, in the working folder.
  void save_next() { save_ = true; }
  /// Waits for those that are not written yet, and tells what became of them. Where nobody drives any more.
  void finish_saving();

  /// What there is to say now.
  HudContent words() const { return words(trusted()); }
  /// What is predicted may be shown.
  bool trusted() const;

 private:
  TrustMarks marks_to_draw() const;
  void present(const ViewSession& session);
  void swap();
  HudContent words(bool is_trusted) const;
  void log(const HudContent& content);
  void save(const ViewTarget& whole);
  void tell_saved();
  StageTimes stage_times() const;

  gl::Window& window_;
  Seat& seat_;
  PredictedSource& source_;
  SeatWindowOptions options_;
  SeatViews views_;
  Hud hud_;
  SeatLog log_;
  MonotonicClock clock_;
  ImageWay image_way_;
  std::optional<Duration> to_textures_;
  std::vector<StageCost> image_costs_;
  link::LineFramePtr uploaded_;
  std::optional<std::size_t> first_key_;  // that is shown; nothing: none are
  bool few_lines_ = false;
  TrustMarks marks_ = TrustMarks::none;
  bool save_ = false;
  ScreenshotWriter screenshots_{""};
  std::string save_trouble_;  // of the last one
};

}  // namespace foresight
