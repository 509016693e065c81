// `foresight bench prediction response`: recorded and made-up arms, its keys, and words for wrong input.
#include <cmath>
#include <random>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/support/folders.hpp"

namespace foresight::prediction_response_bench_test {
namespace {

nlohmann::json measured(const TempFolder& out, const std::string& commands, const std::string& states) {
  const std::string json = out / "response.json";
  const Outcome outcome =
      run_program({"bench", "prediction", "response", "--commands", commands, "--states", states, "--json", json});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? read_json(json) : nlohmann::json{};
}

TEST(PredictionResponse, ARealArmIsPredictedToAMilliradian) {
  const auto folder = data_folder() / "panda_command_state";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded arm in " << folder;
  const TempFolder out;
  const nlohmann::json all = measured(out, (folder / "command.csv").string(), (folder / "state.csv").string());
  for (const std::string ahead : {"100ms", "300ms", "1000ms"}) {
    EXPECT_LE(all["p95_rad_" + ahead].get<double>(), 0.7e-3) << ahead;
    EXPECT_LE(all["online_p95_rad_" + ahead].get<double>(), 0.7e-3) << ahead;
    EXPECT_GE(all["inside_2_sigma_" + ahead].get<double>(), 0.90) << ahead;
    EXPECT_LE(all["inside_2_sigma_" + ahead].get<double>(), 0.985) << ahead;
  }
  EXPECT_LE(10 * all["p95_rad_300ms"].get<double>(), all["increment_p95_rad_300ms"].get<double>());
  EXPECT_NEAR(all["hold_p95_rad_300ms"], 0.409, 0.01);
  EXPECT_NEAR(all["velocity_p95_rad_300ms"], 0.115, 0.005);
  EXPECT_NEAR(all["increment_p95_rad_300ms"], 0.0115, 0.0005);
  ASSERT_EQ(all["joints"].size(), 7u);
  for (const nlohmann::json& joint : all["joints"]) EXPECT_NEAR(joint["delay_s"], 0.0155, 0.002);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

double wish(double t) {
  return 0.5 * std::sin(1.2 * t) + 0.1 * std::sin(4 * t);
}

/// A drive with 30 ms of dead time and 20 ms of lag, on commands every `interval` seconds that it holds. `sent`: they
/// are sent that much off their time; `stamped`: commands and states are stamped so much off theirs (sigma, s).
nlohmann::json joint_of_held_commands(double interval, double sent, double stamped) {
  constexpr double kTick = 0.0005;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::string commands = "time_s,q1\n", states = "time_s,q1\n";
  std::vector<double> at;
  for (int i = 0; i * interval < 30; ++i) {
    at.push_back(1 + i * interval + sent * normal(random));
    commands += number(at.back() + stamped * normal(random)) + "," + number(wish(i * interval)) + "\n";
  }
  double position = wish(0);
  std::size_t held = 0;
  for (int i = 0; i * kTick < 30; ++i) {
    const double now = 1 + i * kTick;
    while (held + 1 < at.size() && at[held + 1] <= now - 0.03) ++held;
    position += (wish(static_cast<double>(held) * interval) - position) / 0.02 * kTick;
    if (i % 12 == 0) states += number(now + stamped * normal(random)) + "," + number(position) + "\n";
  }
  const TempFolder out;
  return measured(out, out.write("c.csv", commands).string(), out.write("s.csv", states).string())["joints"][0];
}

TEST(PredictionResponse, StatesThatLeadTheirCommandsAreTold) {
  std::string commands = "time_s,q1\n", states = "time_s,q1\n";
  for (int i = 0; i < 3000; ++i) {
    const double now = 0.01 * i;
    commands += number(1 + now) + "," + number(wish(now)) + "\n";
    states += number(1.003 + now) + "," + number(wish(now + 0.05)) + "\n";
  }
  const TempFolder out;
  const std::string c = out.write("c.csv", commands).string(), s = out.write("s.csv", states).string();
  const Outcome early = run_program({"bench", "prediction", "response", "--commands", c, "--states", s});
  EXPECT_THAT(early.out, testing::HasSubstr("its states lead its commands"));
  const Outcome late = run_program({"bench", "prediction", "response", "--commands", s, "--states", c});
  EXPECT_THAT(late.out, testing::Not(testing::HasSubstr("lead its commands")));
}

TEST(PredictionResponse, NoiseOfStampsLeavesTheDelayAsItIs) {
  for (const double interval : {0.01, 0.02}) {
    const nlohmann::json quiet = joint_of_held_commands(interval, 0, 0),
                         noisy = joint_of_held_commands(interval, 0, 1e-3);
    EXPECT_NEAR(quiet["delay_s"], 0.05 + 0.5 * interval, 0.002) << interval;
    EXPECT_NEAR(noisy["delay_s"], 0.05 + 0.5 * interval, 0.002) << interval;
    EXPECT_EQ(quiet["evened_s"], 0);
    EXPECT_NEAR(noisy["evened_s"], 1e-3, 1e-4);
    const nlohmann::json uneven = joint_of_held_commands(interval, 1e-3, 0);
    EXPECT_NEAR(uneven["delay_s"], 0.05 + 0.5 * interval, 0.002) << interval;
    EXPECT_EQ(uneven["evened_s"], 0) << "these stamps are right";
  }
}

// One loop that writes down what it commands and what it reads: of the drive between two commands no state tells.
TEST(PredictionResponse, StatesAtTheCommandsInstantsAreToldToLeaveTheDelayOpen) {
  for (const double every : {0.02, 0.007}) {
    const TempFolder out;
    std::string commands = "time_s,q1\n", states = "time_s,q1\n";
    for (double t = 0; t < 25; t += 0.02) commands += number(t) + "," + number(wish(t)) + "\n";
    for (double t = 0; t < 25; t += every)
      states += number(t) + "," + number(wish(0.02 * std::floor(std::max(0.0, t - 0.05) / 0.02))) + "\n";
    const std::string json = out / "response.json";
    const Outcome outcome =
        run_program({"bench", "prediction", "response", "--commands", out.write("c.csv", commands).string(), "--states",
                     out.write("s.csv", states).string(), "--json", json});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const bool blind = every == 0.02;
    EXPECT_NEAR(read_json(json)["joints"][0]["unseen_s"], blind ? 0.02 : 0, 1e-9);
    EXPECT_EQ(outcome.out.find("cannot be told") != std::string::npos, blind) << outcome.out;
  }
}

// What was commanded in a hole nobody knows: nothing is guessed of it.
TEST(PredictionResponse, HolesInTheCommandsAreNotJudged) {
  const TempFolder out;
  std::string commands = "time_s,q1\n", states = "time_s,q1\n";
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 0.005;
    if (t < 6 || t > 7.5) commands += number(t) + "," + number(wish(t)) + "\n";
    states += number(t) + "," + number(wish(std::max(0.0, t - 0.04))) + "\n";
  }
  const auto all = measured(out, out.write("c.csv", commands).string(), out.write("s.csv", states).string());
  EXPECT_EQ(all["holes"], 1);
  EXPECT_NEAR(all["holes_s"], 1.5, 0.02);
  EXPECT_LT(all["p95_rad_1000ms"].get<double>(), 0.001);
  EXPECT_LT(all["online_p95_rad_1000ms"].get<double>(), 0.001);
  EXPECT_GE(all["inside_2_sigma_1000ms"].get<double>(), 0.9);
}

// One joint that follows 40 ms later; commanded by position, or by velocity.
TEST(PredictionResponse, CommandsAreTakenAsPositionsOrVelocities) {
  const TempFolder out;
  std::string positions = "time_s,elbow\n", velocities = "dq1,time_s\n", states = "time_s,elbow\n",
              numbered = "time_s,q1\n";
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 0.005;
    const std::string time = number(1000 + t);
    positions += time + "," + number(wish(t)) + "\n";
    velocities += number(0.6 * std::cos(1.2 * t) + 0.4 * std::cos(4 * t)) + "," + time + "\n";
    for (std::string* table : {&states, &numbered})
      *table += time + "," + number(wish(std::max(0.0, t - 0.04)) + 0.02) + "\n";
  }
  const auto by_position = measured(out, out.write("p.csv", positions).string(), out.write("s.csv", states).string());
  const auto by_velocity =
      measured(out, out.write("v.csv", velocities).string(), out.write("n.csv", numbered).string());
  for (const nlohmann::json& all : {by_position, by_velocity}) {
    EXPECT_LT(all["p95_rad_1000ms"].get<double>(), 0.0005);
    EXPECT_GT(all["increment_p95_rad_1000ms"].get<double>(), 0.01);
    EXPECT_TRUE(all["joints"][0]["identified"]);
    EXPECT_NEAR(all["joints"][0]["delay_s"], 0.04, 0.003);
    EXPECT_NEAR(all["joints"][0]["lag_s"], 0, 0.01);
  }
  EXPECT_EQ(by_position["joints"][0]["name"], "elbow");
}

// As over a thin line: what lies between two states is on the line between them, no step.
TEST(PredictionResponse, SparseStatesAreJoinedByLines) {
  const TempFolder out;
  std::string commands = "time_s,elbow\n", states = commands;
  const auto slow = [](double t) { return 0.5 * std::sin(0.5 * t); };
  for (int i = 0; i < 6000; ++i) commands += number(i * 0.005) + "," + number(slow(i * 0.005)) + "\n";
  for (int i = 0; i < 428; ++i) states += number(i * 0.07) + "," + number(slow(i * 0.07 - 0.04)) + "\n";
  const auto all = measured(out, out.write("c.csv", commands).string(), out.write("s.csv", states).string());
  EXPECT_LT(all["increment_p95_rad_100ms"].get<double>(), 0.004);
  EXPECT_LT(all["velocity_p95_rad_100ms"].get<double>(), 0.004);
}

// Another clock cannot be told from its numbers, but from a motion that its commands have nothing to do with.
TEST(PredictionResponse, CommandsThatExplainLittleOfTheMotionAreNamed) {
  const TempFolder out;
  std::string commands = "time_s,near,late\n", states = commands;
  for (int i = 0; i < 3000; ++i) {
    const double t = i * 0.005;
    commands += number(t) + "," + number(wish(t)) + "," + number(wish(t)) + "\n";
    states += number(t) + "," + number(wish(t - 0.04)) + "," + number(wish(t - 2.9)) + "\n";
  }
  const std::string json = out / "response.json";
  const Outcome outcome =
      run_program({"bench", "prediction", "response", "--commands", out.write("c.csv", commands).string(), "--states",
                   out.write("s.csv", states).string(), "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("late +its commands explain [0-9]+ % of its motion"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("near +delay"));
  const nlohmann::json joints = read_json(json)["joints"];
  EXPECT_GT(joints[0]["explained"], 0.99);
  EXPECT_LT(joints[1]["explained"], 0.5);
}

TEST(PredictionResponse, WrongInputIsRefused) {
  const TempFolder out;
  std::string good = "time_s,q1\n", late = good, other = "time_s,q2\n";
  for (int i = 0; i < 300; ++i) {
    good += number(0.01 * i) + ",0\n";
    late += number(5000 + 0.01 * i) + ",0\n";
    other += number(0.01 * i) + ",0\n";
  }
  const std::string fine = out.write("fine.csv", good).string();
  const std::pair<std::string, const char*> cases[] = {
      {"/nowhere.csv", "/nowhere.csv"},
      {out.write("empty.csv", "").string(), "has no row"},
      {out.write("no_time.csv", "q1,q2\n1,2\n").string(), "names no time_s"},
      {out.write("twice.csv", "time_s,q1,q1\n0,1,2\n").string(), "second column"},
      {out.write("nan.csv", "time_s,q1\n0,0\n0.1,nan\n").string(), "nan.csv:3:5"},
      {out.write("back.csv", "time_s,q1\n1,0\n0.5,0\n").string(), "back.csv:3"},
      {out.write("fields.csv", "time_s,q1\n1,0\n1.5\n").string(), "fields.csv:3"},
      {out.write("late.csv", late).string(), "one clock"},
      {out.write("other.csv", other).string(), "commands no joint"},
  };
  for (const auto& [commands, problem] : cases) {
    const Outcome outcome = run_program({"bench", "prediction", "response", "--commands", commands, "--states", fine});
    EXPECT_EQ(outcome.exit_code, 2) << problem;
    EXPECT_THAT(outcome.last_line(), testing::HasSubstr(problem));
  }
  const std::string brief = out.write("brief.csv", "time_s,q1\n0,0\n0.1,0\n0.2,0\n").string();
  const Outcome outcome = run_program({"bench", "prediction", "response", "--commands", fine, "--states", brief});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.last_line(), testing::HasSubstr("states to judge by"));
}

}  // namespace
}  // namespace foresight::prediction_response_bench_test
