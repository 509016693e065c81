// Frames of a head display from views that were drawn a while ago: what each eye sees from where it is by now.
#pragma once

#include <memory>
#include <optional>

#include "display/head/scene_drawer.hpp"
#include "display/warp/depth_warp.hpp"
#include "display/warp/second_eye.hpp"

namespace foresight::head {

/// Where the right eye's frames come from.
enum class SecondEyeFrom {
  own_view,  ///< a view of its own, as the left one's
  first_eye  ///< the left eye's frame, row by row: cheaper, and less sharp behind edges; its own view where that tears
};

struct WarpCounts {
  std::uint64_t frames = 0;
  std::uint64_t of_first = 0;  ///< right eyes made of left ones
  std::uint64_t torn = 0;      ///< times that the left eye had not seen enough for that, or stood elsewhere
  std::uint64_t nothing = 0;   ///< eyes for which nothing was drawn yet
};

/// Shows what somebody draws. Belongs to the showing thread and its context.
class EyeWarper {
 public:
  /// More of a right eye's pixels that nobody has seen than this, and it gets a view of its own for a while.
  static constexpr double kMostTorn = 0.035;

  EyeWarper(DrawnViews& views, Clock& clock, SecondEyeFrom second = SecondEyeFrom::own_view);

  /// A frame begins: it is of the newest views, of nodes as in `state`.
  void begin(const SceneState& state);
  /// Left, then right. The eye's picture (DepthWarp::picture()), in its first `aim.width` columns, valid until the next
  /// call for it; null: nothing is drawn yet that it could be made of.
  const gl::Texture* operator()(std::size_t eye, const EyeAim& aim);
  /// All commands that read the pictures are given: waits until the GPU has finished them, and lets the drawing go on
  /// until the next frame, which is taken to come as long after the last one as this one did.
  void end();
  /// Before the next frame is asked for: DrawnViews::make_way().
  void make_way() { views_.make_way(); }

  const WarpCounts& counts() const { return counts_; }

 private:
  DepthWarp& warp_through(std::size_t eye, const Lens& lens, bool tells);
  const gl::Texture* warp(std::size_t eye, const Lens& lens, const EyeAim& aim);
  const gl::Texture* make_second(const EyeAim& aim);
  const gl::Texture* make_of_first(const Lens& lens, const EyeAim& aim, double apart);
  void tear();

  DrawnViews& views_;
  Clock& clock_;
  SecondEyeFrom from_;
  std::optional<RobotTime> began_;
  Duration interval_{};
  const DrawnEyes* newest_ = nullptr;
  HeadAim aim_;
  std::array<KeptLens, 2> lenses_;
  std::array<std::optional<DepthWarp>, 2> warps_;
  std::unique_ptr<SecondEye> second_;
  int own_frames_ = 0;  // that the right eye still has of its own view
  WarpCounts counts_;
};

}  // namespace foresight::head
