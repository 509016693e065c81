#include "display/head/xr_poses.hpp"

#include "input/room_axes.hpp"

namespace foresight::head {

std::optional<Pose> pose_of(const XrPosef& pose) {
  const auto& [q, p] = pose;
  return checked_pose(Eigen::Vector3f(p.x, p.y, p.z).cast<double>(),
                      Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>());
}

XrPosef xr_pose(const Pose& T) {
  const Pose T_room = to_room_axes(T);
  const Eigen::Quaternionf q = Eigen::Quaterniond(T_room.linear()).normalized().cast<float>();
  const Eigen::Vector3f p = T_room.translation().cast<float>();
  return {{q.x(), q.y(), q.z(), q.w()}, {p.x(), p.y(), p.z()}};
}

std::optional<EyeFov> fov_of(const XrFovf& fov) {
  return checked_fov({fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown});
}

XrFovf xr_fov(const EyeFov& fov) {
  const auto f = [](double angle) { return static_cast<float>(angle); };
  return {f(fov.left), f(fov.right), f(fov.up), f(fov.down)};
}

}  // namespace foresight::head
