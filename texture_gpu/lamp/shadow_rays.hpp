// Whether something of a posed scene stands between two points.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

/// The meshes of a scene, ready to be met by rays (Embree). One thread.
class ShadowRays {
 public:
  /// Throws RuntimeFailure: no memory.
  explicit ShadowRays(const SceneModel& scene);
  ~ShadowRays();
  ShadowRays(const ShadowRays&) = delete;
  ShadowRays& operator=(const ShadowRays&) = delete;

  static constexpr int kPacket = 8;
  using Points = Eigen::Matrix<float, 3, kPacket, Eigen::RowMajor>;  ///< world, metres: a column each
  static constexpr double kGap = 2e-3;                               ///< metres
  static constexpr double kContact = 5e-3;  ///< metres: what touches a surface does not throw shadows on its points

  /// Some of the nodes, where they stand at one instant. Must not outlive the ShadowRays.
  class Posed {
   public:
    ~Posed();
    Posed(Posed&& other) noexcept;
    Posed& operator=(Posed&& other) noexcept;

    /// True where a triangle lies on the way, ends left out by `gap` metres. World.
    bool blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double gap = kGap) const;
    /// Likewise, a bit each of the first `count` ways: cheaper together, most where they lie close to each other.
    unsigned blocked(const Points& from, const Points& to, int count, double gap = kGap) const;
    /// Likewise, of the ways from each of `from` to one point, in packets as they follow each other.
    std::vector<bool> blocked(std::span<const Eigen::Vector3f> from, const Eigen::Vector3d& to,
                              double gap = kGap) const;

   private:
    friend class ShadowRays;
    explicit Posed(void* scene) : scene_(scene) {}
    void* scene_;
  };
  /// `nodes`: which of them, one for each node of the model.
  Posed pose(const std::vector<Pose>& T_world_node, const std::vector<bool>& nodes) const;

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace foresight
