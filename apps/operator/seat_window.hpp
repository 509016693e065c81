// An operator's seat at a desktop: the window, its pictures and its words.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "display/eye_pair.hpp"
#include "display/frame_pacer.hpp"
#include "display/scene_overlay.hpp"
#include "display/uploaded_picture.hpp"
#include "display/view_loop.hpp"
#include "gl/glfw_window.hpp"
#include "seat/hand_overlay.hpp"
#include "seat/hud.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat_log.hpp"
#include "seat/view_trust.hpp"

namespace foresight {

/// What fills the window.
enum class SeatPicture : std::uint8_t { predicted, delayed, both };
const char* to_string(SeatPicture picture);

struct SeatWindowOptions {
  std::string title;
  std::vector<std::string> joints;  ///< names
  double font_scale = 1;
  ViewTrust* trust = nullptr;  ///< outlives the window; null: only what cannot be predicted gives way
  SeatPicture picture = SeatPicture::predicted;
  std::vector<std::pair<std::string, std::string>> keys;
  /// Is told when a picture is drawn and when swapped; outlives the window. Null: nobody.
  FramePacer* pacer = nullptr;
  /// Keys, mouse and focus since the last picture. The window's thread.
  std::function<void(const gl::WindowInput&)> input = {};
  std::function<std::vector<SeatLine>()> more_lines = {};  ///< of devices
  std::function<void(const std::string&)> log = {};        ///< of what changes
  std::optional<double> eyes_apart = {};                   ///< m: the view is shown to two eyes, side by side
  std::function<HandPicture()> hand = {};                  ///< drawn over the robot as it will be
};

/// Shows the robot as it will be; where that cannot be trusted, the newest image that came, and says so. Belongs to the
/// window's context.
class SeatWindow final : public ViewObserver {
 public:
  /// All must outlive this.
  SeatWindow(gl::Window& window, ViewSession& session, const Lens& lens, Seat& seat, PredictedSource& source,
             SeatWindowOptions options);

  void arrived(const PosedFrame& frame) override;
  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override;
  void waiting(FrameSource& source, ViewSession& session) override;
  bool wants_more() const override { return !window_.should_close(); }

  /// What the operator has done by now, before a picture is drawn.
  void take_input();
  void next_picture();
  void toggle_help() { help_ = !help_; }
  void next_marks();
  /// The next picture goes into this file, too.
  void save_next(const std::filesystem::path& file) { save_ = file; }

  /// What there is to say now.
  HudContent words() const { return words(trusted()); }
  /// What is predicted may be shown.
  bool trusted() const;

 private:
  void present(const gl::Texture* predicted);
  void swap();
  struct DrawnView {
    const gl::Texture* picture = nullptr;  // null: none yet
    Pose T_world_camera = Pose::Identity();
    const gl::FaceImages* faces = nullptr;
  };
  DrawnView drawn_view(const gl::Texture* predicted, std::size_t eye) const;
  std::vector<HudLabel> show_pictures(const ViewTarget& place, const DrawnView& predicted, bool is_trusted);
  std::vector<HudLabel> show_predicted(const DrawnView& predicted, const ViewTarget& place);
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
  Lens lens_;
  SceneOverlay overlay_;
  Pose T_world_camera_ = Pose::Identity();  // of the picture that is shown
  const gl::FaceImages* faces_ = nullptr;   // likewise
  UploadedPicture delayed_;
  std::optional<EyePair> eyes_;
  link::LineFramePtr uploaded_;
  bool help_ = true, drawn_ = false;
  TrustMarks marks_ = TrustMarks::none;
  std::optional<std::filesystem::path> save_;
};

}  // namespace foresight
