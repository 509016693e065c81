#include "sim/lab_task.hpp"

#include <numbers>
#include <random>

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

constexpr double kApart = 0.11;  // m between bricks: room for a hand that is open

}  // namespace

TaskLayout task_layout(unsigned number) {
  TaskLayout out{on_table(-0.20, -0.10, kMatTop, 8), on_table(-0.13, 0.03, kMatTop, -20), on_table(0.05, -0.17, 0, 0)};
  if (number == 0) return out;
  std::mt19937 random(number);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto on_mat = [&] {
    const double x = between(-0.21, -0.10), y = between(-0.13, 0.04);
    return on_table(x, y, kMatTop, between(-45, 45));
  };
  do {
    out.brick_red = on_mat();
    out.brick_blue = on_mat();
  } while ((out.brick_red.translation() - out.brick_blue.translation()).norm() < kApart);
  const double x = between(0.0, 0.05), y = between(-0.20, -0.17);
  out.tray = on_table(x, y, 0, between(-6, 6));  // more, and a corner would be in the servo kit
  return out;
}

bool lies_in_tray(const Pose& T_world_thing, const Pose& T_world_tray) {
  const Eigen::Vector3d at = T_world_tray.inverse() * T_world_thing.translation();
  return at.head<2>().cwiseAbs().maxCoeff() < kTraySide / 2 && at.z() > kTrayBoard / 2 && at.z() < kTrayHeight;
}

void add_task_things(LabBuilder& b, unsigned layout) {
  const TaskLayout at = task_layout(layout);
  const auto brick = [&](const char* name, const Pose& pose, std::uint32_t colour, char letter) {
    const auto size = static_cast<float>(kBrickSide);
    const int face = b.material([=](double t, unsigned s) { return prints::letter_block(size, t, colour, letter, s); });
    add_box(b.part(name, pose, 0.006), {0, 0, 0}, {size, size, static_cast<float>(kBrickHeight)}, 0,
            BoxPaint::all(face));
  };
  brick("brick_red", at.brick_red, 0xc8432f, 'R');
  brick("brick_blue", at.brick_blue, 0x2f5f9e, 'B');

  const int wood = b.material(
      [](double t, unsigned s) { return prints::wood(kTraySide, kTraySide, t, 0xd9b98c, 0xa2774a, 0.15, s); }, 1);
  Facets& tray = b.part("tray", at.tray, 0.012);
  const auto side = static_cast<float>(kTraySide), height = static_cast<float>(kTrayHeight);
  const float middle = (side - kBoard) / 2, inside = side - 2 * kBoard;
  add_box(tray, {0, 0, 0}, {inside - 0.0004f, inside - 0.0004f, kBoard}, 0, BoxPaint::all(wood));
  for (const float way : {-middle, middle}) {
    add_box(tray, {way, 0, 0}, {kBoard, side, height}, 0, BoxPaint::all(wood));
    add_box(tray, {0, way, 0}, {inside - 0.0004f, kBoard, height}, 0, BoxPaint::all(wood));
  }
}

}  // namespace foresight::sim
