#include "calibration/camera/rig.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <map>
#include <set>

#include "calibration/camera/lens_projection.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestCorners = 4;

void check_views(const CornerSet& set, const std::string& camera) {
  std::set<std::string> names;
  for (const BoardView& view : set.views) {
    const std::string where = camera + " camera, view " + view.name;
    if (!names.insert(view.name).second)
      throw InputError(where, "there are two views of this name", "rename or remove one");
    if (view.corners.size() < kFewestCorners)
      throw InputError(where, "has " + counted(view.corners.size(), "corner"), "remove it; at least 4 are needed");
    for (const Corner& corner : view.corners) {
      const std::string at = where + ", corner " + std::to_string(corner.index);
      if (!corner.pixel.allFinite())
        throw InputError(at, "its pixel is not a number", "remove this corner, or find the corners again");
      if (corner.index < 0 || static_cast<std::size_t>(corner.index) >= set.p_board.size())
        throw InputError(at, "the board has only " + counted(set.p_board.size(), "point"),
                         "give the --board that these corners were found on");
      if (!(corner.sigma_px > 0)) throw InputError(at, "its sigma is not positive", "give a sigma above 0, or none");
    }
  }
}

template <typename Jet>
std::array<Jet, kLensParameters> constants(const LensParameters& values) {
  std::array<Jet, kLensParameters> lens;
  for (std::size_t i = 0; i < values.size(); ++i) lens[i] = Jet(values[i]);
  return lens;
}

// Angles from the axis along x and y as a unit ray: any direction, without a pole in front.
template <typename T>
Eigen::Matrix<T, 3, 1> ray_of(const Eigen::Matrix<T, 2, 1>& a) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T angle2 = a.squaredNorm();
  if (angle2 < T(1e-20)) return {a.x(), a.y(), T(1)};
  const T angle = sqrt(angle2), s = sin(angle) / angle;
  return {s * a.x(), s * a.y(), cos(angle)};
}

}  // namespace

std::vector<Eigen::Vector2d> warp_weights(const std::vector<Eigen::Vector3d>& p_board) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : p_board) box.extend(p);
  std::vector<Eigen::Vector2d> weights;
  weights.reserve(p_board.size());
  const Eigen::Vector2d half = (0.5 * box.sizes().head<2>()).cwiseMax(1e-12);
  for (const Eigen::Vector3d& p : p_board) {
    const Eigen::Vector2d at = (p - box.center()).head<2>().cwiseQuotient(half);
    weights.emplace_back(Eigen::Vector2d::Ones() - at.cwiseAbs2());
  }
  return weights;
}

std::vector<Eigen::Vector3d> warped(const std::vector<Eigen::Vector3d>& p_board, const BoardWarp& warp) {
  std::vector<Eigen::Vector3d> points = p_board;
  const auto weights = warp_weights(p_board);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].z() += warp.x_m * weights[i].x() + warp.y_m * weights[i].y();
  return points;
}

std::string camera_name(int camera, int cameras) {
  if (cameras == 1) return "camera";
  return camera == 0 ? "left" : "right";
}

RigViews rig_views(const CornerSet& camera) {
  check_views(camera, "the");
  RigViews rig;
  rig.width[0] = camera.width, rig.height[0] = camera.height;
  rig.p_board = camera.p_board;
  for (const BoardView& view : camera.views) rig.views.push_back(RigView{view.name, {{view.corners, {}}}});
  return rig;
}

RigViews rig_views(const StereoCorners& pair) {
  check_views(pair.left, "left");
  check_views(pair.right, "right");
  if (pair.left.p_board != pair.right.p_board)
    throw InputError("corners", "the two cameras saw different boards", "show one board to both");
  RigViews rig = rig_views(pair.left);
  rig.cameras = 2;
  rig.width[1] = pair.right.width, rig.height[1] = pair.right.height;
  std::map<std::string, std::size_t> by_name;
  for (std::size_t i = 0; i < rig.views.size(); ++i) by_name[rig.views[i].name] = i;
  for (const BoardView& view : pair.right.views) {
    if (const auto found = by_name.find(view.name); found != by_name.end())
      rig.views[found->second].corners[1] = view.corners;
    else
      rig.views.push_back(RigView{view.name, {{{}, view.corners}}});
  }
  return rig;
}

RigViews subset(const RigViews& all, const std::vector<std::size_t>& indices) {
  RigViews some{all.cameras, all.width, all.height, all.p_board, {}};
  for (const std::size_t i : indices) some.views.push_back(all.views[i]);
  return some;
}

ViewPrint print_of(const RigView& view) {
  std::vector<Eigen::Vector2d> pixels;
  for (const std::vector<Corner>& corners : view.corners)
    for (const Corner& corner : corners) pixels.push_back(corner.pixel);
  return ViewPrint(pixels);
}

ViewPrints prints_of(const RigViews& all, const RigViews& some) {
  std::set<std::string> names;
  for (const RigView& view : some.views) names.insert(view.name);
  ViewPrints out;
  for (const RigView& view : all.views)
    if (names.contains(view.name)) out.push_back(print_of(view));
  return out;
}

ViewPrints prints_of(const CornerSet& camera) {
  ViewPrints out;
  for (const BoardView& view : camera.views) out.push_back(print_of(RigView{view.name, {{view.corners, {}}}}));
  return out;
}

Eigen::Vector3d to_camera(const CalibratedCameras& rig, int camera, const Eigen::Vector3d& p_left) {
  return camera == 0 ? p_left : rig.T_left_right.inverse() * p_left;
}

std::optional<Eigen::Vector2d> project(const CameraModel& camera, const Eigen::Vector3d& p_camera,
                                       Eigen::Matrix<double, 2, 3>* derivative) {
  if (!derivative) {
    Eigen::Vector2d pixel;
    if (!project<double>(camera.distortion, camera.lens.data(), p_camera, pixel)) return std::nullopt;
    return pixel;
  }
  using Jet = ceres::Jet<double, 3>;
  const auto lens = constants<Jet>(camera.lens);
  Eigen::Matrix<Jet, 3, 1> p;
  for (int i = 0; i < 3; ++i) p[i] = Jet(p_camera[i], i);
  Eigen::Matrix<Jet, 2, 1> pixel;
  if (!project<Jet>(camera.distortion, lens.data(), p, pixel)) return std::nullopt;
  derivative->row(0) = pixel[0].v.transpose();
  derivative->row(1) = pixel[1].v.transpose();
  return Eigen::Vector2d(pixel[0].a, pixel[1].a);
}

std::optional<Eigen::Vector3d> unproject(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  using Jet = ceres::Jet<double, 2>;
  const auto lens = constants<Jet>(camera.lens);
  Eigen::Vector2d a((pixel.x() - camera.lens[2]) / camera.lens[0], (pixel.y() - camera.lens[3]) / camera.lens[1]);
  if (camera.distortion != Distortion::equidistant && a.norm() > 0) a *= std::atan(a.norm()) / a.norm();
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix<Jet, 2, 1> angles(Jet(a.x(), 0), Jet(a.y(), 1));
    Eigen::Matrix<Jet, 2, 1> seen;
    if (!project<Jet>(camera.distortion, lens.data(), ray_of(angles), seen)) return std::nullopt;
    Eigen::Matrix2d J;
    J << seen[0].v.transpose(), seen[1].v.transpose();
    const Eigen::Vector2d error(seen[0].a - pixel.x(), seen[1].a - pixel.y());
    if (error.squaredNorm() < 1e-22) return ray_of(a).normalized();
    if (!(J.determinant() > 0)) return std::nullopt;  // beyond the fold
    Eigen::Vector2d step = J.inverse() * error;
    if (step.norm() > 0.2) step *= 0.2 / step.norm();
    a -= step;
    if (step.squaredNorm() < 1e-26) return ray_of(a).normalized();
  }
  return std::nullopt;
}

}  // namespace foresight
