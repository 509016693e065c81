// Everything the extraction keeps for one camera on the GPU: its image and its view of the model.
#pragma once

#include <memory>
#include <vector>

#include "gl/camera_block.hpp"
#include "gl/raster_pass.hpp"
#include "scene/posed_frame.hpp"

namespace foresight {

/// One context. Mapped buffers carry images to the GPU, in turn, so that the next one can be written while the last is
/// still being read; there are as many of them as that takes.
class CameraInput {
 public:
  CameraInput(const Lens& lens, double largest_margin_px);
  CameraInput(const CameraInput&) = delete;
  CameraInput& operator=(const CameraInput&) = delete;

  /// A place for another image of the same camera. What does not depend on the image is shared: both are of one thread.
  std::shared_ptr<CameraInput> another() const;

  /// Starts the upload of `pixels`.
  void upload(const cv::Mat& pixels);

  /// Builds the coarser levels that textures of low resolution are sampled from.
  void build_levels() const;

  /// Of this image, what it shares with others left out.
  std::uint64_t bytes() const;

  const Lens& lens() const { return camera_->lens; }
  /// Its depth: of the image that was looked at last.
  const gl::FaceImages& faces() const { return camera_->faces; }
  const gl::Texture& image() const { return image_; }
  const gl::Texture& rays() const { return camera_->rays; }   ///< gl::make_lens_rays
  const gl::Buffer& block() const { return camera_->block; }  ///< gl::CameraBlock
  const gl::Texture& blocks() const { return blocks_; }       ///< RG32F: 1/z of each 4x4 block (blocks.comp)
  /// R32F: as the faces' depth, but negative on the far side of an edge (uncertain.comp).
  const gl::Texture& marked_depth() const { return marked_depth_; }

 private:
  struct Staging {
    explicit Staging(GLsizeiptr bytes);
    gl::Handle<gl::delete_buffer> buffer;
    void* memory = nullptr;
    gl::Fence read;  // passed when the GPU has fetched it
  };
  /// What all images of a camera have in common.
  struct Camera {
    explicit Camera(const Lens& lens, const gl::Faces& faces);
    ~Camera();
    Lens lens;
    gl::FaceImages faces;
    gl::Texture rays;
    gl::Buffer block;
    /// One that the GPU does not read any more.
    Staging& free_staging();
    std::vector<Staging> staging;  // the one that was used longest ago first
  };
  explicit CameraInput(std::shared_ptr<Camera> camera);

  std::shared_ptr<Camera> camera_;
  gl::Texture image_, blocks_, marked_depth_;
  mutable bool has_levels_ = false;  // of the image that is there
};

}  // namespace foresight
