// What an operator sees in a head display: the scene around the place of the robot's camera, words, the newest image.
//
//            .----------.        the newest image, where the head looked when it was centred: to its upper right;
//   scene    |  image   |        in the middle, and large, where the scene cannot be trusted
//            '----------'
//      [ words ]                 go with the head, below
#pragma once

#include <atomic>
#include <mutex>

#include "display/frame_source.hpp"
#include "display/head/eye_warper.hpp"
#include "display/head/head_hands.hpp"
#include "display/head/head_painter.hpp"
#include "display/head/shared_picture.hpp"

namespace foresight::head {

/// Where everything is to be shown.
struct HeadScene {
  ViewPlace place;      ///< of the camera, and of every node
  bool trusted = true;  ///< false: the newest image takes its place
};

/// The head starts where the robot's camera is, and looks where it looks; from there on it goes its own way, until it
/// is centred again. Painter's functions in the head display's thread, all others in any.
class ScenePainter final : public HeadPainter {
 public:
  /// All must outlive this. `drawer`: somebody else draws with it (SceneThread), and each frame is warped from there.
  /// `words` and `image`: panels; null: none. A press of `recentre` or `home_view` on `hands` centres.
  ScenePainter(SceneDrawer& drawer, const HeldControllers& hands, Clock& clock, SharedPicture* words,
               SharedPicture* image, SecondEyeFrom second = SecondEyeFrom::own_view);

  void show(HeadScene scene);
  /// The head is where the camera is now, from the next frame on.
  void centre() { centre_ = true; }
  /// Where the operator's space lies; nothing before the first frame.
  std::optional<Pose> T_world_space() const;

  void make_way() override;
  void look(const HeadFrame& frame) override;
  std::span<const Panel> panels() override { return panels_; }
  void draw_eye(std::size_t eye, const EyeView& view, const ViewTarget& target) override;
  void draw_panel(std::size_t panel, const ViewTarget& target) override;
  /// Lets go of all that belongs to the context, which is current for the last time.
  void release();

 private:
  bool centre_pressed();
  void place_space(const HeadFrame& frame);
  void place_panels();
  bool draw_scene(std::size_t eye, const EyeView& view, const ViewTarget& target);

  SceneDrawer& drawer_;
  const HeldControllers& hands_;
  Clock& clock_;
  SecondEyeFrom second_;
  std::array<SharedPicture*, 2> pictures_;  // image, words: what comes later is over what came before
  std::atomic<bool> centre_{false};
  mutable std::mutex mutex_;  // the next three
  HeadScene scene_;
  bool any_scene_ = false;
  std::optional<Pose> T_world_space_;
  HeadScene shown_;  // of the frame in work
  bool shows_scene_ = false;
  Pose T_space_centre_ = Pose::Identity();
  bool pressed_ = false;
  std::array<Panel, 2> panels_;
  std::optional<EyeWarper> warper_;  // these two in the head display's thread
  std::optional<PictureCopy> copy_;
};

}  // namespace foresight::head
