#include "display/rehearsal.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

constexpr double kFarthest = 1.5;      // m, from the scene's middle
constexpr double kShareOfScene = 0.6;  // of its diagonal, where that is less
constexpr double kMovesOn = 0.02;      // m, of what may move, from image to image
constexpr double kEyesApart = 0.065;   // m
constexpr std::array kCloseness{1.0, 1.0, 0.4, 0.4, 0.4, 1.0};
constexpr Duration kApartBy = std::chrono::milliseconds(100);

/// At `eye`, looking at `point`, with z up.
Pose looking_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) {
  const Eigen::Vector3d forward = (point - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Pose out = Pose::Identity();
  out.linear() << right, forward.cross(right), forward;
  out.translation() = eye;
  return out;
}

cv::Mat pattern(const Lens& lens, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat coarse(std::max(1, lens.height() / 16), std::max(1, lens.width() / 16), CV_8UC3), out;
  random.fill(coarse, cv::RNG::UNIFORM, 60, 190);
  cv::resize(coarse, out, {lens.width(), lens.height()}, 0, 0, cv::INTER_CUBIC);
  cv::Mat fine(out.size(), CV_8UC3);
  random.fill(fine, cv::RNG::UNIFORM, 0, 30);
  return out + fine;
}

}  // namespace

std::vector<PosedFrame> rehearsal_frames(const SceneModel& scene, const Lens& left, const std::optional<Lens>& right) {
  const Eigen::Vector3d middle = scene.box().center();
  const Eigen::Vector3d away = std::min(kFarthest, kShareOfScene * scene.diagonal()) * Eigen::Vector3d(-0.8, 0, 0.6);
  std::vector<PosedFrame> out;
  for (std::size_t i = 0; i < kCloseness.size(); ++i) {
    PosedImage image;
    image.time = RobotTime{} + (1 + static_cast<int>(i)) * kApartBy;
    image.T_world_camera = looking_at(middle + kCloseness[i] * away, middle);
    image.scene = {image.time, StateStatus::predicted, scene.rest_poses()};
    for (std::size_t n = 0; n < scene.nodes().size(); ++n)
      if (scene.nodes()[n].may_move)
        image.scene.T_world_node[n].pretranslate(kMovesOn * static_cast<double>(i) * Eigen::Vector3d::UnitY());
    PosedFrame frame{image, std::nullopt};
    frame.left.pixels = pattern(left, 1);
    if (right) {
      frame.right = std::move(image);
      frame.right->pixels = pattern(*right, 2);
      frame.right->T_world_camera.translate(kEyesApart * Eigen::Vector3d::UnitX());
    }
    out.push_back(std::move(frame));
  }
  return out;
}

}  // namespace foresight
