#include "apps/bench/registration_bench.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/bench_pipelines.hpp"
#include "calibration/registration/registration.hpp"
#include "common/cpu_time.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "sim/pan_tilt_head.hpp"
#include "sim/tag_room.hpp"

namespace foresight {
namespace {

constexpr double kDecimations[] = {1, 1.5, 2, 3};
constexpr double kHiddenPan = 0.006, kHiddenTilt = -0.004;  // rad: what the encoders do not know
constexpr double kEvery = 0.5;                              // seconds: beyond the window, each pair on its own

HeadModel lab_head() {
  HeadModel head;
  head.T_world_pan = sim::T_world_head_foot();
  head.T_pan_tilt.translate(Eigen::Vector3d(0, 0, 0.08));
  head.T_pan_tilt.rotate(Eigen::AngleAxisd(-std::acos(-1.0) / 2, Eigen::Vector3d::UnitX()));
  head.T_tilt_camera = T_world_camera(head, {}).inverse() * sim::T_world_head_left({});
  return head;
}

Lens lens() {
  return Lens({LensModel::plumb_bob, 640, 480, 520, 521, 318, 243, {-0.12, 0.03, 0.0004, -0.0006, 0}});
}

struct Pair {
  RobotTime time;
  HeadAngles encoders;
  Pose T_world_left;
  cv::Mat left, right;
};

std::vector<Pair> draw_pairs(int count, const sim::TagRoom& room) {
  const cv::Mat rays = sim::TagRoom::corner_rays(lens());
  std::vector<Pair> pairs;
  for (int i = 0; i < count; ++i) {
    const double t = kEvery * i;
    Pair pair{RobotTime{} + seconds(t), {0.35 * std::sin(0.9 * t), 0.5 + 0.12 * std::sin(1.3 * t)}, {}, {}, {}};
    pair.T_world_left = sim::T_world_head_left({pair.encoders.pan + kHiddenPan, pair.encoders.tilt + kHiddenTilt});
    const auto seed = static_cast<unsigned>(2 * i);
    pair.left = room.picture(rays, pair.T_world_left, 2, seed);
    pair.right = room.picture(rays, pair.T_world_left * sim::T_head_left_right(), 2, seed + 1);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

/// Root mean square over a grid of pixels that see points 1 m away.
double error_px(const Pose& truth, const Pose& found) {
  double square = 0;
  int count = 0;
  for (int v = 40; v < 480; v += 80)
    for (int u = 40; u < 640; u += 80) {
      const auto pixel = lens().project(found.inverse() * truth * *lens().unproject({u, v}));
      square += pixel ? (*pixel - Eigen::Vector2d(u, v)).squaredNorm() : 0;
      ++count;
    }
  return std::sqrt(square / count);
}

nlohmann::json measure(const std::vector<Pair>& pairs, const sim::TagRoom& room, double decimate) {
  RegistrationOptions options;
  options.detector.decimate = decimate;
  Registration registration(lab_head(), {lens(), lens(), sim::T_head_left_right()}, room.corners(), options);
  std::vector<double> costs;
  double square = 0, tags = 0, predicted = 0;
  for (const Pair& pair : pairs) {
    for (int i = -2; i <= 2; ++i) registration.add_encoders(pair.time + seconds(0.01 * i), pair.encoders);
    RegistrationResult result;
    costs.push_back(cpu_ms_of([&] { result = registration.register_pair(pair.time, pair.left, pair.right); }));
    square += std::pow(error_px(pair.T_world_left, result.T_world_left), 2);
    predicted += std::pow(result.predicted_px, 2);
    tags += result.tags.tags;
  }
  const auto n = static_cast<double>(pairs.size());
  return {{"decimate", decimate},
          {"cpu_ms", median(costs)},
          {"tags_per_pair", tags / n},
          {"with_tags_px", std::sqrt(square / n)},
          {"predicted_px", std::sqrt(predicted / n)}};
}

}  // namespace

int bench_registration(const RegistrationBenchOptions& options) {
  const sim::TagRoom room(sim::TagRoom::lab_tags());
  const auto pairs = draw_pairs(options.pairs, room);
  double encoders = 0;
  for (const Pair& pair : pairs)
    encoders += std::pow(error_px(pair.T_world_left, T_world_camera(lab_head(), pair.encoders)), 2);
  nlohmann::json all{{"encoders_only_px", std::sqrt(encoders / static_cast<double>(pairs.size()))}};
  std::printf("%zu pairs of 640x480; encoders with a hidden offset, alone: %.2f px\n", pairs.size(),
              all["encoders_only_px"].get<double>());
  std::printf("%8s %12s %14s %10s %13s\n", "decimate", "CPU-ms/pair", "tags per pair", "error px", "predicted px");
  for (const double decimate : kDecimations) {
    const nlohmann::json row = measure(pairs, room, decimate);
    std::printf("%8.1f %12.1f %14.1f %10.3f %13.3f\n", decimate, row["cpu_ms"].get<double>(),
                row["tags_per_pair"].get<double>(), row["with_tags_px"].get<double>(),
                row["predicted_px"].get<double>());
    all["rows"].push_back(row);
  }
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
