// Things on the table as they will be: the hand that is shown takes them along (prediction/grasp).
//
// Images show things where they were then: what was shown for each instant is remembered, so that textures go onto a
// thing where it was when its image was taken.
#pragma once

#include <deque>
#include <memory>

#include "prediction/grasp/thing_future.hpp"
#include "prediction/robot_future.hpp"
#include "rig/rig.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// One thread.
class ThingsOutlook {
 public:
  /// `things`: what is loose, of the scene's nodes; those that it lacks are left out. `rig` must outlive this.
  ThingsOutlook(const Rig& rig, std::shared_ptr<const LiveScene> scene, std::vector<KnownThing> things);

  /// The robot will be there at that instant, later than the one before; often, at least twenty times a second. An
  /// invalid one moves nothing. The first says where everything begins.
  void advance(const PredictedRobot& robot);
  /// Puts things where they are at the state's instant, as far as it is remembered.
  void place(SceneState& state) const;
  /// Null before the first advance().
  const ThingFuture* future() const { return future_.get(); }

 private:
  static constexpr double kRemembered = 6;  // s
  struct Moment {
    RobotTime time;
    std::vector<Pose> T_world_thing;
  };

  const Rig& rig_;
  std::shared_ptr<const LiveScene> scene_;
  ThingFutureOptions options_;
  std::vector<std::size_t> nodes_;  // of the model, per thing
  std::unique_ptr<ThingFuture> future_;
  std::deque<Moment> past_;
};

/// What is loose in the mock lab with physics, as a careful owner would describe it.
std::vector<KnownThing> mock_things();

}  // namespace foresight
