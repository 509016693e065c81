// `foresight bench prediction contact`: its keys, that its subjects agree, and words for wrong input.
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::prediction_contact_bench_test {
namespace {

TEST(PredictionContact, AllThreeSayTheSameTouchesAndDistancesAreFcls) {
  const TempFolder out;
  const std::string json = out / "contact.json";
  const Outcome outcome = run_program(
      {"bench", "prediction", "contact", "--triangles", "0", "--poses", "60", "--peer-poses", "6", "--json", json});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json all = read_json(json);
  EXPECT_GT(all["couples"], 200);
  EXPECT_GT(all["touching"], 0.02);
  EXPECT_LT(all["touching"], 0.9);
  EXPECT_GT(all["near_couples"], 0.1);
  EXPECT_EQ(all["hand_touching"], 0.0);
  EXPECT_GT(all["hand_mean_ms"], 0);
  for (const std::string prefix : {"", "motion_"}) {
    EXPECT_EQ(all[prefix + "touching_agree"], 1.0);
    EXPECT_LT(all[prefix + "distances_differ_mm"], 1e-3);
    for (const std::string subject : {"", "fcl_", "bullet_"})
      for (const std::string what : {"touching", "distances", "least"})
        for (const std::string figure : {"_mean_ms", "_p99_ms"})
          EXPECT_GT(all[prefix + subject + what + figure], 0) << prefix << subject << what << figure;
  }
}

TEST(PredictionContact, SaysWhatIsWrongWithARobotWithoutShapes) {
  const TempFolder out;
  const std::string urdf = out.write(
      "bare.urdf",
      "<robot name='bare'><link name='a'/><link name='b'/><joint name='j' type='revolute'><parent link='a'/>"
      "<child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>");
  const Outcome outcome = run_program({"bench", "prediction", "contact", "--urdf", urdf});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("no link of the robot has a shape"));
}

}  // namespace
}  // namespace foresight::prediction_contact_bench_test
