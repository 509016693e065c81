// Who looks on from beside: the operator's view as a spotlight, the cameras' images as panels inside of the scene
// (thesis, chapter 7.3.1).
#pragma once

#include <span>
#include <vector>

#include "display/predicted_view.hpp"
#include "gl/camera_block.hpp"

namespace foresight {

/// An image that stands in the scene, before the camera that took it.
struct CameraPanel {
  Lens lens;  ///< of the camera; the picture may have another size
  Pose T_world_camera;
  const gl::Texture* picture = nullptr;  ///< RGBA8
};

/// The pinhole of an observer's view whose height spans as much as its distance times 1 / `focal` (rig_view/Eye).
Lens observer_lens(int width, int height, double focal);

/// Belongs to one context.
class ObserverPass {
 public:
  static constexpr std::size_t kMostPanels = 2;

  ObserverPass();
  /// Over the picture of `view`, just drawn from T_world_observer through an observer_lens(). `seen`: the operator's
  /// view, just drawn from T_world_operator. At most kMostPanels panels.
  void operator()(const PredictedView& view, const Pose& T_world_observer, const PredictedView& seen,
                  const Pose& T_world_operator, std::span<const CameraPanel> panels);

 private:
  enum class Wire : std::uint8_t { eye, camera };
  void add_pyramid(const Lens& observer, const Pose& T_observer_camera, const Lens& lens, double z, Wire kind);

  gl::Program program_;
  gl::Buffer observer_, others_;
  gl::BufferTexture wire_texels_;
  std::vector<Eigen::Vector4f> wires_;
};

}  // namespace foresight
