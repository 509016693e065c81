// Draws meshes and a Drawing into a picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "gl/program.hpp"
#include "gl/scene_buffers.hpp"
#include "rig_view/drawing.hpp"
#include "rig_view/eye.hpp"

namespace foresight {

/// Belongs to one context.
class DrawPass {
 public:
  /// `model` may be null: no meshes.
  explicit DrawPass(std::shared_ptr<const SceneModel> model);

  /// CV_8UC3, BGR, on a light ground, each pixel of four. One colour and pose for each node of the model; a node of
  /// opacity 0 is left out. Waits for the GPU.
  cv::Mat operator()(const Eye& eye, int width, int height, std::span<const Pose> T_world_node,
                     std::span<const Colour> colours, const Drawing& drawing);

 private:
  void fit(int width, int height);
  void draw_meshes(const Eye& eye, const Eigen::Matrix4f& clip, std::span<const Pose> T_world_node,
                   std::span<const Colour> colours) const;
  void draw_lines(const Drawing& drawing, const Eye& eye, const Eigen::Matrix4f& clip);
  void draw_glass(const Drawing& drawing, const Eigen::Matrix4f& clip);

  std::optional<gl::SceneBuffers> meshes_;
  gl::VertexArray mesh_array_, line_array_, glass_array_;
  gl::Program mesh_, line_, glass_;
  gl::Buffer lines_, corners_;
  gl::Texture colour_, depth_, small_;
  gl::Framebuffer target_, small_target_;
};

}  // namespace foresight
