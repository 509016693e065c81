// Things on the table as they will be: the hand that is shown takes them along (prediction/grasp), and images set right
// where they are (prediction/sighting).
//
// What rests stays where it is shown while images cannot tell that from where they found it: a print on it would wander
// to and fro with each image.
//
//   predicted robot --advance--> ThingFuture --place--> pictures: of now as shown, of the past as it is known by now
//   images ---saw---> ThingFinder --sightings--> ThingFuture
#pragma once

#include <future>
#include <memory>
#include <string>

#include "prediction/robot_future.hpp"
#include "prediction/sighting/thing_finder.hpp"
#include "rig/loose_things.hpp"
#include "rig/rig.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// What images said of the things so far.
struct ThingCounts {
  std::uint64_t looked = 0, skipped = 0;  ///< frames; those that came while one was being looked at
  std::uint64_t taken = 0, moved = 0, taken_back = 0, missing = 0;  ///< what became of sightings
};

/// One thread.
class ThingsOutlook {
 public:
  /// `things`: what is loose, of the scene's nodes; those that it lacks are left out. `in_background`: images are
  /// looked at in a thread, so that pictures do not wait; else at once, and all is repeatable. `rig` must outlive this.
  /// Throws what ThingFinder does.
  ThingsOutlook(const Rig& rig, std::shared_ptr<const LiveScene> scene, const std::vector<LooseThing>& things,
                bool in_background);

  /// The robot will be there at that instant, later than the one before; often, at least twenty times a second. An
  /// invalid one moves nothing. The first says where everything begins, and so does one that is kClockJump
  /// (seat/robot_outlook.hpp) before the last: the robot's clock is another one.
  void advance(const PredictedRobot& robot);
  /// Images came; `joints` as they were then, which must stay callable.
  void saw(const PosedFrame& frame, const JointPositions& joints);
  /// Puts things where they are at the state's instant, as far as it is remembered.
  void place(SceneState& state) const;
  /// Null before the first advance().
  const ThingFuture* future() const { return future_.get(); }
  /// Names of the nodes that are loose.
  std::vector<std::string> names() const;
  /// Whether that node rests where it is shown by an image's word: one that was taken since it came to rest there shows
  /// it there, and none since contradicts. False for what is not loose.
  bool seen_at_rest(const std::string& node) const;
  const ThingCounts& counts() const { return counts_; }
  /// What is to be known of them now, in a few words each: in the hand and how surely where (95 % of cases),
  /// contradicted by the images, gone.
  std::vector<std::string> lines() const;

 private:
  struct Look {
    JointPositions joints;
    RobotTime captured;
    Pose T_world_camera;
    std::future<FoundThings> found;
    bool is_of_now = true;  // of the robot's present clock
  };
  void begin_anew();
  void learn(const FoundThings& found, const JointPositions& joints, RobotTime captured, const Pose& T_world_camera);
  bool look_alike(std::size_t thing, const Pose& one, const Pose& other, const Pose& T_world_camera) const;
  void take_looked();

  const Rig& rig_;
  std::shared_ptr<const LiveScene> scene_;
  ThingFutureOptions options_;
  std::vector<std::size_t> nodes_;          // of the model, per thing
  std::vector<Eigen::AlignedBox3d> boxes_;  // around each, in its frame
  std::unique_ptr<ThingFuture> future_;
  std::unique_ptr<ThingFinder> finder_;  // null: no lenses, no things
  bool in_background_;
  ThingCounts counts_;
  std::optional<Look> look_;  // the one under way; its thread ends before the finder does
};

/// What is loose about a robot: the rig file's list, else, of the mock lab with `physics`, what a careful owner would
/// say of that. Throws what loose_things() does.
std::vector<LooseThing> things_about(const std::filesystem::path& rig_file, const LiveScene& scene, bool physics);

}  // namespace foresight
