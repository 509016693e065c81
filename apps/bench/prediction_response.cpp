#include "apps/bench/prediction_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/bench/even_times.hpp"
#include "apps/bench/joint_table.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"
#include "common/time.hpp"
#include "prediction/joint_response.hpp"

namespace foresight {
namespace {

constexpr std::array kAhead{0.1, 0.3, 1.0};  // s
constexpr std::array kAheadKeys{"100ms", "300ms", "1000ms"};
constexpr double kLearning = 0.4;         // of the time
constexpr double kExplained = 0.5;        // of the motion: commands that explain less belong to another one
constexpr double kFarthestCommand = 1.1;  // s: commands are known so far ahead
constexpr double kVelocityOver = 0.02;    // s
constexpr double kLongestGap = 0.15;      // s between states that judge what lies between
constexpr std::size_t kMostInstants = 20'000;
constexpr std::size_t kFewestInstants = 30;

constexpr double kFewCommands = 0.006;  // s between them, where it matters if they are held or joined by lines
constexpr double kBetter = 0.98;        // of what is unexplained

constexpr double kHole = 0.2, kHoleShare = 10;  // s, and intervals: commands that are so far apart lack some
constexpr double kSettles = 1;                  // s after a hole, until what was commanded in it is over

using Series = std::vector<TimedPosition>;

/// Between two commands: what was asked for there is not known.
struct Hole {
  double from = 0, to = 0;
  std::size_t next = 0;  // the command that ends it
};

struct Joint {
  std::string name;
  Series commands, states;
  std::vector<Hole> holes;
  std::vector<double> velocities;        // of the states; empty: not recorded
  std::optional<EvenTimes> evened = {};  // the commands' times are these
};

struct Errors {
  const char* name;
  const char* key;
  std::array<std::vector<double>, kAhead.size()> at{};
};

Series series_of(const JointTable& table, const std::vector<double>& values, std::int64_t epoch_ns) {
  Series series;
  series.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    series.push_back({to_seconds(Duration{table.time_ns[i] - epoch_ns}), values[i]});
  return series;
}

// Where commanded velocities lead from `start`.
Series integrated(const Series& velocities, double start) {
  Series positions = velocities;
  positions[0].position = start;
  for (std::size_t i = 1; i < positions.size(); ++i)
    positions[i].position = positions[i - 1].position + 0.5 * (velocities[i - 1].position + velocities[i].position) *
                                                            (velocities[i].time - velocities[i - 1].time);
  return positions;
}

std::vector<Hole> holes_of(const Series& commands) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < commands.size(); ++i) intervals.push_back(commands[i].time - commands[i - 1].time);
  const double usual = quantile(intervals, 0.5);
  std::vector<Hole> holes;
  for (std::size_t i = 0; i < intervals.size(); ++i)
    if (intervals[i] > std::max(kHole, kHoleShare * usual))
      holes.push_back({commands[i].time, commands[i + 1].time, i + 1});
  return holes;
}

bool any_hole(const std::vector<Hole>& holes, double from, double to) {
  return std::ranges::any_of(holes, [&](const Hole& hole) { return hole.from < to && hole.to > from; });
}

std::vector<Joint> read_joints(const PredictionResponseOptions& options) {
  const JointTable commands = read_joint_table(options.commands), states = read_joint_table(options.states);
  const std::int64_t epoch = states.time_ns.front();
  std::vector<Joint> joints;
  for (const JointColumn& column : states.columns) {
    if (column.name.starts_with("dq")) continue;
    Joint joint{column.name, {}, series_of(states, column.values, epoch), {}, {}};
    if (const JointColumn* positions = commands.find(column.name))
      joint.commands = series_of(commands, positions->values, epoch);
    else if (const JointColumn* velocities = commands.find("d" + column.name))
      joint.commands = integrated(series_of(commands, velocities->values, epoch), column.values.front());
    else
      continue;
    if (const JointColumn* velocities = states.find("d" + column.name)) joint.velocities = velocities->values;
    joint.holes = holes_of(joint.commands);
    joints.push_back(std::move(joint));
  }
  if (joints.empty())
    throw InputError(options.commands.string(), "commands no joint of " + options.states.string(),
                     "call a joint's column the same in both: q1, q2, ...; or dq1, dq2, ... for commanded velocities");
  const double first = std::max(joints[0].commands.front().time, 0.0);
  const double last = std::min(joints[0].commands.back().time, joints[0].states.back().time);
  if (last - first < 0.5 * joints[0].states.back().time || last - first < kAhead[0])
    throw InputError(options.commands.string(), "covers less than half of the time of " + options.states.string(),
                     "name recordings of the same motion, with times of one clock");
  return joints;
}

// A learner and how far it has been fed.
struct Learner {
  JointResponse response;
  std::size_t next_command = 0, next_hole = 0;

  // In a hole it learns nothing, and begins anew after it.
  void take(const Joint& joint, const TimedPosition& state) {
    for (; next_hole < joint.holes.size() && joint.holes[next_hole].to <= state.time; ++next_hole) {
      response.begin_anew();
      next_command = joint.holes[next_hole].next;
    }
    if (any_hole(joint.holes, state.time, state.time)) return;
    for (; next_command < joint.commands.size(); ++next_command) {
      const TimedPosition& command = joint.commands[next_command];
      if (command.time > state.time + kFarthestCommand) break;
      response.command(command.time, command.position);
    }
    response.observe(state.time, state.position);
  }
};

/// What the commands of the first part leave unexplained; infinite where nothing was learnt.
double unexplained_by(const Joint& joint, double learnt) {
  Learner learner;
  for (const TimedPosition& state : joint.states) {
    if (state.time > learnt) break;
    learner.take(joint, state);
  }
  learner.response.identify();
  const ResponseFigures& figures = learner.response.figures();
  return figures.samples > 0 ? figures.unexplained : std::numeric_limits<double>::infinity();
}

// A drive steps where a command reaches it. Where the stamps of few commands scatter about that, the steps do not fit,
// lines between the commands do as well, and these are half an interval earlier: so much too small is the delay then.
Joint with_the_better_times(const Joint& joint, double learnt) {
  std::vector<double> stamps;
  for (const TimedPosition& command : joint.commands) stamps.push_back(command.time);
  Joint other = joint;
  other.evened = even_times(stamps);
  if (!other.evened || other.evened->interval < kFewCommands) return joint;
  for (std::size_t i = 0; i < stamps.size(); ++i) other.commands[i].time = other.evened->times[i];
  other.holes = holes_of(other.commands);
  return unexplained_by(other, learnt) < kBetter * unexplained_by(joint, learnt) ? other : joint;
}

// Seconds between commands where states come always at the same instant between two of them, such as those that one
// loop writes down with its commands; 0 elsewhere. What a drive does between two commands is seen by no state then, and
// steps that it takes at once give the same states as lines that it takes until the next command.
double unseen_between_commands(const Joint& joint, double learnt) {
  constexpr double kAlike = 0.95;  // mean of unit vectors: a standard deviation of a twentieth of the interval
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  std::size_t next = 1;
  double count = 0, intervals = 0;
  for (const TimedPosition& state : joint.states) {
    while (next < joint.commands.size() && joint.commands[next].time <= state.time) ++next;
    if (state.time > learnt || next == joint.commands.size()) break;
    const double before = joint.commands[next - 1].time, interval = joint.commands[next].time - before;
    if (state.time < before || !(interval > 0)) continue;
    const double turn = 2 * std::numbers::pi * (state.time - before) / interval;
    sum += Eigen::Vector2d(std::cos(turn), std::sin(turn));
    intervals += interval;
    ++count;
  }
  const bool unseen = count > 0 && sum.norm() > kAlike * count && intervals > kFewCommands * count;
  return unseen ? intervals / count : 0;
}

struct Scores {
  std::array<Errors, 5> methods{Errors{"predicted", ""}, Errors{"predicted, learning goes on", "online_"},
                                Errors{"increment", "increment_"}, Errors{"velocity", "velocity_"},
                                Errors{"hold", "hold_"}};
  std::array<std::size_t, kAhead.size()> inside{};
  nlohmann::json joints = nlohmann::json::array();
};

// A step between sparse states would be an error of the truth.
double between(const PositionHistory& states, double time) {
  return states.at(time, std::numeric_limits<double>::infinity(), kLongestGap);
}

double velocity_at(const Joint& joint, const PositionHistory& states, std::size_t i) {
  if (!joint.velocities.empty()) return joint.velocities[i];
  const TimedPosition& now = joint.states[i];
  const double then = std::max(now.time - kVelocityOver, joint.states.front().time);
  return now.time > then ? (now.position - between(states, then)) / (now.time - then) : 0;
}

/// Whether its states come before its commands, by more than they may seem to.
bool leads(const ResponseFigures& figures) {
  constexpr double kSeems = 0.002;  // s: stamps of one loop's commands and states
  return figures.delay < -std::max(kSeems, 3 * figures.delay_sigma);
}

void describe(const Joint& joint, const JointResponse& response, double unseen, Scores& scores) {
  const ResponseFigures& f = response.figures();
  scores.joints.push_back({{"name", joint.name},
                           {"identified", f.samples > 0},
                           {"delay_s", f.delay},
                           {"delay_sigma_s", f.delay_sigma},
                           {"dead_time_s", f.dead_time},
                           {"dead_time_sigma_s", f.dead_time_sigma},
                           {"lag_s", f.lag},
                           {"unexplained_rad", f.unexplained},
                           {"explained", f.explained},
                           {"evened_s", joint.evened ? joint.evened->scatter : 0},
                           {"unseen_s", unseen}});
  if (f.samples == 0) {
    std::printf("%-12s not identified: its commands do not move it in the first 40 %% of the time\n",
                joint.name.c_str());
    return;
  }
  if (f.explained < kExplained) {
    std::printf(
        "%-12s its commands explain %.0f %% of its motion in the first 40 %% of the time: record both with one "
        "clock, in one unit, of one joint\n",
        joint.name.c_str(), 100 * f.explained);
    return;
  }
  std::printf("%-12s delay %6.1f +- %.1f ms: dead time %6.1f +- %.1f ms, lag %6.1f ms; unexplained %.3f mrad rms\n",
              joint.name.c_str(), f.delay * 1e3, f.delay_sigma * 1e3, f.dead_time * 1e3, f.dead_time_sigma * 1e3,
              f.lag * 1e3, f.unexplained * 1e3);
  if (joint.evened)
    std::printf("%-12s the stamps of its commands scatter by %.1f ms about every %.1f ms: evened, they explain more\n",
                "", joint.evened->scatter * 1e3, joint.evened->interval * 1e3);
  if (leads(f))
    std::printf(
        "%-12s its states lead its commands: no drive knows them before; record both with one clock, and name "
        "neither file in the other's place\n",
        "");
  if (unseen > 0)
    std::printf(
        "%-12s its states come with its commands, every %.1f ms: whether the drive takes these as steps or as lines to "
        "the next one cannot be told, and delay and dead time may be off by as much; record states oftener, or at "
        "other instants\n",
        "", unseen * 1e3);
}

// All that the recordings show, at once: what predictions are judged by.
struct Truth {
  PositionHistory commands, states;
  double end = 0;

  explicit Truth(const Joint& joint) : commands(joint.commands.size()), states(joint.states.size()) {
    for (const TimedPosition& command : joint.commands) commands.add(command.time, command.position);
    for (const TimedPosition& state : joint.states) states.add(state.time, state.position);
    end = std::min(joint.commands.back().time, joint.states.back().time);
  }
};

void score(const Joint& joint, const Truth& truth, std::size_t i, const std::array<const JointResponse*, 2>& learners,
           Scores& scores) {
  const TimedPosition& now = joint.states[i];
  for (std::size_t h = 0; h < kAhead.size(); ++h) {
    const double then = now.time + kAhead[h];
    if (then > truth.end || !truth.states.covers(then, kLongestGap)) continue;
    if (any_hole(joint.holes, now.time - kSettles, then)) continue;
    const PredictedPosition predicted = learners[0]->at(then), online = learners[1]->at(then);
    const double there = between(truth.states, then);
    const double way = truth.commands.at(then) - truth.commands.at(now.time);
    const std::array guesses{predicted.position, online.position, now.position + way,
                             now.position + velocity_at(joint, truth.states, i) * kAhead[h], now.position};
    for (std::size_t m = 0; m < guesses.size(); ++m) scores.methods[m].at[h].push_back(std::abs(guesses[m] - there));
    scores.inside[h] += std::abs(predicted.position - there) <= 2 * predicted.sigma;
  }
}

void measure(const Joint& recorded, Scores& scores) {
  const double learnt = kLearning * std::min(recorded.commands.back().time, recorded.states.back().time);
  const Joint joint = with_the_better_times(recorded, learnt);
  const Truth truth(joint);
  const std::size_t stride = joint.states.size() / kMostInstants + 1;
  Learner kept, online;
  bool identified = false;
  double identify_next = 1;
  for (std::size_t i = 0; i < joint.states.size() && joint.states[i].time <= truth.end; ++i) {
    const TimedPosition& now = joint.states[i];
    if (!identified && now.time > learnt) {
      identified = true;
      kept.response.identify();
      describe(joint, kept.response, unseen_between_commands(joint, learnt), scores);
    }
    kept.take(joint, now);
    online.take(joint, now);
    if (now.time >= identify_next) {
      online.response.identify();
      identify_next = now.time + 1;
    }
    if (identified && i % stride == 0) score(joint, truth, i, {&kept.response, &online.response}, scores);
  }
}

nlohmann::json report(const Scores& scores) {
  const auto& ours = scores.methods[0].at;
  nlohmann::json all;
  std::printf("\n%-28s %12s %12s %12s   (95 %% are nearer, mrad)\n", "error", "100 ms", "300 ms", "1,000 ms");
  for (const Errors& method : scores.methods) {
    std::printf("%-28s", method.name);
    for (std::size_t h = 0; h < kAhead.size(); ++h) {
      const std::string key = kAheadKeys[h], before = method.key;
      const bool any = !method.at[h].empty();
      const double p95 = quantile(method.at[h], 0.95);
      all[before + "p95_rad_" + key] = any ? nlohmann::json(p95) : nlohmann::json();
      all[before + "rms_rad_" + key] = any ? nlohmann::json(root_mean_square(method.at[h])) : nlohmann::json();
      std::printf(" %12s", any ? readable(p95 * 1e3, 3).c_str() : "-");
    }
    std::printf("\n");
  }
  std::printf("%-28s", "truth within 2 sigma, %");
  for (std::size_t h = 0; h < kAhead.size(); ++h) {
    const double inside =
        static_cast<double>(scores.inside[h]) / static_cast<double>(std::max<std::size_t>(ours[h].size(), 1));
    std::printf(" %12.1f", 100 * inside);
    all[std::string("inside_2_sigma_") + kAheadKeys[h]] = ours[h].empty() ? nlohmann::json() : nlohmann::json(inside);
  }
  std::printf("\n");
  all["scored"] = {ours[0].size(), ours[1].size(), ours[2].size()};
  all["joints"] = scores.joints;
  return all;
}

}  // namespace

int bench_prediction_response(const PredictionResponseOptions& options) {
  const std::vector<Joint> joints = read_joints(options);
  Scores scores;
  for (const Joint& joint : joints) measure(joint, scores);
  const auto& ours = scores.methods[0].at;
  const std::vector<Hole>& holes = joints.front().holes;
  double missing = 0;
  for (const Hole& hole : holes) missing += hole.to - hole.from;
  if (!holes.empty())
    std::printf("%zu hole%s in the commands, %s s in all: nothing is learnt there, and nothing judged about there\n",
                holes.size(), holes.size() == 1 ? "" : "s", readable(missing, 1).c_str());
  if (ours[0].size() < kFewestInstants)
    throw InputError(options.states.string(), "has only " + std::to_string(ours[0].size()) + " states to judge by",
                     "name a recording of some seconds");
  nlohmann::json all = report(scores);
  all["holes"] = holes.size();
  all["holes_s"] = missing;
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
