// Which pixels of a drawn view a camera has confirmed, and how far the others may be off.
//
//   doubt 0 .. 254   grey levels that the pixel may be off by: the view's contrast there times the pixels by which the
//                    surface may be elsewhere, and the light on a part that has turned since it was seen
//   255              nothing is known: no image of late saw the point, something covered it in the newest one, or
//                    what was shown there was wrong when last an image could be compared
//
// Where doubt is at most a limit, which who compares views with images knows (seat/shown_fidelity.hpp), a pixel counts
// as exact.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "display/predicted_view.hpp"
#include "scene/posed_frame.hpp"

namespace foresight {

inline constexpr int kUnconfirmed = 255;  ///< doubt of what no camera has confirmed

/// Belongs to one context: that of the view.
class TrustPass {
 public:
  /// `view`: of `lens`, through which the images are taken too.
  TrustPass(std::shared_ptr<const gl::SceneBuffers> scene, std::shared_ptr<const SurfaceRecords> surface,
            const Lens& lens, const PredictedView& view);

  /// An image came, later than the one before: where its camera and all nodes were.
  void saw(const PosedImage& image);
  /// What was shown for the newest image's instant was wrong where this is not 0 (CV_8UC1 of the lens's size).
  void compared(const cv::Mat& wrong);

  /// Fills doubt() and marked() for the view that was drawn last. `node_px`: by how many pixels each node of `state`
  /// may be elsewhere (one standard deviation). `limit`: of doubt, in grey levels. Does not wait for the GPU.
  void operator()(const PredictedView& view, const Pose& T_world_camera, const SceneState& state,
                  std::span<const double> node_px, double limit);

  /// R8, row 0 at the top.
  const gl::Texture& doubt() const { return doubt_; }
  /// The view, RGBA8, with what is not exact hatched.
  const gl::Texture& marked() const { return marked_; }
  /// Images that are remembered, newest first.
  std::vector<RobotTime> remembered() const;

 private:
  static constexpr std::size_t kFrames = 12;
  struct Seen {
    RobotTime time;
    Pose T_world_camera;
    SceneState scene;
    int layer = 0;  // of depths_: the first
  };
  void forget_one();
  void list_ways(const Pose& T_world_camera, const SceneState& state);

  Lens lens_;
  std::shared_ptr<const SurfaceRecords> surface_;
  gl::RasterPass raster_;
  gl::FaceImages scratch_;
  gl::Texture depths_;  // the faces of each image that is remembered
  gl::Program program_;
  gl::Buffer camera_;
  gl::BufferTexture node_px_, ways_;
  gl::Texture rays_, wrong_, doubt_, marked_;
  std::vector<Seen> seen_;  // newest first
  std::optional<Seen> compared_;
  std::vector<Eigen::Vector4f> rows_;
};

}  // namespace foresight
