// Both images of the live lab at one instant, as the mock cameras deliver them.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>

#include "drivers/camera/camera.hpp"
#include "gl/context.hpp"
#include "scene/stereo_lenses.hpp"
#include "sim/light_map.hpp"
#include "sim/live_lab.hpp"
#include "sim/live_view/live_view.hpp"

namespace foresight::sim {

/// Has an OpenGL context of its own: one thread makes, uses and destroys it. The same arguments give the same images.
class StereoRenderer {
 public:
  struct Instant {
    RobotTime time;  ///< CameraFrame::time and sequence of both images
    std::uint64_t number = 0;
  };
  static constexpr std::size_t kUnderWay = 2;  ///< pairs: one is drawn while the other is fetched

  /// `lenses`: of even width and one size. Draws a first pair that nobody sees, since drivers compile with it. Throws
  /// what OpenGL throws.
  StereoRenderer(const LiveLab& world, const LightMap& light, const LightMap::Irradiance& irradiance,
                 const StereoLenses& lenses, const Sensor& sensor);

  /// The light of another state, for the pairs that are drawn from now on.
  void light_anew(const LightMap& light, const LightMap::Irradiance& irradiance) {
    buffers_->light_anew(light, irradiance);
  }
  /// Starts a pair, of the parts, the world's prints and the left camera where they are given. `gain`: factor on the
  /// light. False, and nothing is done, where kUnderWay are.
  bool draw(const Pose& T_world_left, const LabState& T_world_part, std::span<const Pose> T_world_print, double gain,
            const Instant& instant);
  /// The oldest pair under way where it is finished or, with `wait`, when it is. Nothing: none, or not yet.
  std::optional<std::array<CameraFrame, 2>> take(bool wait);
  std::size_t under_way() const { return instants_.size(); }

 private:
  void fetch(std::size_t eye);

  std::unique_ptr<gl::Context> context_;
  std::shared_ptr<LabBuffers> buffers_;
  Pose T_left_right_;
  std::array<std::optional<LiveView>, 2> views_;
  std::deque<Instant> instants_;  // oldest first
  std::array<std::optional<CameraFrame>, 2> finished_;
};

}  // namespace foresight::sim
