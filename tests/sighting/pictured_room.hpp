// The lab with things for a hand, and pictures of it by the ray caster, which shares no code with what looks at them.
#pragma once

#include "scene/posed_frame.hpp"
#include "scene/stereo_lenses.hpp"
#include "sim/live_lab.hpp"
#include "sim/picture.hpp"
#include "sim/sensor.hpp"
#include "sim/synth_run.hpp"

namespace foresight::sim {

inline const std::vector<std::string> kBricks = {"brick_red", "brick_blue"};

/// One lit lab for all tests, and what is seen of it.
class PicturedRoom {
 public:
  explicit PicturedRoom(int width)
      : live_(shared_lab()),
        light_(shared_light()),
        model_(std::make_shared<const SceneModel>(model_of(live_->lab(), live_->modelled_rest()))) {
    SynthOptions options;
    options.width = width;
    options.height = width * 3 / 4;
    lenses = {synth_lens(options, false), synth_lens(options, true), T_head_left_right()};
    for (const std::string& name : kBricks) nodes.push_back(static_cast<std::size_t>(*model_->find(name)));
  }

  const std::shared_ptr<const SceneModel>& model() const { return model_; }
  const std::shared_ptr<const LiveLab>& live() const { return live_; }
  LabState rest() const { return live_->true_state(shafts_at_rest, 0); }

  /// Pictures of `truth`, with everything thought to be at `thought`.
  PosedFrame frame(const LabState& truth, const LabState& thought, std::int64_t number) const {
    const auto irradiance = light_.lit(truth, 8);
    const Pose T_world_left = live_->T_world_left(shafts_at_rest);
    PosedFrame out;
    out.left = image(lenses.left, T_world_left, truth, irradiance, number);
    out.right = image(lenses.right, T_world_left * lenses.T_left_right, truth, irradiance, number);
    out.left.scene = out.right->scene = {out.left.time, StateStatus::exact, thought};
    return out;
  }

  StereoLenses lenses;
  std::vector<std::size_t> nodes;

 private:
  PosedImage image(const Lens& lens, const Pose& T_world_camera, const LabState& truth,
                   const LightMap::Irradiance& irradiance, std::int64_t number) const {
    const Picture picture = Renderer(live_->lab(), light_).render(RayTable(lens), T_world_camera, truth, irradiance);
    const Sensor sensor{.noise = 1.5};
    PosedImage out;
    out.pixels = sensor.develop(picture.light, 0, static_cast<int>(number));
    out.time = {number * 100'000'000};
    out.T_world_camera = T_world_camera;
    return out;
  }

  // Building and lighting the lab is what takes long, and does not depend on the pictures' size.
  static const std::shared_ptr<const LiveLab>& shared_lab() {
    static const auto built =
        std::make_shared<const LiveLab>(LiveLab::Options{.texel = 0.001, .task = true, .loose = kBricks});
    return built;
  }
  static const LightMap& shared_light() {
    static const LightMap built(shared_lab()->lab(), 4);
    return built;
  }

  std::shared_ptr<const LiveLab> live_;
  const LightMap& light_;
  std::shared_ptr<const SceneModel> model_;
};

}  // namespace foresight::sim
