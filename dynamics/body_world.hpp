// Rigid bodies that stand still, are driven, or are loose: those fall, slide, roll, are pushed and held by friction.
//
// Bullet's bodies and solver (https://pybullet.org, version 3.24) behind plain values. Fixed steps, one thread, no
// randomness: the same calls give the same motion, bit for bit. Metres, kilograms, seconds, newtons; world frame.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct Surface {
  double friction = 0.5;     ///< >= 0; of two that touch, the product counts
  double rolling = 0;        ///< m, >= 0: lever of the force that keeps a ball from rolling on
  double restitution = 0.1;  ///< 0 .. 1; likewise the product
  /// N/m at each point of touch, of driven bodies; 0: as hard as the solver can. A soft one tells by how deep it is
  /// touched how hard it presses.
  double stiffness = 0, damping = 0;
};

struct Motion {
  Pose T_world_body = Pose::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the body's origin, m/s
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();   ///< rad/s
};

/// Two bodies that touch at a point, as the last step found it.
struct Touch {
  std::size_t body = 0, other = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from `other` towards `body`
  double force = 0;                                  ///< N along `normal`, that presses them; >= 0
};

struct BodyWorldOptions {
  double step = 0.002;    ///< s; 0.001 .. 0.02
  int iterations = 50;    ///< of the solver, each step
  double gravity = 9.81;  ///< m/s^2, downwards (-z)
};

/// Bodies are numbered in the order in which they are added. One thread.
class BodyWorld {
 public:
  /// Throws InputError: an option out of range.
  explicit BodyWorld(const BodyWorldOptions& options);
  ~BodyWorld();
  BodyWorld(const BodyWorld&) = delete;
  BodyWorld& operator=(const BodyWorld&) = delete;

  // Meshes without triangles make bodies that touch nothing.
  std::size_t add_still(const Mesh& mesh, const Pose& T_world_body, const Surface& surface);
  /// Goes where place() says, whatever is in its way; touches loose bodies only.
  std::size_t add_driven(const Mesh& mesh, const Pose& T_world_body, const Surface& surface);
  /// `mass` > 0.
  std::size_t add_loose(const Mesh& mesh, const Pose& T_world_body, double mass, const Surface& surface);
  /// All below this height is solid.
  std::size_t add_floor(double z, const Surface& surface);

  /// Where a driven body is at the end of the next step.
  void place(std::size_t driven, const Pose& T_world_body);
  /// Puts any body there at once.
  void put(std::size_t body, const Motion& motion);
  /// Puts a loose body there to rest: even without support it stays until something that moves touches it.
  void rest(std::size_t loose, const Pose& T_world_body);
  /// One that is not present touches nothing and stays where it is.
  void set_present(std::size_t body, bool present);
  /// From now on a loose body is driven, or a body that was made loose again falls with the velocity it has.
  void hold(std::size_t loose, bool held);

  /// Moves time on by one step. A body whose motion is not finite, or that is farther than 100 m away, goes back to
  /// where it was added, at rest.
  void step();

  std::size_t size() const;
  Motion motion(std::size_t body) const;
  /// Everything that touched in the last step, in an order that is the same for the same calls.
  const std::vector<Touch>& touches() const;
  double seconds_per_step() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace foresight
