// The running parts of a replay or an export: contexts, texture pipeline, predicted view.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "calibration/registration/rendered_view.hpp"
#include "display/comparison_window.hpp"
#include "display/predicted_view.hpp"
#include "display/thesis_view.hpp"
#include "display/view_range.hpp"
#include "gl/context.hpp"
#include "gl/glfw_window.hpp"
#include "scene/run_folder.hpp"
#include "texture_gpu/texture_thread.hpp"

namespace foresight {

/// Everything that is kept alive between images. One thread.
class ReplaySession {
 public:
  /// With `thesis`, that pipeline replaces the texture core; textures() and surface() do not exist then.
  ReplaySession(const RunFolder& run, const TextureOptions& options, const std::optional<thesis::Options>& thesis,
                bool window);

  const gl::DriverInfo& driver() const { return driver_; }
  /// Surfaces with a texture of their own: the core's charts, the thesis' polygons.
  std::size_t surface_count() const;
  const std::shared_ptr<const SurfacePatches>& surface() const { return surface_; }
  TextureThread& textures() { return *thread_; }

  /// Extracts one frame and returns when its textures are there.
  ExtractionReport process(PosedFrame frame);

  /// Reads the pixels of frame `index` of the run, with poses and scene, and with a margin for what registration.txt
  /// expects its pose to be off. Throws InputError.
  PosedFrame load(std::size_t index) const;

  /// The view at the pose of frame `index` with the newest textures, CV_8UC4 (BGRA); empty where
  /// the core has not published anything yet.
  cv::Mat predict(std::size_t index);

  /// The same from any pose.
  cv::Mat predict(const Pose& T_world_camera, const SceneState& state);

  /// What a refinement aligns an image to; nothing where the core has not published anything yet.
  /// Not with `thesis`.
  std::optional<RenderedView> render(const Pose& T_world_camera, const SceneState& state);

  /// Shows the three pictures in the window, if there is one. False: the user closed it.
  bool show(const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual, const std::string& title);

  /// Leaves the window as it is for a while, or until the user closes it. Without one: returns at once.
  void linger(double seconds);

 private:
  const RunFolder& run_;
  double margin_px_;  // of exact poses
  std::unique_ptr<gl::Context> context_;
  gl::Window* window_ = nullptr;  // context_, where it is one
  gl::DriverInfo driver_;
  std::shared_ptr<const SurfacePatches> surface_;
  std::unique_ptr<PredictedView> view_;
  std::optional<ViewRange> range_;
  std::unique_ptr<ComparisonWindow> comparison_;
  std::unique_ptr<TextureThread> thread_;  // ends before the context it shares with
  std::unique_ptr<thesis::Pipeline> thesis_;
  std::unique_ptr<ThesisView> thesis_view_;
};

}  // namespace foresight
