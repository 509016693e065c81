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
#include "display/head/drawn_views.hpp"
#include "display/head/newest_slot.hpp"
#include "display/view_session.hpp"

namespace foresight::head {

/// The lens for what an eye is shown, made anew only where that has become another.
class KeptLens {
 public:
  template <typename Make>
  const Lens& operator()(const EyeAim& aim, Make make) {
    if (!lens_ || !same_sight(of_, aim)) lens_ = make(aim);
    of_ = aim;
    return *lens_;
  }

 private:
  EyeAim of_;
  std::optional<Lens> lens_;
};

struct DrawerOptions {
  /// What views hide near edges is drawn, too, so that a head that moves on finds few holes, where the views of both
  /// eyes took no longer than this: else they would come too rarely.
  Duration behind_edges_within = std::chrono::milliseconds(100);
  bool in_bands = true;  ///< between frames; else at once, for who draws in the showing thread or another process
  std::shared_ptr<FrameGate> others = nullptr;  ///< other work that goes on between frames (ViewSetup::gate)
};

/// Draws with a guard band, so that a head that turns on finds something to see. One drawing and one showing thread.
class SceneDrawer final : public DrawnViews {
 public:
  static constexpr double kGuard = 4 * EIGEN_PI / 180;  ///< rad on each side

  /// Both must outlive this. In any context of the session's share group.
  SceneDrawer(const ViewSession& session, Clock& clock, const DrawerOptions& options = {});

  // Showing thread.
  const std::shared_ptr<const WarpScene>& parts() const override { return parts_; }
  void frame_begins() override;
  void frame_ends(RobotTime next) override;
  void make_way() override;
  void aim(HeadAim aim) override;
  const DrawnEyes* newest() override { return slots_.newest(); }
  void shown() override { slots_.shown(); }

  /// Drawing thread, its context current: draws once, and waits for the GPU: newest() is that from then on. False:
  /// nobody has aimed since the last time, or there are no textures.
  bool draw();
  std::uint64_t drawn() const { return drawn_; }
  /// Drawing thread: lets go of all that belongs to its context, which is current for the last time.
  void release();

 private:
  struct Drawing {
    const HeadAim& aim;
    const TextureLease& textures;
    const ImagesLease& images;
  };
  void draw_front(std::size_t eye, const Drawing& drawing, DrawnEyes& into);
  void draw_behind(std::size_t eye, const Drawing& drawing, DrawnEyes& into);
  template <typename Work>
  void slice(const char* kind, Work work);
  void draw_layers(std::size_t eye, const Drawing& drawing, WarpLayers& into);

  const ViewSession& session_;
  Clock& clock_;
  DrawerOptions options_;
  FrameGate gate_;
  std::shared_ptr<const WarpScene> parts_;
  std::mutex mutex_;
  std::optional<HeadAim> aim_;
  std::array<KeptLens, 2> lenses_;
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
