// A large scene that a recorded head goes through, drawn with levels and in full.
#pragma once

#include <opencv2/core.hpp>

#include "gl/level_pass.hpp"

namespace foresight {

/// A head in a scene, frame by frame.
struct HeadInScene {
  Pose T_world_camera = Pose::Identity();
  SceneState state;
  double seconds = 0;
};

/// What a frame looked like and took.
struct LevelFrame {
  cv::Mat picture;  ///< CV_8UC3
  double cpu_ms = 0;
};

/// Draws pictures of a scene without camera images: each surface point has a colour that is its own (waves of some
/// centimetres in the node's hue), brighter the more its triangle faces the eye, so that both a surface that lies
/// elsewhere and one that leans otherwise are seen. Belongs to the current context.
class LevelLab {
 public:
  /// `leaves_out`: of all drawing.
  LevelLab(const SceneModel& scene, std::shared_ptr<const SceneLevels> levels, const Lens& lens,
           gl::LeavesOut leaves_out);

  const std::shared_ptr<const SceneLevels>& levels() const { return levels_; }

  /// Plans, draws, and tells the director what that took.
  LevelFrame draw(const HeadInScene& head, LevelDirector& director);
  LevelFrame draw(const HeadInScene& head, const LevelPlan& plan);
  LevelFrame draw_in_full(const HeadInScene& head);
  /// Of the last frame: the darker a node, the finer its level in `plan` (CV_8UC3).
  cv::Mat levels_seen(const LevelPlan& plan) const;

 private:
  cv::Mat shaded(const HeadInScene& head) const;
  std::vector<GLuint> surfaces() const;

  std::shared_ptr<const SceneLevels> levels_;
  Lens lens_;
  std::vector<std::uint16_t> node_of_triangle_;
  std::shared_ptr<const gl::LevelBuffers> buffers_;
  gl::LevelPass pass_;
  gl::FaceImages faces_;
  LevelDirector in_full_;
};

/// The largest root mean square of differences over a block of 16 x 16 px, grey levels.
double largest_jump(const cv::Mat& a, const cv::Mat& b);

}  // namespace foresight
