// The lab with things for a hand, and pictures of it by the ray caster, which shares no code with what looks at them.
#pragma once

#include <algorithm>
#include <deque>

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
        model_(std::make_shared<const SceneModel>(live_->modelled_scene())) {
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
    const Pose T_world_left = live_->T_world_left(shafts_at_rest);
    const Pictures& pictures = pictures_of(truth);
    PosedFrame out;
    out.left = image(pictures.left, T_world_left, number);
    out.right = image(pictures.right, T_world_left * lenses.T_left_right, number);
    out.left.scene = out.right->scene = {out.left.time, StateStatus::exact, thought};
    return out;
  }

  StereoLenses lenses;
  std::vector<std::size_t> nodes;

 private:
  struct Pictures {
    LabState truth;
    Picture left, right;
  };
  // Rays are what takes long, and tests begin from the same room: only the noise is another each time.
  const Pictures& pictures_of(const LabState& truth) const {
    for (const Pictures& known : pictures_)
      if (std::ranges::equal(known.truth, truth, [](const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }))
        return known;
    const auto irradiance = light_.lit(truth, 8);
    const Pose T_world_left = live_->T_world_left(shafts_at_rest);
    const Renderer renderer(live_->lab(), light_);
    return pictures_.emplace_back(
        Pictures{truth, renderer.render(RayTable(lenses.left), T_world_left, truth, irradiance),
                 renderer.render(RayTable(lenses.right), T_world_left * lenses.T_left_right, truth, irradiance)});
  }
  static PosedImage image(const Picture& picture, const Pose& T_world_camera, std::int64_t number) {
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
  mutable std::deque<Pictures> pictures_;  // those that were asked for; tests have one thread
};

}  // namespace foresight::sim
