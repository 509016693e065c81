#include "synthetic_rig.hpp"

#include "calibration/robot/hand_eye_start.hpp"

namespace foresight {
namespace {

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Sums of sines per coordinate: smooth, and never the same twice.
struct Wave {
  std::array<double, 4> size, rate, phase;
  double at(double t) const {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += size[i] * std::sin(rate[i] * t + phase[i]);
    return sum;
  }
};

Wave random_wave(Random& random, double size) {
  Wave wave;
  for (std::size_t i = 0; i < 4; ++i)
    wave.size[i] = size * uniform(random, 0.3, 1), wave.rate[i] = uniform(random, 0.4, 4),
    wave.phase[i] = uniform(random, 0, 6.28);
  return wave;
}

}  // namespace

double normal(Random& random, double sigma) {
  return std::normal_distribution<double>(0, sigma)(random);
}

Eigen::Vector3d normal3(Random& random, double sigma) {
  const double x = normal(random, sigma), y = normal(random, sigma);
  return {x, y, normal(random, sigma)};
}

Pose random_pose(Random& random, double turn, double shift) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation_of(normal3(random, 1).normalized() * uniform(random, 0, turn));
  pose.translation() = normal3(random, shift);
  return pose;
}

Pose noisy(const Pose& pose, Random& random, double sigma_rad, double sigma_m) {
  Vector6d step;
  step << normal3(random, sigma_rad), normal3(random, sigma_m);
  return moved(pose, step);
}

HandEyeRig make_rig(Random& random, const HandEyeRigOptions& options) {
  HandEyeRig rig;
  rig.camera = {
      1280,
      960,
      Distortion::radtan4,
      {uniform(random, 900, 1200), uniform(random, 900, 1200), uniform(random, 600, 680), uniform(random, 440, 520)}};
  rig.camera.lens[1] = rig.camera.lens[0] * uniform(random, 0.998, 1.002);
  rig.camera.lens[4] = uniform(random, -0.15, 0), rig.camera.lens[5] = uniform(random, 0, 0.1);
  rig.X = random_pose(random, 3, 0.3), rig.Y = random_pose(random, 3, 0.2);
  rig.data.corners.width = 1280, rig.data.corners.height = 960;
  for (int i = 0; i < options.cols * options.rows; ++i)
    rig.data.corners.p_board.emplace_back(options.size_m * (i % options.cols), options.size_m * (i / options.cols), 0);
  const Eigen::Vector3d centre = (rig.data.corners.p_board.front() + rig.data.corners.p_board.back()) / 2;
  const Eigen::Vector3d axis = normal3(random, 1).normalized();
  for (int v = 0; v < options.views; ++v) {
    Pose T_camera_board = Pose::Identity();
    const Eigen::Vector3d turn = options.one_axis ? Eigen::Vector3d(axis * uniform(random, -0.7, 0.7))
                                                  : Eigen::Vector3d(uniform(random, -0.6, 0.6),
                                                                    uniform(random, -0.6, 0.6), uniform(random, -1, 1));
    const double z = uniform(random, 0.5, 0.9);
    T_camera_board.linear() = rotation_of(turn);
    T_camera_board.translation() =
        Eigen::Vector3d(uniform(random, -0.2, 0.2) * z, uniform(random, -0.15, 0.15) * z, z) -
        T_camera_board.linear() * centre;
    BoardView view{"view" + std::to_string(v), {}};
    for (std::size_t i = 0; i < rig.data.corners.p_board.size(); ++i) {
      Eigen::Vector2d pixel;
      project<double>(rig.camera.distortion, rig.camera.lens.data(), T_camera_board * rig.data.corners.p_board[i],
                      pixel);
      const double x = normal(random, options.noise_px), y = normal(random, options.noise_px);
      view.corners.push_back({static_cast<int>(i), pixel + Eigen::Vector2d(x, y), 1});
    }
    rig.data.corners.views.push_back(std::move(view));
    const Pose F = options.mount == CameraMount::fixed ? rig.X * T_camera_board * rig.Y.inverse()
                                                       : rig.Y * (rig.X * T_camera_board).inverse();
    rig.data.poses.push_back({noisy(F, random, options.noise_rad, options.noise_m), {}});
  }
  return rig;
}

JointRig make_joint_rig(JointChain& chain, const std::vector<double>& offsets, Random& random) {
  JointRig out{make_rig(random, {.views = 1}), {}};
  HandEyeRig& rig = out.rig;
  rig.data.corners.views.clear(), rig.data.poses.clear();
  const std::size_t n = chain.joints.size();
  const auto true_pose = [&](std::vector<double> q) {
    for (std::size_t i = 0; i < n; ++i) q[i] += offsets[i];
    return flange_pose(chain, q, "test");
  };
  const std::vector<double> home(n, 0.4);
  Pose T_camera_board = Pose::Identity();
  T_camera_board.translation() = Eigen::Vector3d(-0.07, -0.05, 0.8);
  rig.X = true_pose(home) * rig.Y * T_camera_board.inverse();
  std::uniform_real_distribution<double> step(-0.5, 0.5);
  for (int tries = 0; tries < 20000 && out.rows.size() < 25; ++tries) {
    std::vector<double> q = home;
    for (double& value : q) value += step(random);
    const Pose T = rig.X.inverse() * true_pose(q) * rig.Y;
    BoardView view{"view" + std::to_string(out.rows.size()), {}};
    for (std::size_t i = 0; i < rig.data.corners.p_board.size(); ++i) {
      Eigen::Vector2d pixel(-1, -1);
      project<double>(rig.camera.distortion, rig.camera.lens.data(), T * rig.data.corners.p_board[i], pixel);
      if (pixel.minCoeff() < 0 || pixel.x() > 1280 || pixel.y() > 960) break;
      const double x = normal(random, 0.1), y = normal(random, 0.1);
      view.corners.push_back({static_cast<int>(i), pixel + Eigen::Vector2d(x, y), 1});
    }
    if (view.corners.size() < rig.data.corners.p_board.size() || T.linear()(2, 2) < 0.6) continue;
    rig.data.corners.views.push_back(view);
    out.rows.push_back(q);
  }
  return out;
}

Vector6d in_sigmas(const Pose& found, const Pose& truth, const Vector6d& sigma) {
  Vector6d off;
  off << rotation_vector(found.linear() * truth.linear().transpose()), found.translation() - truth.translation();
  return off.cwiseQuotient(sigma);
}

StreamRig make_streams(Random& random, double length_s, double offset_s, bool camera_inverted) {
  StreamRig rig;
  rig.offset_s = offset_s;
  rig.X = random_pose(random, 3, 0.1), rig.Y = random_pose(random, 3, 0.5);
  std::array<Wave, 6> waves;
  for (std::size_t i = 0; i < 6; ++i) waves[i] = random_wave(random, i < 3 ? 0.25 : 0.1);
  const auto hand = [&](double t) {
    Pose pose = Pose::Identity();
    pose.linear() = rotation_of({waves[0].at(t), waves[1].at(t), waves[2].at(t)});
    pose.translation() = Eigen::Vector3d(waves[3].at(t), waves[4].at(t), waves[5].at(t));
    return pose;
  };
  const RobotTime zero{1'487'321'563'180'327'900};
  for (double t = -1; t < length_s + 1; t += 0.01)
    rig.encoder.push_back({zero + seconds(t), noisy(hand(t), random, 2e-4, 2e-4)});
  for (double t = 0; t < length_s; t += 1 / 30.0) {
    if (t > 0.4 * length_s && t < 0.4 * length_s + 0.5) continue;
    Pose T_target_camera = noisy(rig.Y.inverse() * hand(t + offset_s) * rig.X, random, 4e-3, 2e-3);
    if (uniform(random, 0, 1) < 0.01) T_target_camera = T_target_camera * random_pose(random, 2, 0.3);
    rig.camera.push_back({zero + seconds(t), camera_inverted ? T_target_camera.inverse() : T_target_camera});
  }
  return rig;
}

PanTiltModel random_head(Random& random) {
  PanTiltModel model;
  model.T_world_pan = random_pose(random, 3, 0.5);
  model.length_m = uniform(random, -0.05, 0.05);
  model.twist_rad = uniform(random, 1.3, 1.8);
  model.T_tilt_camera = random_pose(random, 3, 0.1);
  model.backlash_rad = {uniform(random, -3e-3, 3e-3), uniform(random, -3e-3, 3e-3)};
  return model;
}

std::vector<PanTiltSample> make_head(Random& random, const PanTiltModel& model, int poses, double sigma_rad,
                                     double sigma_m) {
  std::vector<PanTiltSample> samples;
  for (int i = 0; i < poses; ++i) {
    PanTiltSample sample{"pose" + std::to_string(i), {}, Pose::Identity()};
    sample.angles = {uniform(random, -1.5, 1.5),
                     uniform(random, -0.8, 0.8),
                     {uniform(random, -1, 1) > 0 ? 1 : -1, uniform(random, -1, 1) > 0 ? 1 : -1}};
    sample.T_world_camera = noisy(camera_pose(model, sample.angles), random, sigma_rad, sigma_m);
    samples.push_back(std::move(sample));
  }
  return samples;
}

}  // namespace foresight
