// Views that one process draws and another one warps: on other processors, or another GPU, and in no danger from what
// may hang there.
//
//   drawing process: take_aim() --> SceneDrawer --> put()  ==> memory of both ==>  SharedViews --> EyeWarper: frames
//                        ^                                                              |
//                        '--------------------- where eyes and scene are <--------------'
//
// Pixels go through the CPU once on each side: a few ms a view, and nobody waits for the other.
#pragma once

#include <cstddef>
#include <optional>

#include "display/head/drawn_views.hpp"

namespace foresight::head {

struct ViewShareSize {
  std::size_t most_pixels = 0;  ///< of one eye's view, guard band included
  std::size_t nodes = 0;        ///< of the scene
};

/// Made before a process forks; then each side uses what is said to be its own, in one thread, its context current.
class ViewShare {
 public:
  /// Throws RuntimeFailure: no memory.
  explicit ViewShare(const ViewShareSize& size);
  ~ViewShare();
  ViewShare(const ViewShare&) = delete;
  ViewShare& operator=(const ViewShare&) = delete;

  // Drawing process.

  /// Where eyes and scene are, if that was told since the last call.
  std::optional<HeadAim> take_aim();
  /// Waits for the GPU. False: larger than what was asked for; it is not told.
  bool put(const DrawnEyes& eyes);
  /// What it does now, for messages of the other side. A string literal: both sides are the same program.
  void tell(const char* doing);

  // Showing process.

  /// Throws std::invalid_argument: another scene's, or the lens of a panel, which does not go over.
  void aim(const HeadAim& aim);
  /// What was put since the last call, copied into `out`: layers there are used again where they fit. False: nothing.
  bool take(DrawnEyes& out);

  const char* doing() const;

  // Either.

  /// So many views were put.
  std::uint64_t drawn() const;
  void end();
  bool ended() const;

 private:
  struct Head;
  struct Aim;
  struct Views;
  std::byte* aim_slot(std::size_t index) const;
  std::byte* view_slot(std::size_t index) const;
  std::byte* pixels(std::byte* slot, std::size_t layer) const;

  ViewShareSize size_;
  std::size_t bytes_ = 0;
  std::byte* memory_ = nullptr;
  Head* head_ = nullptr;  // in it
};

/// The showing process's views. Belongs to its showing thread and context.
class SharedViews final : public DrawnViews {
 public:
  /// `share` must outlive this.
  SharedViews(ViewShare& share, const SceneModel& scene);

  const std::shared_ptr<const WarpScene>& parts() const override { return parts_; }
  void frame_begins() override {}
  void frame_ends(RobotTime) override {}
  void make_way() override {}
  void aim(HeadAim aim) override { share_.aim(aim); }
  /// The GPU has finished all that reads the last ones (EyeWarper::end()).
  const DrawnEyes* newest() override;
  void shown() override {}

 private:
  ViewShare& share_;
  std::shared_ptr<const WarpScene> parts_;
  LayerCapture capture_;
  DrawnEyes eyes_;
  bool any_ = false;
};

}  // namespace foresight::head
