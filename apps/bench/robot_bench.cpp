#include "apps/bench/robot_bench.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/cpu_time.hpp"
#include "common/numbers_file.hpp"
#include "common/real_time.hpp"
#include "drivers/robot/robot.hpp"
#include "rig/robot_devices.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

/// A thread that only wakes up: what the machine itself makes of such a loop.
LoopStatistics empty_loop(Clock& clock, Duration period, const std::stop_token& stop) {
  make_real_time(priority::kControlLoop);
  LoopStatistics out;
  for (RobotTime due = clock.now() + period; !stop.stop_requested(); due = std::max(due + period, clock.now())) {
    clock.sleep_until(due);
    out.count(clock.now() - due, period);
  }
  return out;
}

/// All joints to and fro over a small part of their range.
MotionCommand wave(const Rig& rig, RobotTime now, double t, std::uint64_t sequence) {
  MotionCommand out{1, sequence, now, sequence > 20, rig.joints.size(), {}};
  for (std::size_t i = 0; i < rig.joints.size(); ++i) {
    const DriveConfig& d = rig.joints[i].drive;
    const double middle = std::clamp(0.0, d.min_position, d.max_position);
    const double at = middle + 0.1 * (d.max_position - middle) * (1 - std::cos(t));
    out.position[i] = std::clamp(at, d.min_position, d.max_position);
  }
  return out;
}

nlohmann::json to_json(const LoopStatistics& loop) {
  return {{"cycles", loop.cycles()},
          {"overruns", loop.overruns()},
          {"lateness_p50_us", 1e6 * to_seconds(loop.quantile(0.5))},
          {"lateness_p99_us", 1e6 * to_seconds(loop.quantile(0.99))},
          {"lateness_worst_us", 1e6 * to_seconds(loop.worst())}};
}

void print(const char* name, const LoopStatistics& loop) {
  std::printf("%-14s %7llu cycles  %5llu overruns  lateness p50 %7.0f us  p99 %7.0f us  worst %7.0f us\n", name,
              static_cast<unsigned long long>(loop.cycles()), static_cast<unsigned long long>(loop.overruns()),
              1e6 * to_seconds(loop.quantile(0.5)), 1e6 * to_seconds(loop.quantile(0.99)),
              1e6 * to_seconds(loop.worst()));
}

bool wait_for_ready(Robot& robot, Clock& clock) {
  const RobotTime until = clock.now() + 60s;
  robot.ask(RobotRequest::enable);
  while (robot.status().phase != RobotPhase::ready && clock.now() < until) clock.sleep_until(clock.now() + 10ms);
  robot.ask(RobotRequest::home);
  clock.sleep_until(clock.now() + 100ms);
  while (!(robot.status().phase == RobotPhase::ready && robot.status().all_homed) && clock.now() < until)
    clock.sleep_until(clock.now() + 10ms);
  return robot.status().phase == RobotPhase::ready;
}

}  // namespace

int bench_robot(const RobotBenchOptions& options) {
  const Rig rig = read_rig(options.rig);
  MonotonicClock clock;
  RobotDeviceOptions mock;
  mock.mock = true;
  RobotDevices devices(rig, clock, mock);
  const auto shape = rig.shape();
  Robot robot(rig.gate_options(), shape.get(), devices.networks(), devices.drives());
  const Duration period = seconds(1 / rig.rate_hz);
  LoopStatistics empty;
  double loop_cpu = 0, all_cpu = 0, wall = 0;
  bool followed = false;
  {
    clockid_t loop_clock{};
    std::atomic<bool> known = false;
    devices.bring_up([](const std::string&) {});
    std::jthread loop([&](const std::stop_token& stop) {
      pthread_getcpuclockid(pthread_self(), &loop_clock);
      known = true;
      make_real_time(priority::kControlLoop);
      robot.run(clock, stop);
    });
    while (!known) std::this_thread::yield();
    if (wait_for_ready(robot, clock)) {
      std::jthread idle([&](const std::stop_token& stop) { empty = empty_loop(clock, period, stop); });
      const RobotTime start = clock.now();
      loop_cpu = -cpu_seconds(loop_clock);
      all_cpu = -cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
      std::uint64_t sequence = 0;
      for (RobotTime due = start; to_seconds(due - start) < options.seconds; due = due + 10ms) {
        clock.sleep_until(due);
        robot.submit(wave(rig, clock.now(), to_seconds(due - start), ++sequence));
      }
      wall = to_seconds(clock.now() - start);
      loop_cpu += cpu_seconds(loop_clock);
      all_cpu += cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
      followed = robot.status().gate.state == GateState::following;
    }
  }
  const RobotStatus status = robot.status();
  std::printf("%zu drives at %.0f Hz for %.0f s on in-process buses%s%s\n", rig.joints.size(), rig.rate_hz, wall,
              followed ? "" : "; the robot did not follow to the end: ", followed ? "" : to_string(status.gate.reason));
  print("control loop", status.loop);
  print("empty loop", empty);
  if (wall > 0)
    std::printf("CPU: control loop %.2f %% of a core (%.0f us per cycle), all with the emulated drives %.1f %%\n",
                100 * loop_cpu / wall, 1e6 * loop_cpu / wall / rig.rate_hz, 100 * all_cpu / wall);
  if (options.json) {
    const nlohmann::json all = {{"drives", rig.joints.size()},
                                {"rate_hz", rig.rate_hz},
                                {"seconds", wall},
                                {"followed", followed},
                                {"control_loop", to_json(status.loop)},
                                {"empty_loop", to_json(empty)},
                                {"loop_cpu_share", wall > 0 ? loop_cpu / wall : 0},
                                {"all_cpu_share", wall > 0 ? all_cpu / wall : 0}};
    write_numbers(options.json, all.dump(2));
  }
  return followed ? 0 : 1;
}

}  // namespace foresight
