#include "apps/bench/prediction_hand.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/pose_table.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "prediction/pose_filter.hpp"

namespace foresight {
namespace {

constexpr double kLowPass = 0.03;  // s
constexpr std::size_t kFewestHandPoses = 30;
constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;

// Sums over instants of one filter.
struct HandFigures {
  double way = 0, turn = 0, bend = 0, twist = 0;  // squares
  double along = 0, speed = 0;                    // of the position's offset on its velocity
  std::size_t scored = 0, bends = 0;

  void add(const HandFigures& other) {
    way += other.way;
    turn += other.turn;
    bend += other.bend;
    twist += other.twist;
    along += other.along;
    speed += other.speed;
    scored += other.scored;
    bends += other.bends;
  }
  void write(nlohmann::json& all, const std::string& before) const {
    const auto rms = [](double sum, std::size_t count) {
      return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
    };
    all[before + "noise_mm"] = rms(way, scored) * 1e3;
    all[before + "noise_deg"] = rms(turn, scored) * kDegreesPerRadian;
    all[before + "jitter_mm"] = rms(bend, bends) * 1e3;
    all[before + "jitter_deg"] = rms(twist, bends) * kDegreesPerRadian;
    all[before + "lag_ms"] = speed > 0 ? -along / speed * 1e3 : 0;
  }
};

constexpr std::array kMethods{"filtered", "recorded", "low-pass of 30 ms"};
constexpr std::array kKeys{"", "raw_", "low_pass_"};
using AllFigures = std::array<HandFigures, kMethods.size()>;

// A stretch without gaps and jumps, and what the filters made of it.
struct Stretch {
  std::vector<PoseTrail::Sample> samples;
  std::array<std::vector<Pose>, kMethods.size()> filtered;
};

std::vector<Stretch> filter_all(const PoseTable& table, const PoseSeries& series) {
  std::vector<Stretch> all;
  PoseFilter filter;
  PoseTrail trail;
  for (std::size_t i = 0; i < series.poses.size(); ++i) {
    if (!series.poses[i]) continue;
    const Pose& pose = *series.poses[i];
    const OperatorTime time{table.time_ns[i]};
    trail.add(time, pose);
    const PoseTaken taken = filter.observe(time, pose);
    if (taken != PoseTaken::yes && taken != PoseTaken::anew) continue;
    if (taken == PoseTaken::anew) all.emplace_back();
    Stretch& stretch = all.back();
    Pose low_pass = pose;
    if (taken == PoseTaken::yes) {
      const double seconds = trail.samples().newest().stamp - stretch.samples.back().stamp;
      low_pass = pose_between(stretch.filtered[2].back(), pose, 1 - std::exp(-seconds / kLowPass));
    }
    stretch.samples.push_back(trail.samples().newest());
    stretch.filtered[0].push_back(filter.pose());
    stretch.filtered[1].push_back(pose);
    stretch.filtered[2].push_back(low_pass);
  }
  return all;
}

void score(const Stretch& stretch, AllFigures& figures) {
  LastOf<PoseTrail::Sample> samples(stretch.samples.size());
  for (const auto& sample : stretch.samples) samples.next() = sample;
  Vector6 smooth_before = Vector6::Zero();
  bool known_before = false;
  const Pose& origin = stretch.samples.front().pose;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto offset = offset_to_smooth(samples, i);
    if (!offset) {
      known_before = false;
      continue;
    }
    Vector6 smooth = *offset;
    smooth.head<3>() += samples[i].pose.translation() - origin.translation();
    const double seconds = i > 0 ? samples[i].even - samples[i - 1].even : 0;
    const Eigen::Vector3d velocity =
        known_before ? Eigen::Vector3d((smooth - smooth_before).head<3>() / seconds) : Eigen::Vector3d::Zero();
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
      const auto& poses = stretch.filtered[m];
      const Vector6 off = pose_difference(samples[i].pose, poses[i]) - *offset;
      HandFigures& f = figures[m];
      f.way += off.head<3>().squaredNorm();
      f.turn += off.tail<3>().squaredNorm();
      f.along += off.head<3>().dot(velocity);
      f.speed += velocity.squaredNorm();
      ++f.scored;
      if (i < 2) continue;
      const Vector6 bend = pose_difference(poses[i - 1], poses[i]) - pose_difference(poses[i - 2], poses[i - 1]);
      f.bend += bend.head<3>().squaredNorm();
      f.twist += bend.tail<3>().squaredNorm();
      ++f.bends;
    }
    smooth_before = smooth;
    known_before = true;
  }
}

void print(const std::string& name, const nlohmann::json& numbers) {
  std::printf("%s\n", name.c_str());
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    const auto value = [&](const char* key) { return numbers[std::string(kKeys[m]) + key].get<double>(); };
    std::printf("  %-20s lag %6.1f ms   noise %6.2f mm %6.2f deg   jitter %6.2f mm %6.2f deg\n", kMethods[m],
                value("lag_ms"), value("noise_mm"), value("noise_deg"), value("jitter_mm"), value("jitter_deg"));
  }
}

nlohmann::json numbers_of(const AllFigures& figures) {
  nlohmann::json numbers;
  for (std::size_t m = 0; m < kMethods.size(); ++m) figures[m].write(numbers, kKeys[m]);
  numbers["scored"] = figures[0].scored;
  return numbers;
}

}  // namespace

int bench_prediction_hand(const PredictionHandOptions& options) {
  const PoseTable table = read_pose_table(options.csv);
  AllFigures pooled;
  nlohmann::json poses = nlohmann::json::array();
  for (const PoseSeries& series : table.series) {
    if (series.prefix == "head_") continue;
    AllFigures figures;
    for (const Stretch& stretch : filter_all(table, series)) score(stretch, figures);
    if (figures[0].scored == 0) continue;
    const std::string name = series.prefix.empty() ? "pose" : series.prefix;
    nlohmann::json numbers = numbers_of(figures);
    print(name, numbers);
    numbers["name"] = name;
    poses.push_back(numbers);
    for (std::size_t m = 0; m < kMethods.size(); ++m) pooled[m].add(figures[m]);
  }
  if (pooled[0].scored < kFewestHandPoses)
    throw InputError(options.csv.string(), "has only " + std::to_string(pooled[0].scored) + " poses of hands to judge",
                     "name a recording of some seconds, with poses at least every 25 ms, of more than the head");
  nlohmann::json all = numbers_of(pooled);
  print("all", all);
  all["poses"] = poses;
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
