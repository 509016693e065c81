// An operator's seat in a head display: the scene, the words, the newest image, and the controllers.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/operator/seat_window.hpp"
#include "display/head/head_thread.hpp"
#include "display/head/scene_painter.hpp"

namespace foresight {

/// The window's thread; the display has one of its own, and so has the drawing of what it shows. Whatever becomes of
/// the display, the window goes on.
class SeatHead final : public ViewObserver {
 public:
  /// All must outlive this. `controllers`: what they say goes there. `setup`: of the session.
  SeatHead(gl::Context& context, ViewSession& session, const ViewSetup& setup, PredictedSource& source,
           SeatWindow& window, std::shared_ptr<head::HeldControllers> controllers, head::SecondEyeFrom second,
           Clock& clock);
  ~SeatHead() override;

  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override;
  void waiting(FrameSource& source, ViewSession& session) override;

  /// Somebody sees the scene in it, and it does not stand still.
  bool shows() const;
  /// Where the operator's space lies in the world.
  std::optional<Pose> T_world_space() const { return painter_.T_world_space(); }
  void centre() { painter_.centre(); }
  std::vector<SeatLine> lines() const;
  /// head::HeadThread::stop().
  bool stop() { return thread_->stop(); }

 private:
  void renew();

  Clock& clock_;
  PredictedSource& source_;
  SeatWindow& window_;
  Hud hud_;
  gl::Texture hud_texture_;
  TextureTarget hud_target_;
  PictureCopy copy_;
  head::SharedPicture words_, image_;
  UploadedPicture newest_;
  link::LineFramePtr uploaded_;
  std::optional<OperatorTime> said_;
  head::SceneDrawer drawer_;
  head::ScenePainter painter_;
  head::SceneThread drawing_;
  std::unique_ptr<head::HeadThread> thread_;
};

}  // namespace foresight
