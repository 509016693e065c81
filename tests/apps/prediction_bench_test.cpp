// `foresight bench prediction ik` on the lab's arm: its keys, and words for wrong input.
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/support/palletiser.hpp"

namespace foresight::prediction_bench_test {
namespace {

const std::string kArm = (source_folder() / "configs/arm.urdf").string();

TEST(Prediction, IkSolvesAllOfTheLabArmsPosesWithinItsLimits) {
  const TempFolder out;
  const std::string json = out / "ik.json";
  const Outcome outcome = run_program({"bench", "prediction", "ik", "--urdf", kArm, "--tip", "arm_7", "--poses", "2000",
                                       "--kdl-poses", "20", "--paths", "3", "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json all = read_json(json);
  EXPECT_EQ(all["solved"], 1.0);
  EXPECT_EQ(all["at_limit_solved"], 1.0);
  EXPECT_TRUE(all["closed_form"]);
  EXPECT_GT(all["mean_us"], 0);
  EXPECT_TRUE(all.contains("kdl_solved"));
  EXPECT_TRUE(all.contains("kdl_mean_us"));
  EXPECT_GT(all["largest_step_over_limit"], 0);
  EXPECT_LE(all["largest_step_over_limit"], 1);
  const double sum = all["followed_exactly"].get<double>() + all["slowed"].get<double>() + all["stopped"].get<double>();
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST(Prediction, AnArmWithJointsThatFollowIsJudgedByItsUrdf) {
  const TempFolder out;
  const std::string json = out / "ik.json", urdf = out.write("arm.urdf", palletiser_urdf(Linkage::by_lever));
  const Outcome outcome = run_program(
      {"bench", "prediction", "ik", "--urdf", urdf, "--tip", "hand", "--poses", "200", "--paths", "2", "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GE(read_json(json)["solved"], 0.99);
  EXPECT_GE(read_json(json)["turned_solved"], 0.98);
  EXPECT_TRUE(read_json(json)["kdl_solved"].is_null()) << "KDL's chains know no joints that follow";
}

// Late images make the model operator wait; the prediction does not.
TEST(Prediction, AModelOperatorIsFasterWithThePrediction) {
  const TempFolder out;
  const std::string json = out / "operators.json";
  const Outcome outcome =
      run_program({"bench", "prediction", "operators", "--rig", (source_folder() / "configs/minerva.yaml").string(),
                   "--runs", "1", "--delay-ms", "500", "--accident", "none", "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json trials = read_json(json)["trials"];
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[0]["sees"], "image");
  EXPECT_EQ(trials[1]["sees"], "prediction");
  for (const auto& trial : trials) EXPECT_EQ(trial["failed"], 0);
  EXPECT_GT(trials[0]["task_s"].get<double>(), trials[1]["task_s"].get<double>() + 4);
}

TEST(Prediction, ARecordedPathIsFollowedWhereverItWasRecorded) {
  const TempFolder out;
  std::string rows = "time_s,x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i < 200; ++i) {
    const std::string time = std::to_string(0.01 * i), x = std::to_string(50 + 0.0005 * i);
    rows += time + "," + x + ",-3,0,0,0,0,1\n";
  }
  const std::string csv = out.write("path.csv", rows), json = out / "ik.json";
  const Outcome outcome = run_program({"bench", "prediction", "ik", "--urdf", kArm, "--tip", "arm_7", "--poses", "1",
                                       "--kdl-poses", "0", "--path", csv, "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_json(json)["followed_exactly"], 1.0);
  EXPECT_EQ(read_json(json)["cycles"], 200);
}

TEST(Prediction, WrongInputIsRefused) {
  const TempFolder out;
  const std::string no_pose = out.write("a.csv", "time_s,x,y\n0,1,2\n");
  const std::string short_row = out.write("b.csv", "time_s,x,y,z,qx,qy,qz,qw\n0,1,2\n");
  const std::string backwards = out.write("c.csv", "time_s,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n0.5,0,0,0,0,0,0,1\n");
  const std::vector<std::string> ik{"bench", "prediction", "ik", "--poses", "1", "--kdl-poses", "0", "--urdf"};
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"/nowhere.urdf", "--tip", "arm_7"}, "/nowhere.urdf"},
      {{kArm, "--tip", "arm_77"}, "did you mean 'arm_7'"},
      {{kArm, "--tip", "stand"}, "no moving joint"},
      {{kArm, "--tip", "arm_7", "--path", "/nowhere.csv"}, "/nowhere.csv"},
      {{kArm, "--tip", "arm_7", "--path", no_pose}, "no pose"},
      {{kArm, "--tip", "arm_7", "--path", short_row}, "b.csv:2"},
      {{kArm, "--tip", "arm_7", "--path", backwards}, "c.csv:3"},
  };
  for (const auto& [arguments, problem] : cases) {
    std::vector<std::string> all = ik;
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = run_program(all);
    EXPECT_EQ(outcome.exit_code, 2) << problem;
    EXPECT_THAT(outcome.last_line(), testing::HasSubstr(problem));
  }
}

}  // namespace
}  // namespace foresight::prediction_bench_test
