#include "apps/bench/camera_bench.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/cpu_time.hpp"
#include "common/numbers_file.hpp"
#include "drivers/camera/stereo_camera.hpp"
#include "sim/live_view/mock_camera.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr double kLargestCameraShare = 0.1;

struct Round {
  double seconds = 0, process = 0, copying = 0, consuming = 0;  ///< CPU time but for `seconds`
  std::uint64_t pairs = 0;

  double other() const { return copying + consuming; }
  double per_pair(double cpu) const { return pairs ? cpu / static_cast<double>(pairs) : 0; }
};

Round measure(const std::shared_ptr<sim::MockStereo>& stereo, double rate, double length, MonotonicClock& clock) {
  stereo->set_rate(rate);
  PairingOptions pairing;
  pairing.tolerance = 1ms;  // both cameras see the same instant
  StereoCamera cameras(std::make_unique<sim::MockCamera>("left", Side::left, stereo),
                       std::make_unique<sim::MockCamera>("right", Side::right, stereo), clock, pairing);
  cameras.start();
  for (int i = 0; i < 3; ++i) cameras.take(5s);  // shaders are compiled with the first images
  const auto cpu = [&] {
    return Round{to_seconds(clock.now() - RobotTime{}), cpu_seconds(CLOCK_PROCESS_CPUTIME_ID), stereo->copying_cpu_s(),
                 stereo->consumers_cpu_s() + cpu_seconds(CLOCK_THREAD_CPUTIME_ID)};
  };
  const Round before = cpu();
  std::uint64_t pairs = 0;
  while (to_seconds(clock.now() - RobotTime{}) - before.seconds < length)
    if (cameras.take(200ms)) ++pairs;
  const Round after = cpu();
  cameras.stop();
  return {after.seconds - before.seconds, after.process - before.process, after.copying - before.copying,
          after.consuming - before.consuming, pairs};
}

}  // namespace

int bench_camera(const CameraBenchOptions& options) {
  MonotonicClock clock;
  sim::SynthOptions synth;
  synth.width = options.width;
  synth.height = options.height;
  sim::MockCameraOptions mock;
  mock.lenses.left = sim::synth_lens(synth, false);
  mock.lenses.right = sim::synth_lens(synth, true);
  const auto world = std::make_shared<const sim::LiveLab>(sim::LiveLab::Options{});
  const RobotTime start = clock.now();
  const auto stereo = std::make_shared<sim::MockStereo>(
      world,
      [start](std::string_view joint, RobotTime t) { return sim::shafts_in_motion(joint, to_seconds(t - start)); },
      mock, clock);
  const Round quick = measure(stereo, 1000, options.seconds, clock);
  const Round steady = measure(stereo, options.rate, options.seconds, clock);

  const double share = steady.per_pair(steady.other()) * options.rate;
  std::printf("%d x %d px stereo                       pairs/s   CPU-ms per pair: rendering   copying   all else\n",
              options.width, options.height);
  nlohmann::json all;
  for (const auto& [name, round] :
       {std::pair("as quick as they come", quick), std::pair("at the rate asked", steady)}) {
    std::printf("%-36s %9.1f %28.2f %9.3f %10.3f\n", name, static_cast<double>(round.pairs) / round.seconds,
                1e3 * round.per_pair(round.process - round.other()), 1e3 * round.per_pair(round.copying),
                1e3 * round.per_pair(round.consuming));
    all[name] = {{"pairs_per_s", static_cast<double>(round.pairs) / round.seconds},
                 {"rendering_ms", 1e3 * round.per_pair(round.process - round.other())},
                 {"copying_ms", 1e3 * round.per_pair(round.copying)},
                 {"consuming_ms", 1e3 * round.per_pair(round.consuming)}};
  }
  const bool met = steady.pairs > 0 && share < kLargestCameraShare;
  std::printf("not rendering, at %.3g Hz: %.2f %% of a core (limit 10 %%: %s)\n", options.rate, 100 * share,
              met ? "met" : "MISSED");
  all["share_of_core_not_rendering"] = share;
  write_numbers(options.json, all.dump(2));
  return met ? 0 : 1;
}

}  // namespace foresight
