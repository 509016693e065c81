// What the frames of a head display are warped from: views of both eyes, drawn at a rate of their own.
//
//   drawing thread: aim --> both eyes' views, wider than the eyes see --> layers      5/s or more, where it can
//   display thread: newest layers, warped to where the eyes are by now --> a frame    whenever the runtime asks
#pragma once

#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "common/clock.hpp"
#include "display/head/eye_geometry.hpp"
#include "display/head/newest_slot.hpp"
#include "display/view_session.hpp"
#include "display/warp/warp_layers.hpp"

namespace foresight::head {

/// What an eye is shown.
struct EyeAim {
  Pose T_world_eye = Pose::Identity();  ///< of its camera (optical frame)
  EyeFov fov;
  int width = 0, height = 0;  ///< px
};

/// Where eyes and scene are, as the display knows them.
struct HeadAim {
  std::array<EyeAim, 2> eyes;  ///< left and right
  SceneState state;
  bool second_eye = true;  ///< false: the right one's frames are made of the left one's
};

/// A view drawn for each eye.
struct DrawnEyes {
  std::array<std::optional<WarpLayers>, 2> eyes;  ///< the second is empty where nobody asked for it
};

/// The same field of view, wider by `guard` rad on each side, up to 85 degrees from straight ahead.
EyeFov widened(const EyeFov& fov, double guard);

/// Draws with a guard band, so that a head that turns on finds something to see. One drawing and one showing thread.
class SceneDrawer {
 public:
  static constexpr double kGuard = 4 * EIGEN_PI / 180;  ///< rad on each side

  /// Both must outlive this. In any context of the session's share group.
  SceneDrawer(const ViewSession& session, Clock& clock);

  /// Drawing goes on between frames.
  FrameGate& gate() { return gate_; }

  const std::shared_ptr<const WarpScene>& parts() const { return parts_; }

  /// Showing thread: what is drawn next; the newest counts.
  void aim(HeadAim aim);
  /// Showing thread: the newest views that the GPU has finished, until the next call; null before the first.
  const DrawnEyes* newest() { return slots_.newest(); }
  /// Showing thread: has given all commands that read newest().
  void shown() { slots_.shown(); }

  /// Drawing thread, its context current: draws once, and waits for the GPU. False: nobody has aimed since the
  /// last time, or there are no textures.
  bool draw();
  std::uint64_t drawn() const { return drawn_; }
  /// Drawing thread: lets go of all that belongs to its context, which is current for the last time.
  void release();

 private:
  const ViewSession& session_;
  FrameGate gate_;
  std::shared_ptr<const WarpScene> parts_;
  std::mutex mutex_;
  std::optional<HeadAim> aim_;
  std::array<std::optional<PredictedView>, 2> views_;
  std::optional<LayerCapture> capture_;
  NewestSlot<DrawnEyes> slots_;
  std::atomic<std::uint64_t> drawn_{0};
};

/// Draws in a thread of its own: half of the time, so that the display gets the other half where both share processors;
/// more where it would else draw less than five times a second.
class SceneThread {
 public:
  /// `context`: nobody else's. Both others must outlive this.
  SceneThread(std::unique_ptr<gl::Context> context, SceneDrawer& drawer, Clock& clock);
  ~SceneThread();
  /// Nothing, or why it draws no more.
  std::string failure() const;

 private:
  void run();

  std::unique_ptr<gl::Context> context_;
  SceneDrawer& drawer_;
  Clock& clock_;
  mutable std::mutex mutex_;
  std::string failure_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace foresight::head
