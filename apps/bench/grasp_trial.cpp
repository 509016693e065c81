#include "apps/bench/grasp_trial.hpp"

#include <array>
#include <deque>
#include <numbers>
#include <random>

#include "apps/bench/robot_trial.hpp"
#include "common/error.hpp"
#include "prediction/grasp/hand_path.hpp"
#include "prediction/grasp/thing_future.hpp"
#include "sim/arm.hpp"
#include "sim/physics/physical_lab.hpp"

namespace foresight {
namespace {

constexpr const char *kBrick = "brick_red", *kFinger = "finger", *kLink = "arm_7";
constexpr double kDepth = 0.037;  // m: finger tips above the brick's bottom
constexpr double kOpen = 0.038, kClosed = 0.016, kAbove = 0.14;
constexpr double kLook = 2.5, kLookAgain = 2.5;  // s before and after the script
constexpr double kVisible = 0.01;                // m that one sees
constexpr double kBlend = 0.3;                   // s in which a correction is shown
constexpr double kLifted = 0.005, kMissed = 0.03, kStill = 2e-4;
constexpr int kStillPictures = 6;
enum Stop : std::size_t { above, down, closed, lifted, carried, lowered, opened, left };

enum class Accident : std::size_t { none, slippery, weak, moved, lost };
constexpr std::array<const char*, 5> kAccidents = {"none", "slippery", "weak", "moved", "lost"};

Pose on_mat(double x, double y, double yaw) {
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(x, y, 0.0025);
  out.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return out;
}

double yaw_of(const Pose& T) {
  return std::atan2(T.linear()(1, 0), T.linear()(0, 0));
}

/// One brick, its script, and both sides' view of it.
struct Run {
  Accident accident = Accident::none;
  Pose start, goal;
  std::shared_ptr<sim::PhysicalLab> physics;
  std::unique_ptr<ThingFuture> things;
  RobotTime begin;
  std::optional<HandPath> path;
  RobotTime path_begin;
  double path_t = 0;  // the same in the wishes' seconds
  bool accident_done = false;
  std::optional<RobotTime> visible, noticed;
  std::optional<bool> failed;
  int moved = 0, moved_before_visible = 0;
  std::vector<std::pair<RobotTime, double>> errors;  // while carried
};

class GraspTrial {
 public:
  GraspTrial(const Rig& rig, const GraspTrialOptions& options)
      : rig_(rig),
        options_(options),
        kinematics_(arm_chain(*rig.robot, kLink, "", rig.name)),
        number_(options.first_run - 1),
        lab_(std::make_shared<const sim::LiveLab>(
            sim::LiveLab::Options{.texel = 0.02, .task = true, .loose = sim::lab_thing_names()})),
        model_(lab_->modelled_scene()) {
    figures_.sighting_hz = rig.cameras ? rig.cameras->camera(Side::left).settings.rate : 10;
    for (const ArmJoint& joint : kinematics_.chain().joints()) arm_.push_back(index_of(joint.name));
    finger_ = index_of(kFinger);
  }

  JointValues wish(double t, const JointValues& start) {
    if (!asked_) asked_ = start;
    t_ = t;
    if (run_ && run_->path) {
      const double s = t - run_->path_t;
      const JointVector q = run_->path->joints(s);
      for (std::size_t k = 0; k < arm_.size(); ++k) (*asked_)[arm_[k]] = q[static_cast<Eigen::Index>(k)];
      (*asked_)[finger_] = run_->path->grip(s);
    }
    return *asked_;
  }

  void shown(const RobotDevices& devices, RobotTime now, const PredictedRobot& robot) {
    if (robot.status == StateStatus::invalid || !asked_) return;
    if (!run_) begin_run(devices, now, robot);
    cause_accident(now);
    look(devices, now);
    run_->things->advance(robot.time, of(robot));
    shown_.push_back({robot.time, now, run_->things->thing(0).T_world_thing});
    while (!shown_.empty() && shown_.front().instant <= now) {
      judge(shown_.front());
      shown_.pop_front();
    }
    if (!run_->path && to_seconds(now - run_->begin) > kLook) plan(now);
    if (run_->path && to_seconds(now - run_->path_begin) > run_->path->seconds() + 2 * options_.delay + kLookAgain)
      end_run();
  }

  bool over() const { return number_ >= options_.first_run + options_.runs; }
  GraspTrialFigures take() { return std::move(figures_); }

 private:
  struct Picture {
    RobotTime instant, drawn;
    Pose T_world_brick;
  };
  struct Look {
    ThingSighting sighting;
    std::vector<double> joints;
  };

  std::size_t index_of(const std::string& name) const {
    for (std::size_t i = 0; i < rig_.joints.size(); ++i)
      if (rig_.joints[i].drive.name == name) return i;
    throw InputError(rig_.name, "has no joint '" + name + "'", "give a rig with the mock lab's arm and gripper");
  }
  JointPositions of(const PredictedRobot& robot) const {
    return [this, &robot](std::string_view name) -> std::optional<double> {
      for (std::size_t i = 0; i < rig_.joints.size(); ++i)
        if (rig_.joints[i].drive.name == name) return robot.position[i];
      return std::nullopt;
    };
  }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }
  Pose any_place() { return on_mat(uniform(-0.26, -0.15), uniform(-0.20, -0.09), uniform(-0.7, 0.7)); }

  void begin_run(const RobotDevices& devices, RobotTime now, const PredictedRobot& robot) {
    run_.emplace();
    std::seed_seq seed{options_.seed, static_cast<unsigned>(number_)};
    random_.seed(seed);
    run_->begin = now;
    run_->start = any_place();
    run_->goal = any_place();
    if (uniform(0, 1) < options_.failing)
      run_->accident = static_cast<Accident>(1 + random_() % (kAccidents.size() - 1));
    sim::PhysicsOptions physics;
    physics.hidden = {static_cast<unsigned>(random_()), 0.2, 0.2, 0.003, 0.03};
    physics.jaws = {kFinger};
    if (run_->accident == Accident::weak) physics.jaw_force = 0.5;
    for (sim::LooseThing& thing : physics.things)
      if (thing.name == kBrick && run_->accident == Accident::slippery) thing.surface.friction = 0.004;
    const sim::ShaftsAt shafts = [&devices](std::string_view joint, RobotTime time) {
      return devices.shaft_at(joint, time);
    };
    run_->physics = std::make_shared<sim::PhysicalLab>(lab_, shafts, now, physics);
    run_->physics->displace(kBrick, run_->start);
    ThingFutureOptions future;
    future.jaws = {kFinger};
    future.things.push_back({kBrick, 0, {}});  // the first is the one that is judged
    for (const sim::LooseThing& thing : sim::lab_things()) {
      if (thing.name == kBrick)
        future.things[0] = {thing.name, thing.mass, thing.surface};
      else
        future.things.push_back({thing.name, thing.mass, thing.surface});
    }
    const PartPoses poses = [lab = lab_](const JointPositions& joints) { return lab->modelled_state(joints); };
    run_->things = std::make_unique<ThingFuture>(model_, poses, future, robot.time, of(robot));
    shown_.clear();
    looks_.clear();
    next_look_ = now;
    still_ = 0;
    rests_since_.reset();
  }

  /// When stop `i` acts, and what comes between it and the next.
  RobotTime acts(std::size_t stop, double share = 0) const {
    const double from = run_->path->reached(stop), to = share > 0 ? run_->path->reached(stop + 1) : from;
    return run_->path_begin + seconds(std::lerp(from, to, share) + options_.delay);
  }

  void cause_accident(RobotTime now) {
    if (run_->accident_done || !run_->path) return;
    Pose brick = run_->physics->thing_at(kBrick, now);
    if (run_->accident == Accident::moved && now >= acts(above, 0.4)) {
      const double way = uniform(0, 2 * std::numbers::pi);
      brick.translation() += 0.07 * Eigen::Vector3d(std::cos(way), std::sin(way), 0);
    } else if (run_->accident == Accident::lost && now >= acts(lifted, 0.5)) {
      brick.translation().z() -= 0.075;
    } else {
      return;
    }
    run_->physics->displace(kBrick, brick);
    run_->accident_done = true;
  }

  void look(const RobotDevices& devices, RobotTime now) {
    if (now >= next_look_) {
      next_look_ = next_look_ + seconds(1 / figures_.sighting_hz);
      Look look{{0, now, run_->physics->thing_at(kBrick, now), options_.sighting_sigma, options_.sighting_sigma_rad},
                {}};
      Pose& T = look.sighting.T_world_thing;
      Eigen::Vector3d turn;
      for (int k = 0; k < 3; ++k) {
        T.translation()[k] += normal(options_.sighting_sigma);
        turn[k] = normal(options_.sighting_sigma_rad);
      }
      T.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * T.linear();
      for (const RigJoint& joint : rig_.joints)
        look.joints.push_back(devices.shaft_at(joint.drive.name, now).value_or(0));
      looks_.push_back(std::move(look));
    }
    for (; !looks_.empty() && looks_.front().sighting.captured + seconds(options_.delay) <= now; looks_.pop_front()) {
      const JointPositions joints = [&](std::string_view name) -> std::optional<double> {
        for (std::size_t i = 0; i < rig_.joints.size(); ++i)
          if (rig_.joints[i].drive.name == name) return looks_.front().joints[i];
        return std::nullopt;
      };
      if (run_->things->correct(looks_.front().sighting, &joints) != SightingResult::moved || !run_->path) continue;
      ++run_->moved;
      if (!run_->visible) ++run_->moved_before_visible;
      if (run_->visible && !run_->noticed) run_->noticed = now;
    }
  }

  /// The tool with its tips at the brick's `height` above its bottom, and the fingers at two of its sides.
  Pose reach(const Pose& T_world_brick, double height, double yaw) const {
    const Eigen::Vector3d tips = T_world_brick.translation() + Eigen::Vector3d(0, 0, height);
    return rig_.T_world_robot.inverse() * sim::pointing_down(tips, yaw);
  }

  /// By what is shown, as an operator does.
  void plan(RobotTime now) {
    const Pose brick = run_->things->thing(0).T_world_thing;
    JointVector from(static_cast<Eigen::Index>(arm_.size()));
    for (std::size_t k = 0; k < arm_.size(); ++k) from[static_cast<Eigen::Index>(k)] = (*asked_)[arm_[k]];
    for (int quarter : {0, 1, 3, 2}) {
      const double yaw = yaw_of(brick) + quarter * std::numbers::pi / 2, turn = yaw_of(run_->goal) - yaw_of(brick);
      const double high = kDepth + kAbove, low = kDepth + 0.002;
      const HandStop stops[] = {{"above", reach(brick, high, yaw), kOpen, 3, true},
                                {"down", reach(brick, kDepth, yaw), kOpen, 1.5},
                                {"close", reach(brick, kDepth, yaw), kClosed, 1.2},
                                {"lift", reach(brick, high, yaw), kClosed, 1.2},
                                {"carry", reach(run_->goal, high, yaw + turn), kClosed, 1.8},
                                {"lower", reach(run_->goal, low, yaw + turn), kClosed, 1.2},
                                {"open", reach(run_->goal, low, yaw + turn), kOpen, 1},
                                {"leave", reach(run_->goal, high, yaw + turn), kOpen, 1.2}};
      try {
        run_->path.emplace(kinematics_, from, (*asked_)[finger_], stops);
        break;
      } catch (const InputError&) {  // with the fingers at the other sides, then
        if (quarter == 2) throw;
      }
    }
    run_->path_begin = now;
    run_->path_t = t_;
  }

  void judge(const Picture& picture) {
    const Pose truth = run_->physics->thing_at(kBrick, picture.instant);
    const bool gripped = run_->physics->gripped(kBrick);
    const bool still = (truth.translation() - last_truth_).norm() < kStill;
    last_truth_ = truth.translation();
    still_ = still ? still_ + 1 : 0;
    if (still_ < kStillPictures) rests_since_.reset();
    if (still_ == kStillPictures) rests_since_ = picture.instant;
    if (!run_->path || picture.instant < run_->path_begin) return;
    const double error = (picture.T_world_brick.translation() - truth.translation()).norm();
    if (error > kVisible && !run_->visible) run_->visible = picture.instant;
    if (!run_->failed && picture.instant >= acts(carried)) run_->failed = !gripped;
    if (picture.instant < acts(closed)) return;
    if (gripped && truth.translation().z() > run_->start.translation().z() + kLifted)
      run_->errors.emplace_back(picture.instant, error);
    if (!rests_since_) return;
    const double seen_after = options_.delay + 2 / figures_.sighting_hz + kBlend;
    const bool seen = picture.drawn >= *rests_since_ + seconds(seen_after);
    if (judged()) (seen ? figures_.rest : figures_.unseen).push_back(error);
  }

  void end_run() {
    GraspRun out;
    out.number = number_;
    out.accident = kAccidents[static_cast<std::size_t>(run_->accident)];
    const bool missed = (last_truth_ - run_->goal.translation()).head<2>().norm() > kMissed;
    out.failed = run_->failed.value_or(true) || missed;
    if (run_->visible) out.visible = to_seconds(*run_->visible - run_->path_begin);
    if (run_->noticed) out.lateness = to_seconds(*run_->noticed - *run_->visible) - options_.delay;
    out.put_elsewhere = run_->moved;
    out.before_visible = run_->moved_before_visible;
    if (judged()) {
      for (const auto& [instant, error] : run_->errors)
        if (!out.failed || !run_->visible || instant < *run_->visible) figures_.carried.push_back(error);
      figures_.runs.push_back(out);
    }
    ++number_;
    run_.reset();
  }
  /// The drives are learnt in the first.
  bool judged() const { return number_ >= options_.first_run; }

  const Rig& rig_;
  GraspTrialOptions options_;
  InverseKinematics kinematics_;
  std::mt19937_64 random_;
  int number_;
  std::shared_ptr<const sim::LiveLab> lab_;
  SceneModel model_;
  std::vector<std::size_t> arm_;
  std::size_t finger_ = 0;
  GraspTrialFigures figures_;
  std::optional<JointValues> asked_;
  double t_ = 0;
  std::optional<Run> run_;
  std::deque<Picture> shown_;
  std::deque<Look> looks_;
  RobotTime next_look_;
  Eigen::Vector3d last_truth_ = Eigen::Vector3d::Zero();
  int still_ = 0;
  std::optional<RobotTime> rests_since_;
};

}  // namespace

GraspTrialFigures try_grasps(const Rig& rig, const GraspTrialOptions& options) {
  if (!rig.robot || !sim::is_lab_arm(*rig.robot, rig.T_world_robot))
    throw InputError(rig.name, "its robot is not the mock lab's arm, among whose things it is to grasp",
                     "give configs/minerva.yaml, or a rig like it");
  GraspTrial trial(rig, options);
  RobotTrialOptions robot;
  robot.line.up.delay = robot.line.down.delay = seconds(options.delay);
  robot.line.seed = options.seed;
  robot.seconds = 60.0 * (options.runs + 2);
  RobotTrialHooks hooks;
  hooks.wish = [&](double t, const JointValues& start) { return trial.wish(t, start); };
  hooks.shown = [&](const RobotDevices& devices, RobotTime now, const PredictedRobot& shown) {
    trial.shown(devices, now, shown);
  };
  hooks.over = [&] { return trial.over(); };
  try_robot(rig, robot, hooks);
  return trial.take();
}

}  // namespace foresight
