// An operator's seat at a desktop: the window, its pictures and its words.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "display/eye_pair.hpp"
#include "display/uploaded_picture.hpp"
#include "display/view_loop.hpp"
#include "gl/glfw_window.hpp"
#include "seat/hud.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat_log.hpp"

namespace foresight {

/// What fills the window.
enum class SeatPicture : std::uint8_t { predicted, delayed, both };
const char* to_string(SeatPicture picture);

struct SeatWindowOptions {
  std::string title;
  std::vector<std::string> joints;  ///< names
  double font_scale = 1;
  SeatPicture picture = SeatPicture::predicted;
  std::vector<std::pair<std::string, std::string>> keys;
  /// Keys, mouse and focus since the last picture. The window's thread.
  std::function<void(const gl::WindowInput&)> input = {};
  std::function<std::vector<SeatLine>()> more_lines = {};  ///< of devices
  std::function<void(const std::string&)> log = {};        ///< of what changes
  std::optional<double> eyes_apart = {};                   ///< m: the view is shown to two eyes, side by side
};

/// Shows the robot as it will be; where that cannot be trusted, the newest image that came, and says so. Belongs to the
/// window's context.
class SeatWindow final : public ViewObserver {
 public:
  /// All must outlive this.
  SeatWindow(gl::Window& window, ViewSession& session, const Lens& lens, Seat& seat, PredictedSource& source,
             SeatWindowOptions options);

  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override;
  void waiting(FrameSource& source, ViewSession& session) override;
  bool wants_more() const override { return !window_.should_close(); }

  void next_picture();
  void toggle_help() { help_ = !help_; }
  /// The next picture goes into this file, too.
  void save_next(const std::filesystem::path& file) { save_ = file; }

  /// What there is to say now.
  HudContent words() const { return words(trusted()); }
  /// What is predicted may be shown.
  bool trusted() const;

 private:
  void present(const gl::Texture* predicted);
  void show_pictures(const ViewTarget& place, const gl::Texture* predicted, bool is_trusted) const;
  HudContent words(bool is_trusted) const;
  void log(const HudContent& content);
  void save(const ViewTarget& whole);

  gl::Window& window_;
  Seat& seat_;
  PredictedSource& source_;
  SeatWindowOptions options_;
  PictureCopy copy_;
  Hud hud_;
  SeatLog log_;
  UploadedPicture delayed_;
  std::optional<EyePair> eyes_;
  link::LineFramePtr uploaded_;
  bool help_ = true, drawn_ = false;
  std::optional<std::filesystem::path> save_;
};

}  // namespace foresight
