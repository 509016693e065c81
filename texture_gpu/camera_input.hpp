// Everything the extraction keeps for one camera on the GPU: its image and its view of the model.
#pragma once

#include <array>
#include <memory>

#include "gl/camera_block.hpp"
#include "gl/raster_pass.hpp"
#include "scene/posed_frame.hpp"

namespace foresight {

/// One context. A ring of mapped buffers carries images to the GPU, so that the next one can be
/// written while the last is still being read.
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
  const gl::FaceImages& faces() const { return faces_; }
  const gl::Texture& image() const { return image_; }
  const gl::Texture& rays() const { return camera_->rays; }    ///< gl::make_lens_rays
  const gl::Buffer& block() const { return camera_->block; }   ///< gl::CameraBlock
  const gl::Texture& blocks() const { return blocks_; }        ///< RG32F: 1/z of each 4x4 block (blocks.comp)
  const gl::Texture& uncertain() const { return uncertain_; }  ///< R8: 1 on the far side of an edge (uncertain.comp)

 private:
  struct Staging {
    gl::Handle<gl::delete_buffer> buffer;
    void* memory = nullptr;
    gl::Fence read;  // passed when the GPU has fetched it
  };
  /// What all images of a camera have in common.
  struct Camera {
    explicit Camera(const Lens& lens, const gl::Faces& faces);
    ~Camera();
    Lens lens;
    gl::Texture rays;
    gl::Buffer block;
    std::array<Staging, 3> ring;
    std::size_t next = 0;
  };
  CameraInput(std::shared_ptr<Camera> camera, const gl::Faces& faces);

  std::shared_ptr<Camera> camera_;
  gl::FaceImages faces_;
  gl::Texture image_, blocks_, uncertain_;
  mutable bool has_levels_ = false;  // of the image that is there
};

}  // namespace foresight
