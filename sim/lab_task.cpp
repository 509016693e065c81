#include "sim/lab_task.hpp"

#include <numbers>

#include "sim/lab_prints.hpp"

namespace foresight::sim {
namespace {

constexpr double kMatTop = 0.002;
constexpr float kBoard = static_cast<float>(kTrayBoard);

Pose on_table(double x, double y, double z, double yaw_deg) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(x, y, z));
  pose.rotate(Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  return pose;
}

}  // namespace

void add_task_things(LabBuilder& b) {
  const auto brick = [&](const char* name, const Pose& pose, std::uint32_t colour, char letter) {
    const auto size = static_cast<float>(kBrickSide);
    const int face = b.material([=](double t, unsigned s) { return prints::letter_block(size, t, colour, letter, s); });
    add_box(b.part(name, pose, 0.006), {0, 0, 0}, {size, size, static_cast<float>(kBrickHeight)}, 0,
            BoxPaint::all(face));
  };
  brick("brick_red", on_table(-0.20, -0.10, kMatTop, 8), 0xc8432f, 'R');
  brick("brick_blue", on_table(-0.13, 0.03, kMatTop, -20), 0x2f5f9e, 'B');

  const int wood = b.material(
      [](double t, unsigned s) { return prints::wood(kTraySide, kTraySide, t, 0xd9b98c, 0xa2774a, 0.15, s); }, 1);
  Facets& tray = b.part("tray", on_table(0.05, -0.17, 0, 0), 0.012);
  const auto side = static_cast<float>(kTraySide), height = static_cast<float>(kTrayHeight);
  const float middle = (side - kBoard) / 2, inside = side - 2 * kBoard;
  add_box(tray, {0, 0, 0}, {inside - 0.0004f, inside - 0.0004f, kBoard}, 0, BoxPaint::all(wood));
  for (const float way : {-middle, middle}) {
    add_box(tray, {way, 0, 0}, {kBoard, side, height}, 0, BoxPaint::all(wood));
    add_box(tray, {0, way, 0}, {inside - 0.0004f, kBoard, height}, 0, BoxPaint::all(wood));
  }
}

}  // namespace foresight::sim
