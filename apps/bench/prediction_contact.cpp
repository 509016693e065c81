#include "apps/bench/prediction_contact.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

#include "apps/bench/prediction_contact_lab.hpp"
#include "apps/bench/prediction_contact_peers.hpp"
#include "apps/bench/prediction_ik_poses.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "prediction/contact/sliding_hand.hpp"

namespace foresight {
namespace {

using Poses = std::vector<std::vector<double>>;

constexpr double kAgree = 1e-6;  // m between two libraries' distances

struct Times {
  std::vector<double> ms;

  template <typename Call>
  auto operator()(const Call& call) {
    const double from = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    auto out = call();
    ms.push_back(1e3 * (cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - from));
    return out;
  }
  double mean() const {
    double sum = 0;
    for (const double x : ms) sum += x;
    return ms.empty() ? 0 : sum / static_cast<double>(ms.size());
  }
};

struct Subject {
  Times touching, distances, least;
};

void report(const char* name, const char* key, const Subject& subject, nlohmann::json& all) {
  const std::pair<const char*, const Times*> rows[] = {
      {"touching", &subject.touching}, {"distances", &subject.distances}, {"least", &subject.least}};
  std::printf("%-28s", name);
  for (const auto& [what, times] : rows) {
    const double p99 = quantile(times->ms, 0.99);
    if (times->ms.empty())
      std::printf("  %17s", "-");
    else
      std::printf("  %8.3f %8.3f", times->mean(), p99);
    all[std::string(key) + what + "_mean_ms"] = times->ms.empty() ? nlohmann::json() : nlohmann::json(times->mean());
    all[std::string(key) + what + "_p99_ms"] = times->ms.empty() ? nlohmann::json() : nlohmann::json(p99);
  }
  std::printf("\n");
}

// What was asked about each pose, and how the answers compare.
struct Answers {
  std::vector<std::vector<PartPair>> touching;
  std::vector<std::vector<double>> distances;
  std::vector<double> least;
};

std::vector<PartPair> sorted(std::vector<PartPair> pairs) {
  for (PartPair& pair : pairs)
    if (pair[0] < pair[1]) std::swap(pair[0], pair[1]);
  std::ranges::sort(pairs);
  return pairs;
}

Answers ask(ContactModel& model, const Poses& poses, Subject& subject) {
  Answers out;
  for (const auto& q : poses) {
    const auto touching = subject.touching([&] {
      model.pose(q);
      return model.touching();
    });
    std::vector<PartPair> pairs;
    for (const std::size_t couple : touching) pairs.push_back(model.parts_of(couple));
    out.touching.push_back(sorted(std::move(pairs)));
  }
  model.forget();
  for (const auto& q : poses) {
    const auto near = subject.distances([&] {
      model.pose(q);
      return model.near();
    });
    std::vector<double> distances;
    for (const Nearness& n : near) distances.push_back(n.distance);
    out.distances.push_back(std::move(distances));
  }
  model.forget();
  for (const auto& q : poses) {
    const auto least = subject.least([&] {
      model.pose(q);
      return model.least();
    });
    out.least.push_back(least ? least->distance : kContactReach);
  }
  return out;
}

Answers ask(ContactPeer& peer, ContactModel& model, const Poses& poses, std::size_t distances, Subject& subject) {
  Answers out;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    model.pose(poses[i]);
    std::vector<Pose> placed;
    for (std::size_t k = 0; k < model.parts(); ++k) placed.push_back(model.T_world_part(k));
    out.touching.push_back(sorted(subject.touching([&] {
      peer.place(placed);
      return peer.touching();
    })));
    if (i >= distances) continue;
    out.distances.push_back(subject.distances([&] {
      peer.place(placed);
      return peer.distances(kContactReach);
    }));
    std::ranges::sort(out.distances.back());
    const auto least = subject.least([&] {
      peer.place(placed);
      return peer.least(kContactReach);
    });
    out.least.push_back(least.value_or(kContactReach));
  }
  return out;
}

double same_touching(const Answers& a, const Answers& b) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.touching.size(); ++i) same += a.touching[i] == b.touching[i];
  return a.touching.empty() ? 1 : static_cast<double>(same) / static_cast<double>(a.touching.size());
}

// Distances at the very end of the reach may be counted by one alone.
double largest_difference(const Answers& a, const Answers& b) {
  double most = 0;
  for (std::size_t i = 0; i < std::min(a.distances.size(), b.distances.size()); ++i) {
    most = std::max(most, std::abs(a.least[i] - b.least[i]));
    for (std::size_t k = 0; k < std::max(a.distances[i].size(), b.distances[i].size()); ++k) {
      const double one = k < a.distances[i].size() ? a.distances[i][k] : kContactReach;
      const double other = k < b.distances[i].size() ? b.distances[i][k] : kContactReach;
      most = std::max(most, std::abs(one - other));
    }
  }
  return most;
}

struct Subjects {
  Subject ours, fcl, bullet;
};

bool judge(ContactLab& lab, ContactPeer& fcl, ContactPeer& bullet, const Poses& poses, std::size_t peer_poses,
           const std::string& prefix, nlohmann::json& all) {
  Subjects subjects;
  ContactModel& model = *lab.model;
  const Answers ours = ask(model, poses, subjects.ours);
  const Answers theirs = ask(fcl, model, poses, 10 * peer_poses, subjects.fcl);
  const Answers bullets =
      ask(bullet, model,
          {poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(std::min(poses.size(), 10 * peer_poses))},
          peer_poses, subjects.bullet);
  report("prediction/contact", prefix.c_str(), subjects.ours, all);
  report("FCL, plain", (prefix + "fcl_").c_str(), subjects.fcl, all);
  report("Bullet, plain", (prefix + "bullet_").c_str(), subjects.bullet, all);
  double touching = 0, near = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    touching += ours.touching[i].empty() ? 0 : 1;
    near += static_cast<double>(ours.distances[i].size());
  }
  const double count = std::max(1.0, static_cast<double>(poses.size()));
  const double agree = same_touching(ours, theirs), differ = largest_difference(ours, theirs);
  Answers compared = ours;
  compared.touching.resize(bullets.touching.size());
  const double bullet_agree = same_touching(compared, bullets);
  all[prefix + "touching_agree"] = agree;
  all[prefix + "bullet_touching_agree"] = bullet_agree;
  all[prefix + "distances_differ_mm"] = 1e3 * differ;
  all[prefix + "bullet_distances_differ_mm"] = 1e3 * largest_difference(ours, bullets);
  all[prefix + "touching"] = touching / count;
  all[prefix + "near_couples"] = near / count;
  std::printf(
      "  %.1f %% of poses with contact, %.1f couples within 50 mm; the same touch as FCL says in %.2f %%, as Bullet "
      "says in %.2f %%; distances differ from FCL's by up to %.6f mm\n\n",
      100 * touching / count, near / count, 100 * agree, 100 * bullet_agree, 1e3 * differ);
  return agree == 1 && differ < kAgree;
}

// The arm that is shown, after a hand that heeds nothing.
bool follow_hand(ContactLab& lab, const Poses& poses, nlohmann::json& all) {
  for (const char* key : {"hand_mean_ms", "hand_p99_ms", "hand_contact", "hand_touching"}) all[key] = nullptr;
  ContactModel& model = *lab.model;
  const auto free = std::ranges::find_if(poses, [&](const std::vector<double>& q) {
    model.pose(q);
    return model.touching().empty();
  });
  if (free == poses.end()) return true;
  std::unique_ptr<InverseKinematics> kinematics;
  try {
    kinematics = std::make_unique<InverseKinematics>(arm_chain(lab.robot, lab.hand, lab.robot.links[0].name, "robot"));
  } catch (const InputError& e) {
    std::printf("no arm to show: %s\n", e.what());
    return true;
  }
  SlidingHand hand(model, *kinematics, lab.joints, *free, lab.T_world_root, nullptr, "robot");
  constexpr double kPicture = 1.0 / 60, kSpeed = 0.5;
  Times times;
  std::size_t contact = 0, touching = 0;
  UniformJoints joints(kinematics->chain(), 3);
  Pose wanted = kinematics->chain().tip_pose(joints.next()), target = wanted;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i % 60 == 0) target = kinematics->chain().tip_pose(joints.next());
    const double left = (target.translation() - wanted.translation()).norm();
    wanted = pose_between(wanted, target, std::min(1.0, kSpeed * kPicture / std::max(left, 1e-9)));
    const HandStep step = times([&] { return hand.step(wanted, hand.positions(), {}, kPicture); });
    contact += step.ghost.reason == GhostReason::contact;
    model.pose(step.positions);
    touching += !model.touching().empty();
  }
  const double count = std::max(1.0, static_cast<double>(poses.size()));
  all["hand_mean_ms"] = times.mean();
  all["hand_p99_ms"] = quantile(times.ms, 0.99);
  all["hand_contact"] = static_cast<double>(contact) / count;
  all["hand_touching"] = static_cast<double>(touching) / count;
  std::printf(
      "the arm that is shown: %.2f ms a picture, p99 %.2f; contact stops it in %.1f %% of them; it touches in %zu\n",
      times.mean(), quantile(times.ms, 0.99), 100 * static_cast<double>(contact) / count, touching);
  return touching == 0;
}

}  // namespace

int bench_prediction_contact(const PredictionContactOptions& options) {
  ContactLab lab = make_contact_lab(options.urdf, static_cast<std::size_t>(options.triangles));
  const std::vector<const Mesh*> meshes = lab.meshes();
  std::vector<PartPair> pairs;
  std::vector<bool> robot(meshes.size(), false);
  for (std::size_t i = 0; i < lab.model->couples(); ++i) {
    pairs.push_back(lab.model->parts_of(i));
    robot[pairs.back()[0]] = true;
  }
  for (std::size_t i = 0; i < meshes.size(); ++i)
    robot[i] =
        robot[i] || std::ranges::find(lab.robot.links, lab.model->part_name(i), &Node::name) != lab.robot.links.end();
  nlohmann::json all;
  all["couples"] = pairs.size();
  all["triangles"] = lab.triangles;
  all["scene_triangles"] = lab.scene.triangle_count();
  std::printf("%s: %zu triangles with what it carries, %zu in the scene, %zu couples of parts\n",
              lab.robot.name.c_str(), lab.triangles, lab.scene.triangle_count(), pairs.size());
  for (const std::string& both : lab.model->always_overlapping())
    std::printf("  %s always overlap: left out\n", both.c_str());
  const auto fcl = make_fcl_peer(meshes, robot, pairs);
  const auto bullet = make_bullet_peer(meshes, pairs);
  std::printf("\n%-28s  %17s  %17s  %17s\n", "CPU-ms a picture: mean, p99", "touching", "all within 50 mm",
              "the nearest");
  const auto count = static_cast<std::size_t>(options.poses), few = static_cast<std::size_t>(options.peer_poses);
  std::printf("anywhere\n");
  const bool anywhere = judge(lab, *fcl, *bullet, uniform_poses(lab, count), few, "", all);
  std::printf("in motion\n");
  const bool moving = judge(lab, *fcl, *bullet, motion_poses(lab, count), few, "motion_", all);
  const bool stopped = follow_hand(lab, uniform_poses(lab, count), all);
  write_numbers(options.json, all.dump(2));
  return anywhere && moving && stopped ? 0 : 1;
}

}  // namespace foresight
