#include "apps/bench/prediction_ik.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/prediction_ik_poses.hpp"
#include "apps/bench/prediction_kdl.hpp"
#include "apps/bench/prediction_paths.hpp"
#include "common/cpu_time.hpp"
#include "common/numbers_file.hpp"

namespace foresight {
namespace {

constexpr double kLimitTolerance = 1e-12;
constexpr double kTurnedExactly = 1e-6;  // m and rad: fewer than six joints get there in the end of a descent
constexpr double kPeerTolerance = 1e-4;  // m and rad: what KDL is asked for is 1e-5 or less

// The tip by the frames of the URDF, joint by joint: another way than the one that inverse kinematics takes.
class Judge {
 public:
  Judge(const PredictionIkOptions& options, const ArmChain& chain)
      : chain_(chain), robot_(read_urdf(options.urdf, options.urdf.parent_path(), UrdfShapes::none)) {
    int link = find(options.tip);
    for (const int base = options.base.empty() ? 0 : find(options.base); link != base;
         link = robot_.links[static_cast<std::size_t>(link)].parent)
      joints_.insert(joints_.begin(), driven(static_cast<std::size_t>(link - 1)));
  }
  Pose tip(const JointVector& q) const {
    Pose T = Pose::Identity();
    for (const Driven& joint : joints_) {
      const double at = joint.offset + (joint.by < 0 ? 0 : joint.factor * q[joint.by]);
      T = T * joint.joint->T_parent_joint * joint_transform(*joint.joint, at);
    }
    return T;
  }
  bool reaches(const JointVector& q, const Pose& target, double tolerance, bool position_only) const {
    if (!chain_.within_limits(q, kLimitTolerance)) return false;
    const Vector6 miss = pose_difference(tip(q), target);
    return miss.head<3>().norm() <= tolerance && (position_only || miss.tail<3>().norm() <= tolerance);
  }

 private:
  struct Driven {
    const UrdfJoint* joint;
    Eigen::Index by;  // of the chain's joints; -1: none
    double factor, offset;
  };
  Driven driven(std::size_t index) const {
    const JointSource source = source_of(robot_, index);
    const std::string& leader = robot_.joints[static_cast<std::size_t>(source.joint)].name;
    const auto by = std::ranges::find(chain_.joints(), leader, &ArmJoint::name);
    const bool none = by == chain_.joints().end();
    return {&robot_.joints[index], none ? -1 : by - chain_.joints().begin(), source.factor, source.offset};
  }
  int find(const std::string& name) const {
    std::size_t i = 0;
    while (robot_.links[i].name != name) ++i;  // read_arm_chain has found it before
    return static_cast<int>(i);
  }

  const ArmChain& chain_;
  UrdfRobot robot_;
  std::vector<Driven> joints_;
};

struct Solved {
  std::size_t count = 0, solved = 0;
  double seconds = 0, slowest = 0;

  double share() const { return static_cast<double>(solved) / static_cast<double>(std::max<std::size_t>(count, 1)); }
  double mean_us() const { return seconds * 1e6 / static_cast<double>(std::max<std::size_t>(count, 1)); }
};

Solved solve_all(const std::vector<Pose>& targets, std::size_t count,
                 const std::function<JointVector(const Pose&)>& solver,
                 const std::function<bool(const JointVector&, const Pose&)>& judge) {
  Solved all;
  for (std::size_t i = 0; i < std::min(count, targets.size()); ++i) {
    const double from = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    const JointVector q = solver(targets[i]);
    const double seconds = cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - from;
    all.seconds += seconds;
    all.slowest = std::max(all.slowest, seconds);
    ++all.count;
    all.solved += judge(q, targets[i]);
  }
  return all;
}

void print(const char* name, const Solved& s) {
  std::printf("%-44s %9zu %10.4f %% %10.2f us %10.1f us\n", name, s.count, s.share() * 100, s.mean_us(),
              s.slowest * 1e6);
}

void add(nlohmann::json& all, const std::string& prefix, const Solved& s) {
  all[prefix + "solved"] = s.share();
  all[prefix + "mean_us"] = s.mean_us();
  all[prefix + "max_us"] = s.slowest * 1e6;
  all[prefix + "poses"] = s.count;
}

double share(std::size_t part, std::size_t all) {
  return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(all, 1));
}

void report(const FollowFigures& f, nlohmann::json& all) {
  std::printf("\n%zu paths, %zu cycles: %.1f us a cycle, %.0f us the slowest; %zu ends reached\n", f.paths, f.cycles,
              f.cpu_seconds * 1e6 / static_cast<double>(std::max<std::size_t>(f.cycles, 1)), f.slowest_cycle * 1e6,
              f.ends_reached);
  std::printf("  poses within reach      %8.3f %%\n  followed exactly        %8.3f %%\n",
              100 * share(f.reachable, f.asked), 100 * share(f.exact, f.cycles));
  std::printf("  slowed                  %8.3f %%\n", 100 * share(f.slowed, f.cycles));
  for (const auto& [reason, count] : f.slowed_by)
    std::printf("    %-20s  %8.3f %%\n", reason.c_str(), 100 * share(count, f.cycles));
  std::printf("  stopped                 %8.3f %%\n", 100 * share(f.stopped, f.cycles));
  for (const auto& [reason, count] : f.stopped_by)
    std::printf("    %-20s  %8.3f %%\n", reason.c_str(), 100 * share(count, f.cycles));
  std::printf("  largest step of a joint %8.5f of velocity * dt\n", f.largest_step_over_limit);
  all["paths"] = f.paths;
  all["paths_ends_reached"] = share(f.ends_reached, f.paths);
  all["cycles"] = f.cycles;
  all["cycle_mean_us"] = f.cpu_seconds * 1e6 / static_cast<double>(std::max<std::size_t>(f.cycles, 1));
  all["cycle_max_us"] = f.slowest_cycle * 1e6;
  all["reachable"] = share(f.reachable, f.asked);
  all["followed_exactly"] = share(f.exact, f.cycles);
  all["slowed"] = share(f.slowed, f.cycles);
  all["stopped"] = share(f.stopped, f.cycles);
  all["slowed_by"] = all["stopped_by"] = nlohmann::json::object();
  for (const auto& [reason, count] : f.slowed_by) all["slowed_by"][reason] = share(count, f.cycles);
  for (const auto& [reason, count] : f.stopped_by) all["stopped_by"][reason] = share(count, f.cycles);
  all["largest_step_over_limit"] = f.largest_step_over_limit;
}

void say_what_is_assumed(const ArmChain& chain) {
  for (const ArmJoint& joint : chain.joints())
    if (!joint.velocity_known)
      std::printf("joint %s: no velocity limit in the URDF, taken as %g\n", joint.name.c_str(), kAssumedVelocity);
}

}  // namespace

int bench_prediction_ik(const PredictionIkOptions& options) {
  const InverseKinematics kinematics(read_arm_chain(options.urdf, options.tip, options.base));
  const ArmChain& chain = kinematics.chain();
  const Judge judge(options, chain);
  const bool position_only = kinematics.position_first();
  std::printf("%s to %s: %s\n", options.urdf.c_str(), options.tip.c_str(), kinematics.description().c_str());
  say_what_is_assumed(chain);

  const auto paths = options.path ? recorded_paths(kinematics, *options.path)
                                  : random_paths(kinematics, static_cast<std::size_t>(options.paths));
  UniformJoints joints(chain, 1);
  std::vector<Pose> targets, at_limit;
  for (int i = 0; i < options.poses; ++i) {
    JointVector q = joints.next();
    targets.push_back(judge.tip(q));
    const auto held = static_cast<Eigen::Index>(static_cast<std::size_t>(i) % chain.size());
    const double limit = joints.any() % 2 ? chain.lower()[held] : chain.upper()[held];
    if (std::isfinite(limit)) q[held] = limit;
    at_limit.push_back(judge.tip(q));
  }

  nlohmann::json all;
  all["method"] = kinematics.description();
  all["closed_form"] = kinematics.closed_form();
  all["position_only"] = position_only;
  const auto ours = [&](const Pose& T) { return kinematics.solve(T).q; };
  const auto exact = [&](const JointVector& q, const Pose& T) { return judge.reaches(q, T, kIkExact, position_only); };
  std::printf("\n%-44s %9s %12s %13s %13s\n", "CPU time of the thread", "poses", "solved", "mean", "slowest");
  const auto count = targets.size();
  const Solved any = solve_all(targets, count, ours, exact), limit = solve_all(at_limit, count, ours, exact);
  print("uniform joints", any);
  print("one joint on its limit", limit);
  if (position_only) {
    const Solved turned = solve_all(targets, count, ours, [&](const JointVector& q, const Pose& T) {
      return judge.reaches(q, T, kTurnedExactly, false);
    });
    print("uniform joints, and turned exactly", turned);
    add(all, "turned_", turned);
  }
  add(all, "", any);
  add(all, "at_limit_", limit);

  const auto peer = make_kdl_peer(chain);
  all["kdl_solved"] = all["kdl_mean_us"] = all["kdl_lma_solved"] = all["kdl_lma_mean_us"] = nullptr;
  if (peer && options.kdl_poses > 0) {
    const auto roughly = [&](const JointVector& q, const Pose& T) {
      return judge.reaches(q, T, kPeerTolerance, position_only);
    };
    const auto kdl_count = static_cast<std::size_t>(options.kdl_poses);
    const Solved nr_jl = solve_all(targets, kdl_count, peer->nr_jl, roughly);
    const Solved lma = solve_all(targets, kdl_count, peer->lma, roughly);
    print("KDL NR_JL (middle, 1e-5, 500)", nr_jl);
    print("KDL LMA (weights 1, 1e-8, from 0)", lma);
    add(all, "kdl_", nr_jl);
    add(all, "kdl_lma_", lma);
  } else if (!peer) {
    std::printf("KDL: not built in\n");
  }

  const FollowFigures figures = follow(kinematics, paths);
  for (const PosePath& path : paths)
    if (path.scale < 1) std::printf("%s: scaled by %.3f\n", path.name.c_str(), path.scale);
  report(figures, all);
  write_numbers(options.json, all.dump(2));
  return figures.largest_step_over_limit > 1 ? 1 : 0;
}

}  // namespace foresight
