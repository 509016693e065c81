#include "prediction/sighting/tag_fit.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "calibration/camera/pose_solver.hpp"
#include "calibration/registration/projection_slope.hpp"
#include "common/rotation.hpp"

namespace foresight {
namespace {

constexpr double kLeastArea = 25;  // px^2
constexpr double kWorst = 3;       // px, root mean square of the corners: misread, or the tag of something else

struct Corner {
  const TagsSeenBy* camera;
  Eigen::Vector3d p;  // tag's frame
  Eigen::Vector2d pixel;
};

/// In DetectedTag's order.
std::array<Eigen::Vector3d, 4> corners_of(double side) {
  const double h = side / 2;
  return {Eigen::Vector3d(-h, -h, 0), Eigen::Vector3d(h, -h, 0), Eigen::Vector3d(h, h, 0), Eigen::Vector3d(-h, h, 0)};
}

struct CornerProblem {
  const std::vector<Corner>& corners;

  bool operator()(const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) const {
    for (const Corner& corner : corners) {
      const Pose T_camera_tag = corner.camera->T_world_camera.inverse() * at.T;
      const Eigen::Vector3d p_camera = T_camera_tag * corner.p;
      const auto pixel = corner.camera->lens->project(p_camera);
      const auto slope = projection_slope(*corner.camera->lens, p_camera);
      if (!pixel || !slope) return false;
      const Eigen::Vector2d r = *pixel - corner.pixel;
      sum.cost += r.squaredNorm() / 2;
      if (!derivatives) continue;
      const Eigen::Matrix<double, 2, 3> by_place = *slope * T_camera_tag.linear();
      Eigen::Matrix<double, 2, 6> j;
      j.rightCols<3>() = by_place;
      for (int i = 0; i < 2; ++i) j.block<1, 3>(i, 0) = corner.p.cross(by_place.row(i).transpose()).transpose();
      sum.H.noalias() += j.transpose() * j;
      sum.g.noalias() += j.transpose() * r;
    }
    return true;
  }
};

/// From the homography between the square and the rays through its corners (Zhang 2000, section 3.1).
std::optional<Pose> start_of(const std::vector<Corner>& corners) {
  Eigen::Matrix<double, 8, 9> A = Eigen::Matrix<double, 8, 9>::Zero();
  for (int i = 0; i < 4; ++i) {
    const Corner& corner = corners[static_cast<std::size_t>(i)];
    const auto ray = corner.camera->lens->unproject(corner.pixel);
    if (!ray || !(ray->z() > 0)) return std::nullopt;
    const Eigen::Vector2d x = ray->hnormalized();
    const Eigen::RowVector3d p(corner.p.x(), corner.p.y(), 1);
    A.row(2 * i) << p, Eigen::RowVector3d::Zero(), -x.x() * p;
    A.row(2 * i + 1) << Eigen::RowVector3d::Zero(), p, -x.y() * p;
  }
  // The last element is the depth of the tag's middle, in a unit that is found below.
  const Eigen::Matrix<double, 8, 1> h = A.leftCols<8>().partialPivLu().solve(-A.col(8));
  Eigen::Matrix3d H;
  H << h.head<3>().transpose(), h.segment<3>(3).transpose(), h.tail<2>().transpose(), 1;
  if (!H.allFinite()) return std::nullopt;
  const double scale = (H.col(0).norm() + H.col(1).norm()) / 2;
  if (!(scale > 0)) return std::nullopt;
  Eigen::Matrix3d R;
  R << H.col(0) / scale, H.col(1) / scale, H.col(0).cross(H.col(1)) / (scale * scale);
  Pose T_camera_tag = Pose::Identity();
  T_camera_tag.linear() = nearest_rotation(R);
  T_camera_tag.translation() = H.col(2) / scale;
  return corners[0].camera->T_world_camera * T_camera_tag;
}

/// The pose that looks nearly alike: the square tilted to the other side of the line of sight (Schweighofer and Pinz,
/// "Robust pose estimation from a planar target", PAMI 2006).
Pose tilted_over(const Pose& T_camera_tag) {
  const Eigen::Vector3d to_eye = -T_camera_tag.translation().normalized(), n = T_camera_tag.linear().col(2);
  const Eigen::Vector3d axis = n.cross(to_eye);
  Pose out = T_camera_tag;
  if (axis.norm() > 1e-9)
    out.linear() =
        Eigen::AngleAxisd(2 * std::atan2(axis.norm(), n.dot(to_eye)), axis.normalized()) * T_camera_tag.linear();
  return out;
}

double area_of(const std::array<Eigen::Vector2d, 4>& corners) {
  double twice = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d &a = corners[k], &b = corners[(k + 1) % 4];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return std::abs(twice) / 2;
}

/// The better of both tilts.
std::optional<PoseEstimate<0>> solve(const std::vector<Corner>& corners, PoseEquations<0>& equations) {
  const auto start = start_of(corners);
  if (!start) return std::nullopt;
  const Pose& T_world_camera = corners[0].camera->T_world_camera;
  std::optional<PoseEstimate<0>> best;
  for (const Pose& from : {*start, Pose(T_world_camera * tilted_over(T_world_camera.inverse() * *start))}) {
    const auto solution = solve_pose<0>({from, {}}, CornerProblem{corners}, {.base = from});
    PoseEquations<0> there;
    if (!solution.usable || !CornerProblem{corners}(solution.at, true, there)) continue;
    if (best && there.cost >= equations.cost) continue;
    best = solution.at;
    equations = there;
  }
  return best;
}

}  // namespace

std::optional<TagFit> fit_tag(const ThingTag& tag, std::span<const TagsSeenBy> cameras, double corner_px) {
  std::vector<Corner> corners;
  for (const TagsSeenBy& camera : cameras)
    for (const DetectedTag& seen : *camera.tags) {
      if (seen.id != tag.id || area_of(seen.corners) < kLeastArea) continue;
      const auto p = corners_of(tag.side);
      for (std::size_t k = 0; k < 4; ++k) corners.push_back({&camera, p[k], seen.corners[k]});
      break;
    }
  if (corners.empty()) return std::nullopt;
  PoseEquations<0> equations;
  const auto solution = solve(corners, equations);
  if (!solution) return std::nullopt;
  const auto residuals = static_cast<double>(2 * corners.size());
  if (!(std::sqrt(2 * equations.cost / residuals) < kWorst)) return std::nullopt;
  TagFit out;
  const Pose T_tag_thing = tag.T_thing_tag.inverse();
  out.T_world_thing = solution->T * T_tag_thing;
  const Matrix6d at_tag = corner_px * corner_px * (equations.H + 1e-6 * Matrix6d::Identity()).inverse();
  // A small motion (w, t) of the tag in its frame is one of R w and R t - R w x p in the thing's; p: the tag there.
  Matrix6d J = Matrix6d::Zero();
  const Eigen::Matrix3d R = tag.T_thing_tag.linear();
  const Eigen::Vector3d p = tag.T_thing_tag.translation();
  Eigen::Matrix3d cross;
  cross << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
  J.topLeftCorner<3, 3>() = R;
  J.bottomRightCorner<3, 3>() = R;
  J.bottomLeftCorner<3, 3>() = cross * R;  // t' = R t - (R w) x p = R t + p x (R w)
  out.covariance = J * at_tag * J.transpose();
  return out;
}

}  // namespace foresight
