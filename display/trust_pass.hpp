// Which pixels of a drawn view a camera has confirmed, and what kind of doubt there is about them.
//
// Nothing is known of a pixel whose surface point no image of late saw, or that something covered in the newest one:
// what moves on may leave a shadow, or have pushed it. Of others, a byte tells contrast, how far the surface may be
// from where it is drawn, and how it was shown when images could be compared of late (doubt_kinds.hpp).
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "display/doubt_kinds.hpp"
#include "display/predicted_view.hpp"
#include "scene/posed_frame.hpp"

namespace foresight {

/// Belongs to one context: that of the view.
class TrustPass {
 public:
  /// `lens`: of the images, and of views, which may have another number of pixels. `view`: as large as it is.
  TrustPass(std::shared_ptr<const gl::SceneBuffers> scene, std::shared_ptr<const SurfaceRecords> surface,
            const Lens& lens, const PredictedView& view);

  /// An image came, later than the one before: where its camera and all nodes were.
  void saw(const PosedImage& image);
  /// How what was shown for this image's instant agreed with it: CV_8UC1 of the lens's size, as doubt_kinds.hpp says.
  /// Later than the one before, else those are forgotten.
  void compared(const PosedImage& image, const cv::Mat& comparison);
  /// What was wrong in patches so far has a reason that is no more.
  void forget_patches() { with_patches_ = 0; }

  /// Fills doubt() and marked() for the view that was drawn last. `node_px`: by how many pixels each node of `state`
  /// may be elsewhere (one standard deviation; kAnywherePx: anywhere). `exact`: what is not hatched. Does not wait for
  /// the GPU.
  void operator()(const PredictedView& view, const Pose& T_world_camera, const SceneState& state,
                  std::span<const double> node_px, const ExactKinds& exact);

  /// R8 (DoubtKind, or kUnconfirmed), as large as the view, row 0 at the top.
  const gl::Texture& doubt() const { return doubt_; }
  /// The view, RGBA8, with what is not exact hatched.
  const gl::Texture& marked() const { return marked_; }

 private:
  static constexpr std::size_t kFrames = 12;
  struct Seen {
    RobotTime time;
    Pose T_world_camera;
    SceneState scene;
    int layer = 0;  // of depths_: the first
  };
  void fit(const PredictedView& view);
  void forget_one();
  void list_ways(const Pose& T_world_camera, const SceneState& state);

  Lens lens_;
  std::shared_ptr<const SurfaceRecords> surface_;
  gl::RasterPass raster_;
  gl::FaceImages scratch_;
  gl::Texture depths_;  // the faces of each image that is remembered
  gl::Program program_;
  gl::Buffer camera_, view_;  // of images, of the view
  gl::BufferTexture node_px_, ways_;
  gl::Texture losses_;  // of each image that is remembered, what coding took away: layers as of depths_, one an image
  gl::Texture comparisons_, doubt_, marked_;
  std::vector<Seen> seen_;        // newest first
  std::vector<Seen> compared_;    // newest first, at most kComparisonsKept
  std::size_t with_patches_ = 0;  // of compared_, that many of the newest
  std::vector<Eigen::Vector4f> rows_;
};

}  // namespace foresight
