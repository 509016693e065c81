#include "sim/live_view/stereo_renderer.hpp"

namespace foresight::sim {
namespace {

constexpr unsigned kOtherSeed = 7919;  // the eyes' noise must not be the same

}  // namespace

StereoRenderer::StereoRenderer(const LiveLab& world, const LightMap& light, const LightMap::Irradiance& irradiance,
                               const StereoLenses& lenses, const Sensor& sensor)
    : context_(gl::create_headless_context()), T_left_right_(lenses.T_left_right) {
  gl::set_up_context();
  buffers_ = std::make_shared<LabBuffers>(world.lab(), light, irradiance, world.prints());
  Sensor other = sensor;
  other.seed += kOtherSeed;
  views_[0].emplace(buffers_, lenses.left, sensor);
  views_[1].emplace(buffers_, lenses.right, other);
  const LabState state = world.lab().at_rest();
  draw(T_world_head_left(kHeadAtTable), state, world.true_prints(state, 0), 1, {});
  take(true);
}

bool StereoRenderer::draw(const Pose& T_world_left, const LabState& T_world_part, std::span<const Pose> T_world_print,
                          double gain, const Instant& instant) {
  if (instants_.size() >= kUnderWay) return false;
  views_[0]->draw(T_world_left, T_world_part, gain, instant.number, T_world_print);
  views_[1]->draw(T_world_left * T_left_right_, T_world_part, gain, instant.number, T_world_print);
  instants_.push_back(instant);
  return true;
}

void StereoRenderer::fetch(std::size_t eye) {
  const Lens& lens = views_[eye]->lens();
  CameraFrame& frame = finished_[eye].emplace();
  frame.pixels.create(lens.height(), lens.width(), CV_8UC2);
  frame.bytes = {frame.pixels.data, frame.pixels.total() * 2};
  views_[eye]->take({frame.pixels.data, frame.bytes.size()}, true);
  frame.format = PixelFormat::yuyv;
  frame.width = lens.width();
  frame.height = lens.height();
  frame.stride = std::size_t{2} * lens.width();
  frame.sequence = instants_.front().number;
  frame.time = instants_.front().time;
}

std::optional<std::array<CameraFrame, 2>> StereoRenderer::take(bool wait) {
  if (instants_.empty()) return std::nullopt;
  for (std::size_t eye = 0; eye < 2; ++eye)
    if (!finished_[eye] && (wait || views_[eye]->ready())) fetch(eye);
  if (!finished_[0] || !finished_[1]) return std::nullopt;
  instants_.pop_front();
  std::array<CameraFrame, 2> out{std::move(*finished_[0]), std::move(*finished_[1])};
  finished_ = {};
  return out;
}

}  // namespace foresight::sim
