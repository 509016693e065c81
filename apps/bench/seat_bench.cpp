#include "apps/bench/seat_bench.hpp"

#include <fmt/core.h>
#include <malloc.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/bench/seat_faults.hpp"
#include "apps/operator/stepped_sides.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/resident_memory.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat.hpp"
#include "seat/tool_script.hpp"
#include "seat/tour.hpp"

namespace foresight {
namespace {

constexpr double kTellEvery = 60, kMemoryEvery = 1, kSettled = 300;  // s
constexpr double kMostGrowth = 10;                                   // MB
constexpr double kOver = 1.001;                                      // of a limit, for rounding
constexpr double kRampOver = 1.05;  // of accelerations, which are differences of differences
constexpr double kStandsFor = 1.0;  // s without a picture beyond what was asked for
constexpr double kMoves = 1e-7;     // rad or m a cycle
constexpr int kStops = 4000;

/// What the robot's side sends to its drives, against what it may.
class SetPointWatch {
 public:
  explicit SetPointWatch(const Rig& rig) : rig_(rig) {}

  /// `alone_s`: for so long nobody has held the switch, nor has a joint looked for home. From `rests_after_s` on
  /// nothing may move.
  void see(const RobotCycle& cycle, double alone_s, double rests_after_s) {
    for (std::size_t i = 0; i < cycle.joints; ++i) {
      const DriveConfig& drive = rig_.joints[i].drive;
      const JointMotion& now = cycle.joint[i].set_point;
      const double moved = std::abs(now.position - last_.joint[i].set_point.position);
      if (last_.number + 1 == cycle.number && alone_s > rests_after_s && moved > kMoves && !begins_anew(cycle.joint[i]))
        say(cycle, drive,
            fmt::format("moves by {:.1e}, {}, with nobody at the switch for {:.2f} s", moved, to_string(cycle.phase),
                        alone_s));
      if (!std::isfinite(now.position) || !std::isfinite(now.velocity)) say(cycle, drive, "is sent no number");
      if (std::abs(now.velocity) > drive.max_velocity * kOver) say(cycle, drive, "is too fast");
      if (std::abs(now.acceleration) > drive.max_acceleration * kRampOver) say(cycle, drive, "is too rough");
      if (cycle.joint[i].homed &&
          (now.position < drive.min_position - 1e-6 || now.position > drive.max_position + 1e-6))
        say(cycle, drive, "leaves its range");
    }
    last_ = cycle;
    ++cycles_;
  }
  /// The robot's program was started again.
  void begin_anew() { last_ = {}; }
  std::uint64_t cycles() const { return cycles_; }
  std::uint64_t unsafe() const { return unsafe_; }
  const std::string& first() const { return first_; }

 private:
  /// A reset puts the set-point to where the joint is measured, which moves nothing.
  static bool begins_anew(const JointCycle& joint) {
    const JointMotion& now = joint.set_point;
    return now.velocity == 0 && now.acceleration == 0 && std::abs(now.position - joint.position) <= kMoves;
  }
  void say(const RobotCycle& cycle, const DriveConfig& drive, const std::string& what) {
    if (unsafe_++ == 0)
      first_ = fmt::format("{:.2f} s: {} {}", 1e-9 * static_cast<double>(cycle.time.ns), drive.name, what);
  }
  const Rig& rig_;
  RobotCycle last_;
  std::uint64_t cycles_ = 0, unsafe_ = 0;
  std::string first_;
};

/// All that is looked at while the seat is in use.
class Endurance {
 public:
  Endurance(const Rig& rig, const SeatBenchOptions& options, SeatHand& hand, double round_trip_s)
      : rig_(rig),
        options_(options),
        hand_(hand),
        names_(rig.joint_names()),
        random_(options.seed),
        strangers_(rig),
        watch_(rig),
        rests_after_(round_trip_s + 2),
        faults_(all_faults(), random_, round_trip_s + 3) {}

  bool stands_still() const { return stands_; }

  void see(const SeatMoment& moment) {
    if (!cycles_) begin_ = moment.now;
    heed_start(moment.robot);
    const double now_s = to_seconds(moment.now - begin_);
    look_at_switch(moment, now_s);
    look_at_picture(moment, now_s);
    if (began_) faults_.step(moment, now_s, [&] { return lines(moment); });
    if (now_s < looked_s_ + kMemoryEvery) return;
    looked_s_ = now_s;
    minute_.push_back(look_at_memory(moment.texture_bytes));
    if (now_s < told_ + kTellEvery) return;
    told_ = now_s;
    memory_.push_back(Minute::of(now_s, std::exchange(minute_, {})));
    std::fprintf(stderr, "bench: seat: %.0f min, %.1f MB, at most %.1f (textures %.1f), %zu faults, %llu pictures\n",
                 now_s / 60, memory_.back().resident_mb, memory_.back().most_mb, memory_.back().textures_mb,
                 faults_.records().size(), static_cast<unsigned long long>(moment.pictures));
  }

  nlohmann::ordered_json report(const SeatTrialFigures& figures) const;
  bool met() const {
    return watch_.unsafe() == 0 && longest_gap_ <= 1 / options_.pictures_hz + kStandsFor && unnamed() == 0 &&
           drove_on() == 0 && growth() <= kMostGrowth && growth(&Minute::most_mb) <= kMostGrowth;
  }
  void print() const;

 private:
  static std::size_t arm_drives(const Rig& rig) {
    return static_cast<std::size_t>(std::ranges::count(rig.joints, rig.joints.front().bus, &RigJoint::bus));
  }
  std::vector<Fault> all_faults() {
    std::vector<Fault> out = seat_faults(arm_drives(rig_), random_, stands_);
    std::ranges::move(hand_faults(hand_, random_), std::back_inserter(out));
    std::ranges::move(start_faults(strangers_), std::back_inserter(out));
    std::erase_if(out, [&](const Fault& fault) { return fault.name.find(options_.fault) == fault.name.npos; });
    if (out.empty())
      throw InputError("--fault", "no fault has " + in_quotes(options_.fault) + " in its name", "leave it out");
    return out;
  }
  /// All that the display says.
  std::vector<SeatLine> lines(const SeatMoment& moment) const {
    std::vector<SeatLine> out = seat_lines(moment.seat.status(), names_, moment.source.fault());
    std::ranges::move(hand_.lines(), std::back_inserter(out));
    out.push_back(next_step(moment.seat.status()));
    return out;
  }
  void heed_start(SteppedRobotSide& robot) {
    if (!robot.runs() || (cycles_ && std::exchange(starts_, robot.starts()) == robot.starts())) return;
    cycles_.emplace(robot.robot().cycles());
    watch_.begin_anew();
  }
  void look_at_switch(const SeatMoment& moment, double now_s) {
    const bool held = moment.seat.status().engaged;
    began_ = began_ || held;
    if (held) held_s_ = now_s;
    const bool must_rest = strangers_.must_rest();
    while (const auto cycle = moment.robot.runs() ? cycles_->take() : std::nullopt) {
      const bool homes = cycle->phase == RobotPhase::homing || cycle->phase == RobotPhase::enabling;
      if (homes) held_s_ = now_s;
      watch_.see(*cycle, must_rest ? std::numeric_limits<double>::infinity() : now_s - held_s_, rests_after_);
    }
  }
  void look_at_picture(const SeatMoment& moment, double now_s) {
    if (moment.pictures != pictures_) {
      pictures_ = moment.pictures;
      drew_s_ = now_s;
      hand_.look(moment.source.places().place(moment.source.robot()));
    }
    if (pictures_ > 0) longest_gap_ = std::max(longest_gap_, now_s - drew_s_);
  }
  std::size_t unnamed() const {
    return static_cast<std::size_t>(std::ranges::count(faults_.records(), "", &FaultRecord::named));
  }
  std::size_t drove_on() const {
    return static_cast<std::size_t>(std::ranges::count(faults_.records(), true, &FaultRecord::drove_on));
  }
  struct Memory {
    double resident_mb = 0, textures_mb = 0;  // textures_mb: of resident_mb on a software renderer
    double gaps_mb = 0;                       // free pages of the heap, not of resident_mb
  };
  /// Of one minute, looked at each second. What stays is the median; the most holds the images that were at work then.
  struct Minute {
    double at_s = 0, resident_mb = 0, most_mb = 0, textures_mb = 0, gaps_mb = 0;

    static Minute of(double at_s, std::vector<Memory> seconds) {
      std::ranges::sort(seconds, {}, &Memory::resident_mb);
      return {at_s, seconds[seconds.size() / 2].resident_mb, seconds.back().resident_mb,
              std::ranges::max(seconds, {}, &Memory::textures_mb).textures_mb,
              std::ranges::max(seconds, {}, &Memory::gaps_mb).gaps_mb};
    }
  };
  /// Two programs share this heap, and one of them ends and starts again in it: the gaps that it leaves are filled by
  /// pictures of both, and stay resident when those are gone. What one of them keeps is never a whole free page.
  static Memory look_at_memory(std::uint64_t texture_bytes) {
    const double before = resident_mb();
    ::malloc_trim(0);
    const double after = resident_mb();
    return {after, 1e-6 * static_cast<double>(texture_bytes), before - after};
  }
  /// The most after the fifth minute, less the most of the minutes until then; 0 where there is none after it.
  double growth(double Minute::*of = &Minute::resident_mb) const {
    double before = 0, after = 0;
    for (const Minute& minute : memory_) {
      double& most = minute.at_s <= kSettled + kMemoryEvery ? before : after;
      most = std::max(most, minute.*of);
    }
    return std::max(after - before, 0.0);
  }

  const Rig& rig_;
  const SeatBenchOptions& options_;
  SeatHand& hand_;
  std::vector<std::string> names_;
  std::mt19937 random_;
  bool stands_ = false;
  Strangers strangers_;
  SetPointWatch watch_;
  double rests_after_;
  FaultMaker faults_;
  std::optional<BroadcastRing<RobotCycle>::Reader> cycles_;
  unsigned starts_ = 0;
  RobotTime begin_;
  bool began_ = false;
  double held_s_ = 0, drew_s_ = 0, longest_gap_ = 0, told_ = 0, looked_s_ = 0;
  std::uint64_t pictures_ = 0;
  std::vector<Memory> minute_;
  std::vector<Minute> memory_;
};

nlohmann::ordered_json Endurance::report(const SeatTrialFigures& figures) const {
  nlohmann::ordered_json out;
  out["line"] = options_.line.string();
  out["seed"] = options_.seed;
  out["task_s"] = figures.task.seconds;
  out["losses"] = figures.losses;
  out["cycles"] = watch_.cycles();
  out["unsafe_set_points"] = watch_.unsafe();
  out["pictures"] = pictures_;
  out["longest_without_picture_s"] = longest_gap_;
  out["memory_growth_mb"] = growth();
  out["most_memory_growth_mb"] = growth(&Minute::most_mb);
  out["texture_growth_mb"] = growth(&Minute::textures_mb);
  for (const Minute& memory : memory_) {
    out["memory_mb"].push_back({memory.at_s, memory.resident_mb});
    out["most_memory_mb"].push_back({memory.at_s, memory.most_mb});
    out["texture_mb"].push_back({memory.at_s, memory.textures_mb});
    out["gaps_mb"].push_back({memory.at_s, memory.gaps_mb});
  }
  for (const FaultRecord& fault : faults_.records()) {
    out["faults"].push_back({{"what", fault.name},
                             {"at_s", fault.at_s},
                             {"named", fault.named},
                             {"after_s", fault.after_s},
                             {"drove_on", fault.drove_on}});
    if (fault.let_go_s) out["faults"].back()["let_go_s"] = *fault.let_go_s;
  }
  return out;
}

void Endurance::print() const {
  for (const FaultRecord& fault : faults_.records())
    fmt::print("{:7.1f} s  {:38} {}{}\n", fault.at_s, fault.name,
               fault.named.empty() ? "NOT NAMED" : fmt::format("{:.2f} s later: {}", fault.after_s, fault.named),
               fault.drove_on ? "; DROVE ON" : "");
  fmt::print("{} faults, {} not named, {} in which the switch went on to count\n", faults_.records().size(), unnamed(),
             drove_on());
  fmt::print("{} set-points, {} unsafe{}\n", watch_.cycles(), watch_.unsafe(),
             watch_.unsafe() ? ", first " + watch_.first() : "");
  fmt::print("{} pictures, at most {:.2f} s without one\n", pictures_, longest_gap_);
  if (!memory_.empty())
    fmt::print(
        "memory {:.1f} MB at the end (medians of the seconds of a minute), grown by {:.1f} MB after the fifth minute, "
        "at "
        "most by {:.1f} MB, textures by {:.1f} MB; gaps at most {:.1f} MB\n",
        memory_.back().resident_mb, growth(), growth(&Minute::most_mb), growth(&Minute::textures_mb),
        std::ranges::max(memory_, {}, &Minute::gaps_mb).gaps_mb);
}

}  // namespace

int bench_seat(const SeatBenchOptions& options) {
  Rig rig = read_rig(options.rig);
  if (!rig.cameras)
    throw InputError(options.rig, "the rig has no cameras, of which a view could be made",
                     "give it a 'cameras:' section");
  for (CameraConfig& camera : rig.cameras->cameras) camera.settings.rate = options.image_hz;
  SeatTrialOptions trial;
  trial.rig_file = options.rig;
  if (!options.line.empty()) trial.line = read_line_spec(options.line);
  trial.line.up.delay += seconds(1e-3 * options.delay_ms);
  trial.line.down.delay += seconds(1e-3 * options.delay_ms);
  trial.line.seed = options.seed;
  trial.delay_s = 1e-3 * options.delay_ms;
  trial.seed = options.seed;
  trial.most_s = options.seconds;
  trial.pictures_hz = options.pictures_hz;
  trial.scored = false;
  trial.most_losses = std::numeric_limits<int>::max();
  if (!options.line.empty()) rig.link.coding = LinkCoding::h264;
  rig.link.round_trip = std::max(rig.link.round_trip, trial.line.up.delay + trial.line.down.delay + seconds(0.5));
  const auto scene = std::make_shared<const LiveScene>(live_scene_of(rig, true, std::nullopt, false, 0));
  SeatHand hand(rig, scene->model());
  trial.hand = [&](const SeatView& view, const SeatWish& meant) { return hand.pass_on(view, meant); };
  Endurance endurance(rig, options, hand, to_seconds(rig.link.round_trip));
  trial.each = [&](const SeatMoment& moment) { endurance.see(moment); };
  trial.stands_still = [&] { return endurance.stands_still(); };
  ToolScript script(rig, tour(rig, options.seed, kStops), {});
  const SeatTrialFigures figures = try_seat(
      rig, scene, trial, script, [] { return stop_requested(); }, [](const std::string&) {});
  endurance.print();
  write_numbers(options.json, endurance.report(figures).dump(2));
  return endurance.met() ? 0 : 1;
}

}  // namespace foresight
