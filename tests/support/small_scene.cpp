#include "tests/support/small_scene.hpp"

#include <cmath>

#include "scene/primitives.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"

namespace foresight {
namespace {

const Eigen::Vector3d kBoxSize(0.25, 0.2, 0.3), kBlockSize(0.15, 0.12, 0.1);

Mesh rectangle(double x, double y) {
  const auto a = static_cast<float>(x / 2), b = static_cast<float>(y / 2);
  Mesh mesh;
  mesh.vertices = {{-a, -b, 0}, {a, -b, 0}, {a, b, 0}, {-a, b, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

}  // namespace

std::shared_ptr<const SceneModel> small_scene() {
  Pose board = at(0.62, 0.1, 0.3);
  board.rotate(Eigen::AngleAxisd(-1.2, Eigen::Vector3d::UnitY()));
  Pose box = at(0.05, 0.1, 0.15);
  box.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()));
  return std::make_shared<SceneModel>(std::vector<Node>{{"table", rectangle(1.5, 1.1), -1, Pose::Identity()},
                                                        {"box", make_box(kBoxSize), -1, box},
                                                        {"block", make_box(kBlockSize), -1, at(-0.2, -0.25, 0.05)},
                                                        {"board", rectangle(0.5, 0.7), -1, board}});
}

bool at_contact(const SceneState& state, int node, const Eigen::Vector3d& p_node, double reach) {
  const Eigen::Vector3d p_world = state.T_world_node[static_cast<std::size_t>(node)] * p_node;
  if (node != kTable) return p_world.z() < reach;
  const auto within = [&](int solid, const Eigen::Vector3d& size) {
    const Eigen::Vector3d p = state.T_world_node[static_cast<std::size_t>(solid)].inverse() * p_world;
    return (p.cwiseAbs() - size / 2).maxCoeff() < reach;
  };
  return within(kBox, kBoxSize) || within(kBlock, kBlockSize);
}

std::shared_ptr<const SceneModel> plane_scene(double x, double y) {
  return std::make_shared<SceneModel>(std::vector<Node>{{"plane", rectangle(x, y), -1, Pose::Identity()}});
}

SceneState state_of(const SceneModel& scene, double block_x) {
  SceneState state{RobotTime{1}, StateStatus::exact, scene.rest_poses()};
  if (const auto block = scene.find("block"))
    state.T_world_node[static_cast<std::size_t>(*block)].translation().x() += block_x;
  return state;
}

Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Pose pose = Pose::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = eye;
  return pose;
}

Pose usual_view() {
  return look_at({-1.0, -0.45, 0.8}, {0.02, 0, 0.1});
}

Lens small_lens(const std::string& kind) {
  Lens::Parameters p;
  p.width = 160, p.height = 120;
  p.fx = 130, p.fy = 132, p.cx = 78.7, p.cy = 61.2;
  if (kind == "plumb_bob") p.d = {-0.24, 0.07, 0.0011, -0.0008, -0.008};
  if (kind == "rational") {
    p.model = LensModel::rational_polynomial;
    p.d = {0.9, 0.2, 0.0006, -0.0005, 0.02, 1.15, 0.35, 0.05};
  }
  if (kind == "fisheye" || kind == "wide_fisheye") {
    p.model = LensModel::equidistant;
    p.fx = kind == "fisheye" ? 110 : 55;
    p.fy = p.fx * 1.01;
    p.d = {-0.01, 0.004, -0.002, 0.0003};
  }
  return Lens(p);
}

Eigen::Vector3d paint(int node, const Eigen::Vector3d& p) {
  static const Eigen::Vector3d hues[] = {
      {0.30, 0.55, 0.30}, {0.15, 0.20, 0.70}, {0.75, 0.30, 0.15}, {0.50, 0.50, 0.52}};
  constexpr double kWave = 2 * M_PI / 0.2;
  const double wave = std::sin(kWave * p.x()) + std::sin(kWave * p.y() + 1) + std::sin(kWave * p.z() + 2);
  return hues[node % 4] * (1 + 0.1 * wave);
}

cv::Mat photograph(const SceneModel& scene, const SceneState& state, const Lens& lens, const Pose& T_world_camera,
                   double gain) {
  const reference::RayCaster caster(scene, state);
  cv::Mat image(lens.height(), lens.width(), CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const auto ray = lens.unproject({x, y});
      if (!ray) continue;
      const auto hit = caster.cast(T_world_camera.translation(), T_world_camera.linear() * *ray, 0.01);
      if (!hit) continue;
      const Eigen::Vector3d colour =
          gain * paint(hit->node, state.T_world_node[static_cast<std::size_t>(hit->node)].inverse() * hit->p_world);
      for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uchar>(255 * colour[c]);
    }
  return image;
}

PosedImage posed_photograph(const SceneModel& scene, const SceneState& state, const Lens& lens,
                            const Pose& T_world_camera, double gain) {
  return {photograph(scene, state, lens, T_world_camera, gain), state.time, T_world_camera, state};
}

}  // namespace foresight
