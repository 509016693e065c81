// A run's scene with textures of its images, for benches of the head display.
#pragma once

#include <opencv2/core.hpp>

#include "display/recorded_source.hpp"
#include "display/view_session.hpp"

namespace foresight {

/// Of a view's width, on each side of it: 2 degrees at a field of view of 60.
constexpr double kGuardShare = 0.08;

/// The lens of an eye as wide as the run's camera, without distortion, and `guard` px more on each side.
Lens bench_eye(const Lens& camera, int width, int height, int guard = 0);

/// Of a motion in axes x right, y up, as heads are recorded, to that of a camera, y down.
Pose in_camera_axes(const Pose& head);

/// Over all pixels and three channels.
double picture_decibels(const cv::Mat& a, const cv::Mat& b);

/// CPU time of `work` and of what it gave to the GPU, ms.
double gpu_cpu_ms(const std::function<void()>& work);

/// Textures of a run's first images. Belongs to the context, which is current.
class HeadLab {
 public:
  HeadLab(const RunFolder& run, gl::Context& context, Clock& clock);

  /// Extraction goes on between frames.
  const std::shared_ptr<FrameGate>& gate() const { return setup_.gate; }

  ViewSession& session() { return session_; }
  const Lens& camera() const { return setup_.left; }
  /// Of the last image that was taken in.
  const Pose& T_world_camera() const { return T_world_camera_; }
  const SceneState& state() const { return state_; }
  const std::vector<PosedFrame>& frames() const { return frames_; }

 private:
  ViewSetup setup_;
  ViewSession session_;
  std::vector<PosedFrame> frames_;
  Pose T_world_camera_ = Pose::Identity();
  SceneState state_;
};

}  // namespace foresight
