// The one place that opens two cameras from a description, real ones or those of the mock lab.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/camera/camera_config.hpp"
#include "drivers/camera/stereo_camera.hpp"
#include "scene/robot_scene.hpp"
#include "sim/live_view/mock_camera.hpp"
#include "sim/physics/physical_lab.hpp"

namespace foresight {

/// Two cameras, not yet started, and what mock ones see.
struct OpenStereo {
  std::shared_ptr<sim::PhysicalLab> physics;  ///< of a MockWorld with physics; else null
  std::shared_ptr<sim::MockStereo> mock;      ///< null: real cameras
  std::unique_ptr<StereoCamera> cameras;
};

/// What stands in the mock lab besides its furniture, and how it differs from what the robot believes.
struct MockWorld {
  std::vector<sim::Print> prints;         ///< that stand still, such as sim::tag_prints()
  std::optional<sim::MovingPrint> board;  ///< before the cameras, or on the arm
  sim::HiddenDeviations hidden;
  std::shared_ptr<const RobotScene> things;  ///< LiveLab::Options::things; null: the lab's own arm
  bool furniture = true;                     ///< with `things`: the lab's own around them
  /// The lab's things, and more for a hand to work with, can be grasped, pushed and dropped, and their shadows move.
  std::optional<sim::PhysicsOptions> physics = {};
  unsigned layout = 0;  ///< with physics: of the things for a hand, sim::task_layout()
};

/// What a rig with this map of tags sees in the mock lab: the tags, of the family tag36h11; none without a map. Throws
/// what read_tag_map() and sim::tag_prints() do.
MockWorld mock_world(const std::optional<std::filesystem::path>& tags);

/// The world itself, not lit: for who wants to know what stands in it. `texel`: metres, of the finest pictures on its
/// surfaces, which take half a second to paint where cameras look at them. Throws what sim::LiveLab does, and
/// InputError where physics is wanted of a world without the lab's things.
std::shared_ptr<const sim::LiveLab> mock_lab(const MockWorld& world, double texel = 0.02);

/// The same description with the mock lab's cameras in place of its own: size, rate, exposure and lenses stay. Throws
/// InputError where these cannot be mock ones (two sizes, an odd width).
StereoConfig as_mock(StereoConfig config);

/// What open_stereo() gives mock cameras of this description: lenses (the usual ones of `foresight synth` where it has
/// none), the right one's place, the rate; light as fine as images of that size can show.
sim::MockCameraOptions mock_options(const StereoConfig& config);

/// `shafts` is asked by mock cameras only (MockStereo). Blocks some seconds for these: their world is lit. Real
/// cameras are found when they start. `clock` must outlive the result. `world` is for mock cameras. Throws what
/// make_camera() throws, and InputError where a mock camera, or its world, cannot do what is asked.
OpenStereo open_stereo(const StereoConfig& config, const sim::ShaftsAt& shafts, Clock& clock,
                       const MockWorld& world = {});

/// The motion that a mock lab without drives shows, from `start` on.
sim::ShaftsAt moving_shafts(RobotTime start);

/// What encoders of the mock head say from `from` to `to`, 100 times a second, as `calibrate pan-tilt --run` reads it.
/// Throws RuntimeFailure where the file cannot be written.
void write_head_joints(const std::filesystem::path& file, const sim::ShaftsAt& shafts, RobotTime from, RobotTime to);

}  // namespace foresight
