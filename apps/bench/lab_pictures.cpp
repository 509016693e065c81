#include "apps/bench/lab_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "common/parallel.hpp"
#include "sim/motion.hpp"
#include "sim/sensor.hpp"
#include "sim/shutter.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

constexpr double kNoise = 2;

}  // namespace

LabPictures::LabPictures(const LabPictureOptions& options,
                         const std::function<void(std::size_t, std::size_t)>& progress)
    : pairs_(options.count) {
  const cv::Size size = options.size;
  const sim::SynthOptions synth{.width = size.width, .height = size.height, .stereo = true};
  const double relative = 640.0 / std::max(size.width, size.height);
  const sim::Lab lab = sim::make_lab(0.0005 * std::clamp(relative, 0.6, 8.0), synth.seed);
  const sim::LightMap light(lab, std::clamp(relative, 0.6, 16.0));
  const sim::Renderer renderer(lab, light);
  const sim::RayTable left(sim::synth_lens(synth, false)), right(sim::synth_lens(synth, true));
  const sim::Sensor sensor{.noise = kNoise};
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(options.count, [&](std::size_t i) {
    const double t = options.first_s + static_cast<double>(i) / kPairsPerSecond;
    const sim::LabState state = sim::lab_state_at(lab, t);
    const sim::LightMap::Irradiance lit = light.lit(state);
    const Pose T_world_left = sim::T_world_camera_at(t), T_world_right = T_world_left * sim::T_left_right();
    pairs_[i].left = sensor.develop(renderer.render(left, T_world_left, state, lit).light, t, 2 * i);
    if (options.right)
      pairs_[i].right = sensor.develop(renderer.render(right, T_world_right, state, lit).light, t, 2 * i + 1);
    const std::scoped_lock lock(mutex);
    progress(++done, options.count);
  });
}

StereoPicture LabPictures::at(RobotTime time) const {
  const auto tick = static_cast<std::size_t>(std::floor(to_seconds(time - RobotTime{}) * kPairsPerSecond + 1e-6));
  const std::size_t turn = std::max<std::size_t>(1, 2 * (pairs_.size() - 1)), place = tick % turn;
  StereoPicture out = pairs_[place < pairs_.size() ? place : turn - place];
  out.captured = time;
  return out;
}

}  // namespace foresight
