#include "rig/open_stereo.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>

#include "calibration/registration/calibrated_head.hpp"
#include "common/error.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

Lens lens_of(const StereoConfig& config, Side side) {
  const CameraConfig& camera = config.camera(side);
  if (camera.calibration) return camera.calibration->lens;
  sim::SynthOptions usual;
  usual.width = camera.settings.width;
  usual.height = camera.settings.height;
  return sim::synth_lens(usual, side == Side::right);
}

std::unique_ptr<Camera> make_mock_camera(Side side, const CameraConfig& config,
                                         const std::shared_ptr<sim::MockStereo>& stereo) {
  auto camera = std::make_unique<sim::MockCamera>(side == Side::left ? "left" : "right", side, stereo);
  for (const auto& [control, value] : config.settings.controls) camera->set_control(control, value);
  if (config.settings.exposure.count() > 0) camera->set_exposure(config.settings.exposure);
  return camera;
}

/// How much smaller images are than those of 640 px, for which the lab is made: from half of that it is made coarser.
double coarser_for(const StereoConfig& config) {
  const CameraSettings& s = config.camera(Side::left).settings;
  return std::clamp(640.0 / std::max(s.width, s.height), 2.0, 8.0);
}

}  // namespace

MockWorld mock_world(const std::optional<fs::path>& tags) {
  MockWorld out;
  if (tags) out.prints = sim::tag_prints(read_tag_map(*tags));
  return out;
}

std::shared_ptr<const sim::LiveLab> mock_lab(const MockWorld& world, double texel) {
  sim::LiveLab::Options lab;
  lab.texel = texel;
  lab.hidden = world.hidden;
  lab.prints = world.prints;
  lab.board = world.board;
  lab.things = world.things;
  lab.furniture = world.furniture;
  if (world.physics) {
    if (!world.furniture)
      throw InputError("physics", "belongs to the things of the built-in lab, and the rig has a scene of its own",
                       "leave it out, or the scene");
    lab.task = world.layout;
    for (const sim::LooseThing& thing : world.physics->things) lab.loose.push_back(thing.name);
  }
  return std::make_shared<const sim::LiveLab>(lab);
}

StereoConfig as_mock(StereoConfig config) {
  if (config.mock()) return config;
  for (CameraConfig& camera : config.cameras) {
    const CameraSettings& s = camera.settings;
    if (s.width % 2 != 0 || s.width != config.cameras[0].settings.width ||
        s.height != config.cameras[0].settings.height)
      throw InputError("mock cameras", "cannot have two sizes, or an odd width", "change size_px in the rig");
    camera.driver = CameraDriver::mock;
    camera.device.clear();
    camera.settings.format = PixelFormat::yuyv;
    camera.settings.controls.clear();
  }
  return config;
}

sim::MockCameraOptions mock_options(const StereoConfig& config) {
  sim::MockCameraOptions options;
  options.lenses.left = lens_of(config, Side::left);
  options.lenses.right = lens_of(config, Side::right);
  const CameraConfig& right = config.camera(Side::right);
  if (right.calibration && right.calibration->T_left_right)
    options.lenses.T_left_right = *right.calibration->T_left_right;
  options.rate = config.camera(Side::left).settings.rate;
  options.light_coarser = 2 * coarser_for(config);
  return options;
}

OpenStereo open_stereo(const StereoConfig& config, const sim::ShaftsAt& shafts, Clock& clock, const MockWorld& world) {
  OpenStereo out;
  if (config.mock()) {
    const auto lab = mock_lab(world, 0.0005 * coarser_for(config));
    sim::MockCameraOptions options = mock_options(config);
    if (world.physics) {
      out.physics = std::make_shared<sim::PhysicalLab>(lab, shafts, clock.now(), *world.physics);
      options.state = [physics = out.physics](RobotTime time) { return physics->state_at(time); };
      options.moving_light = true;
    }
    out.mock = std::make_shared<sim::MockStereo>(lab, shafts, options, clock);
  }
  std::array<std::unique_ptr<Camera>, 2> cameras;
  for (const Side side : {Side::left, Side::right}) {
    const auto index = static_cast<std::size_t>(side);
    const char* const name = side == Side::left ? "left" : "right";
    cameras[index] = out.mock ? make_mock_camera(side, config.camera(side), out.mock)
                              : make_camera(name, config.camera(side), clock);
  }
  out.cameras = std::make_unique<StereoCamera>(std::move(cameras[0]), std::move(cameras[1]), clock, config.pairing);
  return out;
}

sim::ShaftsAt moving_shafts(RobotTime start) {
  return [start](std::string_view joint, RobotTime time) {
    return sim::shafts_in_motion(joint, to_seconds(time - start));
  };
}

void write_head_joints(const fs::path& file, const sim::ShaftsAt& shafts, RobotTime from, RobotTime to) {
  std::ofstream out(file);
  out << "time_s,pan,tilt\n";
  for (RobotTime t = from; t <= to; t = t + std::chrono::milliseconds(10))
    out << fmt::format("{:.9f},{:.7f},{:.7f}\n", to_seconds(t - RobotTime{}),
                       shafts("pan", t).value_or(sim::kHeadAtTable.pan),
                       shafts("tilt", t).value_or(sim::kHeadAtTable.tilt));
  if (!out.flush()) throw RuntimeFailure("cannot write " + file.string(), "choose a folder that can be written");
}

}  // namespace foresight
