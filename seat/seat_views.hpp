// What fills an operator's window: one eye or two, newest image or prediction, or both; or all from beside.
//
//   session's view (camera's pixels; images are compared with it) --.
//   larger or painted view of the same eye -------------------------+--> mode --> window, lines of the hand over it
//   two eyes; stereogram; from beside ------------------------------+
//   newest images --------------------------------------------------'
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "display/bent_image.hpp"
#include "display/doubt_paint.hpp"
#include "display/eye_pair.hpp"
#include "display/frame_source.hpp"
#include "display/picture_mix.hpp"
#include "display/scene_overlay.hpp"
#include "display/stereogram/live_stereogram.hpp"
#include "display/uploaded_picture.hpp"
#include "display/view_modes.hpp"
#include "gl/glfw_window.hpp"
#include "seat/hand_overlay.hpp"
#include "seat/hud.hpp"
#include "seat/observer_view.hpp"

namespace foresight {

struct SeatViewsSetup {
  Lens left;                       ///< of the cameras
  std::optional<Lens> right = {};  ///< nothing: as the left one
  double eyes_apart = 0.063;       ///< m, of most people
  double most_drawing_ms = 20;     ///< ViewSize
  double few_pixels = ViewSize::kFewPixels;
  ViewMode mode = ViewMode::predicted;
  /// Of a head display that takes two eyes side by side, left and right: what is predicted is drawn such that its
  /// optics show it straight. Nothing: it has none, or does that itself.
  std::optional<std::array<Lens, 2>> panels = {};
};

/// What there is to be shown of a picture.
struct SeatPicture {
  bool trusted = true;                  ///< else the newest image stands in for the prediction
  const gl::Texture* marked = nullptr;  ///< the session's view with marks on it; null: no marks are wanted
  const gl::Texture* doubt = nullptr;   ///< of the session's view; null: not known
  const KindRisks* risks = nullptr;     ///< of pixels of each doubt; null: not known
  const HandPicture* hand = nullptr;    ///< drawn over what is predicted; null: nothing
  int window_top = 0;                   ///< row of the screen that the window's first one is
};

/// The upper right corner of `place` in which a picture of `width` x `height` px stands beside a view: a quarter of the
/// width, or half of the height where that is less.
ViewTarget inset_place(const ViewTarget& place, int width, int height);

/// Of rows in turn, the left eye has the even ones of the screen, wherever the window is and the picture in it. The
/// picture `part` of `whole`, a window whose first row is the screen's `window_top`: its first row is an odd one there.
bool begins_at_odd_row(int window_top, const ViewTarget& whole, const ViewTarget& part);

/// Belongs to the session's context, but for mouse and keys, which need none. These choose what is seen and never move
/// the robot: what the views take of the mouse, the hand does not get, until all buttons are let go of.
class SeatViews {
 public:
  explicit SeatViews(const SeatViewsSetup& setup);

  ViewMode mode() const { return mode_; }
  ViewPaint paint() const { return paint_; }
  void set_mode(ViewMode mode) { mode_ = mode; }
  void next_main();    ///< prediction, newest image, both, split
  void next_stereo();  ///< two eyes, interlaced, the anaglyphs, one eye
  void toggle_observer();
  void toggle_stereogram();
  StereogramLook& stereogram() { return stereogram_look_; }
  void next_paint();
  void swap_eyes() { eyes_swapped_ = !eyes_swapped_; }
  /// What is shown, and what colours mean. `trusted`: the prediction.
  std::string words(bool trusted) const;
  /// ViewSize::scale() of what is drawn.
  double scale() const { return size_.scale(); }
  /// SeatPicture::doubt would be seen.
  bool shows_doubt() const { return is_one_eyes() && paint_ == ViewPaint::doubt; }
  /// SeatPicture::marked would be seen.
  bool shows_marks() const { return is_one_eyes() && paint_ == ViewPaint::colours; }

  /// Takes what is meant for the views out of `input`. `whole`: the window.
  void take_mouse(gl::WindowInput& input, const ViewTarget& whole);
  /// From where keys mean left and forward as they are seen: the operator's camera, or who looks on from beside.
  Pose looks_from(const Pose& T_world_operator) const;

  /// A frame has come: its poses and images, for panels in the scene.
  void arrived(const PosedFrame& frame) { beside_.arrived(frame); }
  /// The newest images that have come, CV_8UC3; the second may be empty.
  void upload_newest(const cv::Mat& left, const cv::Mat& right);
  /// The session has drawn the view of `place`: draws what the mode needs besides. `drawing_ms`: what all drawing
  /// took for the last picture; 0: not known.
  void draw(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, double drawing_ms);
  /// Once something is drawn: draws, where the next picture will cover it, one of the looks that were never chosen, so
  /// that its first choice does not wait for programs to be compiled; on a software renderer some tenths of a second.
  /// False: none is left.
  bool warm_up(ViewSession& session, const ViewTarget& whole);

  /// Where pictures were put: each such part has words of its own.
  struct Part {
    ViewTarget place;
    std::vector<HudLabel> labels = {};       ///< px from its top left
    std::optional<HudArea> words_area = {};  ///< all but labels, at one place in space for both eyes; nothing: anywhere
    std::optional<HudRows> compared = {};    ///< pictures side by side that words are to leave clear; px from its top
  };
  std::vector<Part> show(const ViewSession& session, const ViewTarget& whole, const SeatPicture& what);

 private:
  /// A picture of one eye.
  struct Sight {
    const gl::Texture* picture = nullptr;   // null: there is none yet
    const gl::FaceImages* faces = nullptr;  // of the drawing; null: an image
    const Lens* lens = nullptr;             // of the drawing
    Pose T_world_eye = Pose::Identity();
  };
  struct Canvas {
    gl::Texture picture;
    std::optional<TextureTarget> target;
  };
  bool is_one_eyes() const { return mode_ != ViewMode::newest && mode_ <= ViewMode::split; }
  bool shows_panels() const { return mode_ == ViewMode::two_eyes && setup_.panels; }
  /// As views paint themselves.
  ViewPaint paint_of_views() const { return paint_ == ViewPaint::doubt ? ViewPaint::colours : paint_; }
  std::array<Lens, 2> eye_lenses(const ViewTarget& whole) const;
  void draw_eyes(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, double drawing_ms);
  void draw_again(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, double drawing_ms);
  ViewMode mode_now(bool trusted) const;
  Sight predicted(const ViewSession& session, const SeatPicture& what);
  Sight newest(std::size_t eye) const;
  Sight newest_on_panel(std::size_t eye, const Lens& panel);
  Sight eye(std::size_t index, bool trusted, const ViewTarget& whole);
  void show_two_eyes(const ViewTarget& whole, const ViewTarget& place, const SeatPicture& what,
                     std::vector<Part>& parts);
  void put(const Sight& sight, const ViewTarget& place, const SeatPicture& what, std::vector<HudLabel>& labels,
           const ViewTarget& whole);
  void put_mixed(const Sight& first, const Sight& second, const ViewTarget& place, const ViewTarget& whole,
                 PictureMix::Way way, const SeatPicture& what, std::vector<HudLabel>& labels);
  void put_inset(const ViewTarget& place) const;
  const ViewTarget& canvas(std::size_t index, const ViewTarget& place);

  SeatViewsSetup setup_;
  ViewMode mode_;
  ViewPaint paint_ = ViewPaint::colours;
  bool eyes_swapped_ = false;
  ViewSize size_;
  SplitBorder border_;
  bool keeps_mouse_ = false;
  PictureCopy copy_;
  PictureMix mix_;
  std::optional<DoubtPaint> doubt_;
  SceneOverlay overlay_;
  std::array<Canvas, 2> canvas_;
  std::optional<PredictedView> again_;
  ObserverView beside_;
  bool shows_again_ = false, has_eyes_ = false, has_beside_ = false,
       has_stereogram_ = false;           // drawn for the last place
  std::optional<EyePair> eyes_, panels_;  // through the camera's lens; through those of panels
  StereogramLook stereogram_look_;
  std::optional<LiveStereogram> stereogram_;
  std::optional<ViewPlace> drawn_;  // the operator's
  std::size_t warm_ = 0;            // looks that were drawn to have their programs
  std::array<UploadedPicture, 2> newest_;
  std::array<std::array<std::optional<BentImage>, 2>, 2> bent_;  // for a panel, of a camera
};

}  // namespace foresight
