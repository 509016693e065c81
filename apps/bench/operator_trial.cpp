#include "apps/bench/operator_trial.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <random>

#include "apps/bench/robot_trial.hpp"
#include "common/error.hpp"
#include "input/hand_of_rig.hpp"
#include "prediction/grasp/thing_future.hpp"
#include "seat/contact_guard.hpp"
#include "seat/model_operator.hpp"
#include "seat/tool_script.hpp"
#include "sim/arm.hpp"
#include "sim/lab_task.hpp"
#include "sim/physics/physical_lab.hpp"
#include "sim/physics/rests_in_tray.hpp"

namespace foresight {
namespace {

const std::string kTaskBrick = "brick_red", kTaskTray = "tray";
const std::vector<std::string> kLooseInTask = {kTaskBrick, "brick_blue", kTaskTray};   // the rest stands still
constexpr double kImagesHz = 10, kSightingSigma = 0.0015, kSightingSigmaRad = 0.0175;  // as GraspTrialOptions
constexpr double kStartAbove = 0.22, kSlipsAt = 0.08, kSlipsBy = 0.06, kMovedAt = 0.10, kMovedBy = 0.06;  // m
constexpr double kSettles = 1;  // s before a run, for the prediction to see what there is

using SeenThings = std::array<Pose, 2>;  // brick, tray

/// All that one image shows, and where joints were.
struct OperatorImage {
  RobotTime captured;
  JointValues joints{};
  SeenThings things;
};

/// What happens in one run.
struct OperatorTask {
  std::shared_ptr<const sim::LiveLab> lab;
  std::shared_ptr<const SceneModel> model;
  std::shared_ptr<sim::PhysicalLab> physics;
  std::unique_ptr<ThingFuture> future;
  std::unique_ptr<ContactGuard> guard;
  std::unique_ptr<ModelOperator> operating;
  std::deque<OperatorImage> images;  // on their way
  OperatorImage newest;
  RobotTime next_image, begin;
  bool struck = false;
  Pose start = Pose::Identity();
};

class OperatorTrial {
 public:
  OperatorTrial(const Rig& rig, const OperatorTrialOptions& options)
      : rig_(rig), options_(options), hand_(arm_options(rig)), kinematics_(*hand_.arm), random_(options.seed) {
    for (std::size_t i = 0; i < rig.joints.size(); ++i)
      if (rig.joints[i].group == JointGroup::gripper) jaws_.push_back(i);
    if (jaws_.empty())
      throw InputError(rig.name, "has no gripper, which could take a brick", "give configs/minerva.yaml");
  }

  JointValues wish(double t, const JointValues& start) {
    if (!asked_) asked_ = start;
    const double dt = std::min(t - t_, 0.05);
    t_ = t;
    if (dt <= 0) return *asked_;
    if (approach_) {
      if (const auto next = approach_->step(dt, {}))
        asked_ = *next;
      else
        approach_.reset();
    } else if (task_ && task_->operating) {
      follow(task_->operating->hand(t - begun_), dt);
    }
    return *asked_;
  }

  void shown(const RobotDevices& devices, RobotTime now, const PredictedRobot& robot) {
    const bool valid = robot.status != StateStatus::invalid;
    if (!asked_ || over() || (!task_ && !valid)) return;
    if (!task_) begin_task(devices, now, robot);
    OperatorTask& task = *task_;
    if (valid) task.future->advance(robot.time, named(robot.position));
    take_images(devices, now);
    if (approach_) return;
    if (!task.operating) {
      if (!rests_) rests_ = now;
      if (to_seconds(now - *rests_) > kSettles + 2 * options_.delay) begin_operating(now);
      return;
    }
    strike(devices, now);
    task.guard->scene_stands(stands(robot));
    task.operating->see(t_ - begun_, sees(robot));
    const double passed = to_seconds(now - task.begin);
    // What it did last has yet to happen.
    if (task.operating->done() && !done_) done_ = now;
    if ((done_ && to_seconds(now - *done_) > options_.delay + kSettles) || passed > options_.gives_up) end_task(now);
  }

  bool over() const { return runs_.size() >= static_cast<std::size_t>(options_.runs); }
  std::vector<OperatorRun> take() { return std::move(runs_); }

 private:
  JointPositions named(const JointValues& position) const {
    return [this, position](std::string_view name) -> std::optional<double> {
      for (std::size_t i = 0; i < rig_.joints.size(); ++i)
        if (rig_.joints[i].drive.name == name) return position[i];
      return std::nullopt;
    };
  }
  double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }
  JointVector arm(const JointValues& position) const { return joints_of(position, hand_.arm_joints); }
  static Pose along_tool(const Pose& T, double z) { return T * Eigen::Translation3d(0, 0, z); }
  Pose tips(const JointValues& position) const {
    return along_tool(rig_.T_world_robot * kinematics_.chain().tip_pose(arm(position)), sim::kTips);
  }

  // As at the seat: what is sent goes into no contact, and not to where the robot's gate would hold it.
  void follow(const OperatorHand& hand, double dt) {
    const Pose T_base_tool = rig_.T_world_robot.inverse() * along_tool(hand.T_world_tool, -sim::kTips);
    const FollowStep made = task_->guard->step(*asked_, T_base_tool, dt);
    for (std::size_t i = 0; i < hand_.arm_joints.size(); ++i)
      (*asked_)[hand_.arm_joints[i]] = made.q[static_cast<Eigen::Index>(i)];
    for (const std::size_t jaw : jaws_) {
      const double most = rig_.joints[jaw].drive.max_velocity * dt;
      (*asked_)[jaw] += std::clamp(hand.opening - (*asked_)[jaw], -most, most);
    }
  }

  /// Where the hand begins: above the middle of what is to be done, the tool pointing down, the jaws open.
  std::vector<ToolStep> approach() const {
    const sim::TaskLayout at = sim::task_layout(layout());
    ToolStep there{ToolStep::What::there};
    const Eigen::Vector3d middle = 0.7 * at.brick_red.translation() + 0.3 * at.tray.translation();
    there.T_world_tool = sim::pointing_down(middle + Eigen::Vector3d(0, 0, kStartAbove), 0);
    there.seconds = 2;
    return {there, {ToolStep::What::gripper, Pose::Identity(), {ModelOperatorOptions{}.open}, 0.2}};
  }
  unsigned layout() const { return options_.seed - 1 + static_cast<unsigned>(runs_.size()); }

  void begin_task(const RobotDevices& devices, RobotTime now, const PredictedRobot& robot) {
    task_.emplace();
    rests_.reset();
    done_.reset();
    approach_.emplace(rig_, approach(), HeadSway{.pan = 0, .tilt = 0, .middle_pan = {}, .middle_tilt = {}});
    approach_->begin_at(*asked_);
    task_->lab = std::make_shared<const sim::LiveLab>(
        sim::LiveLab::Options{.texel = 0.02, .task = layout(), .loose = kLooseInTask});
    sim::PhysicsOptions physics;
    std::erase_if(physics.things, [](const sim::LooseThing& thing) {
      return std::ranges::find(kLooseInTask, thing.name) == kLooseInTask.end();
    });
    physics.hidden.seed = static_cast<unsigned>(random_());
    const sim::ShaftsAt shafts = [&devices](std::string_view joint, RobotTime time) {
      return devices.shaft_at(joint, time);
    };
    task_->physics = std::make_shared<sim::PhysicalLab>(task_->lab, shafts, now, physics);
    task_->start = task_->physics->thing_at(kTaskBrick, now);
    ThingFutureOptions future;
    for (const std::size_t jaw : jaws_) future.jaws.push_back(rig_.joints[jaw].drive.name);
    for (const std::string& name : {kTaskBrick, kTaskTray})
      for (const sim::LooseThing& thing : sim::lab_things())
        if (thing.name == name) future.things.push_back({thing.name, thing.mass, thing.surface});
    const PartPoses poses = [lab = task_->lab](const JointPositions& joints) { return lab->modelled_state(joints); };
    task_->model = std::make_shared<const SceneModel>(task_->lab->modelled_scene());
    task_->future = std::make_unique<ThingFuture>(*task_->model, poses, future, robot.time, named(robot.position));
    task_->guard = std::make_unique<ContactGuard>(rig_, hand_, task_->model);
    task_->guard->may_push(kLooseInTask);
    task_->next_image = now;
  }

  void begin_operating(RobotTime now) {
    ModelOperatorOptions options;
    options.seed = static_cast<unsigned>(random_());
    task_->operating = std::make_unique<ModelOperator>(options, OperatorHand{tips(*asked_), (*asked_)[jaws_[0]]});
    task_->begin = now;
    begun_ = t_;
  }

  void take_images(const RobotDevices& devices, RobotTime now) {
    OperatorTask& task = *task_;
    if (now >= task.next_image) {
      task.next_image = task.next_image + seconds(1 / kImagesHz);
      OperatorImage image;
      image.captured = now;
      for (std::size_t i = 0; i < rig_.joints.size(); ++i)
        image.joints[i] = devices.shaft_at(rig_.joints[i].drive.name, now).value_or(0);
      image.things = {task.physics->thing_at(kTaskBrick, now), task.physics->thing_at(kTaskTray, now)};
      task.images.push_back(image);
    }
    for (; !task.images.empty() && task.images.front().captured + seconds(options_.delay) <= now;
         task.images.pop_front()) {
      task.newest = task.images.front();
      const JointPositions joints = named(task.newest.joints);
      for (std::size_t i = 0; i < task.newest.things.size(); ++i)
        task.future->correct(sighting(i, task.newest), &joints);
    }
  }

  ThingSighting sighting(std::size_t thing, const OperatorImage& image) {
    ThingSighting out{thing, image.captured, image.things[thing], kSightingSigma, kSightingSigmaRad};
    Eigen::Vector3d turn;
    for (int k = 0; k < 3; ++k) {
      out.T_world_thing.translation()[k] += normal(kSightingSigma);
      turn[k] = normal(kSightingSigmaRad);
    }
    out.T_world_thing.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * out.T_world_thing.linear();
    return out;
  }

  bool sees_image(const PredictedRobot& robot) const {
    return !options_.predicted || robot.status == StateStatus::invalid;
  }
  OperatorSees sees(const PredictedRobot& robot) const {
    const OperatorTask& task = *task_;
    if (sees_image(robot))
      return {tips(task.newest.joints), task.newest.joints[jaws_[0]], task.newest.things[0], task.newest.things[1]};
    return {tips(robot.position), robot.position[jaws_[0]], task.future->thing(0).T_world_thing,
            task.future->thing(1).T_world_thing};
  }

  // Where the nodes are, as far as the operator is shown it.
  std::vector<Pose> stands(const PredictedRobot& robot) const {
    const OperatorTask& task = *task_;
    if (!sees_image(robot)) return task.future->poses();
    std::vector<Pose> out = task.lab->modelled_state(named(task.newest.joints));
    const std::array names{kTaskBrick, kTaskTray};
    for (std::size_t i = 0; i < names.size(); ++i)
      if (const auto node = task.model->find(names[i])) out[static_cast<std::size_t>(*node)] = task.newest.things[i];
    return out;
  }

  // The accident, once.
  void strike(const RobotDevices& devices, RobotTime now) {
    OperatorTask& task = *task_;
    if (task.struck || options_.accident == OperatorAccident::none) return;
    JointValues joints{};
    for (const std::size_t i : hand_.arm_joints)
      joints[i] = devices.shaft_at(rig_.joints[i].drive.name, now).value_or(0);
    Pose brick = task.physics->thing_at(kTaskBrick, now);
    const Eigen::Vector3d off = tips(joints).translation() - brick.translation();
    if (options_.accident == OperatorAccident::slips) {
      if (!task.physics->gripped(kTaskBrick) || brick.translation().z() < task.start.translation().z() + kSlipsAt)
        return;
      brick.translation().z() -= kSlipsBy;
    } else {
      if (off.head<2>().norm() > kAboveBrick || off.z() > kMovedAt) return;
      brick.translation() += kMovedBy * Eigen::Vector3d(-1, 0, 0);
    }
    task.physics->displace(kTaskBrick, brick);
    task.struck = true;
  }

  void end_task(RobotTime now) {
    const OperatorTask& task = *task_;
    OperatorRun run;
    run.succeeded = done_ && sim::rests_in_tray(*task.physics, kTaskBrick, task.physics->thing_at(kTaskTray, now), now);
    run.seconds = to_seconds(done_.value_or(now) - task.begin);
    run.moves = task.operating->moves();
    run.regrasps = task.operating->regrasps();
    runs_.push_back(run);
    task_.reset();
  }

  static constexpr double kAboveBrick = 0.03;  // m: the hand is above it

  const Rig& rig_;
  OperatorTrialOptions options_;
  HandOptions hand_;
  InverseKinematics kinematics_;
  std::mt19937_64 random_;
  std::vector<std::size_t> jaws_;
  std::optional<JointValues> asked_;
  std::optional<ToolScript> approach_;
  std::optional<OperatorTask> task_;
  std::optional<RobotTime> rests_, done_;
  double t_ = 0, begun_ = 0;
  std::vector<OperatorRun> runs_;
};

}  // namespace

std::vector<OperatorRun> try_operator(const Rig& rig, const OperatorTrialOptions& options) {
  if (!rig.robot || !sim::is_lab_arm(*rig.robot, rig.T_world_robot))
    throw InputError(rig.name, "its robot is not the mock lab's arm, among whose things it is to grasp",
                     "give configs/minerva.yaml, or a rig like it");
  OperatorTrial trial(rig, options);
  RobotTrialOptions robot;
  robot.line.up.delay = robot.line.down.delay = seconds(options.delay);
  robot.line.seed = options.seed;
  robot.learning = 0;
  robot.seconds = (options.gives_up + 30) * (options.runs + 1);
  robot.pictures_hz = 30;
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
