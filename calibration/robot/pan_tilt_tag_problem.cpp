#include "calibration/robot/pan_tilt_tag_problem.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <utility>

#include "calibration/camera/lens_slopes.hpp"
#include "calibration/camera/minimise.hpp"
#include "calibration/robot/arrow_system.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kTagRobust = 6;  // of a tag's eight residuals together, which is 2.8 where all is well

// The four corners of one tag.
struct TagResidual {
  const PanTiltView* view;
  const SeenTag* tag;
  const CameraModel* lens;
  MotionParameters T_left_camera;
  double weight;

  template <typename T>
  bool operator()(const T* world, const T* link, const T* camera, const T* joints, const T* offset, const T* shaft,
                  T* residual) const {
    const PanTiltAngles& a = view->angles;
    const T pan = joints[0] * (a.pan + view->rate[0] * offset[0]) + joints[2] * (0.5 * a.came[0]) + shaft[0];
    const T tilt = joints[1] * (a.tilt + view->rate[1] * offset[0]) + joints[3] * (0.5 * a.came[1]) + shaft[1];
    HeadMotion<T> head = head_motion(world, link, camera, pan, tilt);
    T motion[7] = {head.q.x(), head.q.y(), head.q.z(), head.q.w(), head.p.x(), head.p.y(), head.p.z()};
    T right[7];
    for (std::size_t i = 0; i < 7; ++i) right[i] = T(T_left_camera[i]);
    for (std::size_t c = 0; c < 4; ++c) {
      Eigen::Matrix<T, 3, 1> p = inverse_transform(motion, Eigen::Matrix<T, 3, 1>(tag->corners[c].cast<T>()));
      if (tag->camera == 1) p = inverse_transform(right, p);
      Eigen::Matrix<T, 2, 1> pixel;
      if (!project_by_slopes(lens->distortion, lens->lens, p, pixel)) return false;
      residual[2 * c] = T(weight) * (pixel.x() - tag->pixels[c].x());
      residual[2 * c + 1] = T(weight) * (pixel.y() - tag->pixels[c].y());
    }
    return true;
  }
};

struct ShaftResidual {
  double weight;
  template <typename T>
  bool operator()(const T* shaft, T* residual) const {
    residual[0] = T(weight) * shaft[0];
    residual[1] = T(weight) * shaft[1];
    return true;
  }
};

bool counts(const PanTiltTagState& state, std::size_t view) {
  return std::any_of(state.left_out[view].begin(), state.left_out[view].end(), [](char out) { return !out; });
}

void add_view(const std::vector<PanTiltView>& views, std::size_t k, const CalibratedCameras& cameras,
              PanTiltTagState& state, ceres::Problem& problem) {
  PanTiltState& head = state.head;
  double* const shaft = state.shafts[k].data();
  for (std::size_t i = 0; i < views[k].tags.size(); ++i) {
    if (state.left_out[k][i]) continue;
    const SeenTag& tag = views[k].tags[i];
    auto* functor = new TagResidual{&views[k], &tag, &cameras.cameras[static_cast<std::size_t>(tag.camera)],
                                    to_parameters(cameras.T_left_right), 1 / state.corner_px};
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<TagResidual, 8, 7, 2, 7, 4, 1, 2>(functor),
                             state.robust ? new ceres::CauchyLoss(kTagRobust) : nullptr, head.world.data(),
                             head.link.data(), head.camera.data(), head.joints.data(), &state.offset_s, shaft);
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ShaftResidual, 2, 2>(new ShaftResidual{1 / state.shaft_rad}),
                           nullptr, shaft);
}

void build(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras, PanTiltTagState& state, int without,
           ceres::Problem& problem) {
  for (std::size_t k = 0; k < views.size(); ++k)
    if (static_cast<int>(k) != without && counts(state, k)) add_view(views, k, cameras, state, problem);
  hold_joints(state.head, problem);
  if (state.offset_held) problem.SetParameterBlockConstant(&state.offset_s);
}

// The state with parameter `index` of its tangent, in the order of pan_tilt_names() and then offset_s, moved by `step`.
PanTiltTagState nudged(PanTiltTagState state, Eigen::Index index, double step) {
  const auto nudge_motion = [&](MotionParameters& motion, Eigen::Index i) {
    Vector6d delta = Vector6d::Zero();
    delta[i] = i < 3 ? step / 2 : step;  // the manifold of a rotation steps by half angles
    MotionParameters out{};
    const std::unique_ptr<ceres::Manifold> manifold(motion_manifold());
    manifold->Plus(motion.data(), delta.data(), out.data());
    motion = out;
  };
  PanTiltState& head = state.head;
  std::vector<std::size_t> free_joints;
  for (int i = 0; i < 4; ++i)
    if (std::find(head.held_joints.begin(), head.held_joints.end(), i) == head.held_joints.end())
      free_joints.push_back(static_cast<std::size_t>(i));
  const auto joint = static_cast<std::size_t>(std::max<Eigen::Index>(0, index - 14));
  if (index < 6)
    nudge_motion(head.world, index);
  else if (index < 8)
    head.link[static_cast<std::size_t>(index - 6)] += step;
  else if (index < 14)
    nudge_motion(head.camera, index - 8);
  else if (joint < free_joints.size())
    head.joints[free_joints[joint]] += step;
  else
    state.offset_s += step;
  return state;
}

Vector6d pose_sigma(const std::vector<PanTiltView>& views, const PanTiltTagState& state,
                    const Eigen::MatrixXd& covariance) {
  constexpr double kStep = 1e-6;
  Vector6d variance = Vector6d::Zero();
  for (const PanTiltView& view : views) {
    Eigen::MatrixXd slope(6, covariance.rows());
    for (Eigen::Index i = 0; i < covariance.rows(); ++i)
      slope.col(i) = step_between(predicted_left(state, view), predicted_left(nudged(state, i, kStep), view)) / kStep;
    variance += (slope * covariance * slope.transpose()).diagonal() / static_cast<double>(views.size());
  }
  return variance.cwiseMax(0).cwiseSqrt();
}

}  // namespace

Pose predicted_left(const PanTiltTagState& state, const PanTiltView& view) {
  PanTiltAngles angles = view.angles;
  angles.pan += view.rate[0] * state.offset_s;
  angles.tilt += view.rate[1] * state.offset_s;
  return camera_pose(to_model(state.head), angles);
}

void fit_pan_tilt_tags(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras, PanTiltTagState& state,
                       int without) {
  ceres::Problem problem;
  build(views, cameras, state, without, problem);
  MinimiseOptions options;
  options.solver = ceres::DENSE_SCHUR;
  for (auto& shaft : state.shafts) options.eliminated.push_back(shaft.data());
  options.most_iterations = 60;
  options.function_tolerance = 1e-8;
  minimise_or_throw(problem, options, "the pan-tilt fit",
                    "check that angles, pictures and the map of the tags belong together");
}

PanTiltTagCovariance pan_tilt_tag_covariance(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                                             PanTiltTagState& state) {
  ceres::Problem problem;
  const bool robust = std::exchange(state.robust, false);
  build(views, cameras, state, -1, problem);
  state.robust = robust;
  std::vector<double*> shared{state.head.world.data(), state.head.link.data(), state.head.camera.data()}, own;
  if (state.head.held_joints.size() < 4) shared.push_back(state.head.joints.data());
  if (!state.offset_held) shared.push_back(&state.offset_s);
  for (std::size_t k = 0; k < views.size(); ++k)
    if (counts(state, k)) own.push_back(state.shafts[k].data());
  const ArrowSystem system = arrow_system(problem, shared, own);

  PanTiltTagCovariance out;
  const Eigen::VectorXd scale = pan_tilt_tangent_scale(system.shared_covariance.rows());
  out.head = scale.asDiagonal() * system.shared_covariance * scale.asDiagonal();
  std::vector<std::string> names = pan_tilt_names(state.head);
  names.emplace_back("offset_s");
  for (const Eigen::VectorXd& direction : system.open)
    for (Eigen::Index i = 0; i < direction.size(); ++i)
      if (std::abs(direction[i]) > 0.3) out.open.push_back(names[static_cast<std::size_t>(i)]);
  out.pose_sigma = pose_sigma(views, state, out.head);
  for (const Eigen::MatrixXd& covariance : system.own_covariance)
    out.shaft_variance += covariance.trace() / 2 / static_cast<double>(own.size());
  return out;
}

}  // namespace foresight
