#include "apps/bench/prediction_bench.hpp"

#include <memory>

#include "apps/bench/prediction_contact.hpp"
#include "apps/bench/prediction_grasp.hpp"
#include "apps/bench/prediction_hand.hpp"
#include "apps/bench/prediction_head.hpp"
#include "apps/bench/prediction_ik.hpp"
#include "apps/bench/prediction_operators.hpp"
#include "apps/bench/prediction_response.hpp"
#include "apps/bench/prediction_robot.hpp"

namespace foresight {
namespace {

constexpr const char* kTimes =
    "Times of a CSV: time_s in seconds; or timestamp, in nanoseconds or in ticks of 100 ns since the year 1.\n\n";

void add_ik(Command& prediction, std::function<int()>& action) {
  auto* command = prediction.add_subcommand("ik", "Inverse kinematics of an arm: solved, CPU time, paths followed");
  auto options = std::make_shared<PredictionIkOptions>();
  command->add_option("--urdf", options->urdf, "Robot; its meshes are not needed")->reads()->required();
  command->add_option("--tip", options->tip, "Link that is to reach the poses")->required();
  command->add_option("--base", options->base, "Link that the poses are relative to; else the root");
  command->add_option("--poses", options->poses, "Uniform joint vectors whose poses are asked for")
      ->check(from_to(1, 10'000'000))
      ->capture_default_str();
  command->add_option("--kdl-poses", options->kdl_poses, "How many of them, the first ones, KDL gets too; 0: none")
      ->check(from_to(0, 10'000'000))
      ->capture_default_str();
  command->add_option("--paths", options->paths, "Random straight paths to follow")
      ->check(from_to(0, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--path", options->path,
                   "CSV with time_s and x y z qx qy qz qw, perhaps after prefixes: followed instead, moved and scaled "
                   "into the workspace")
      ->reads();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(std::string(kTimes) +
                  "Example: foresight bench prediction ik --urdf configs/arm.urdf --tip arm_7 --json ik.json\n"
                  "Exit code: 1 where a joint stepped farther than its velocity allows.");
  command->callback([options, &action] { action = [options] { return bench_prediction_ik(*options); }; });
}

void add_contact(Command& prediction, std::function<int()>& action) {
  auto* command = prediction.add_subcommand("contact", "What touches and what is near, of a robot in the lab");
  auto options = std::make_shared<PredictionContactOptions>();
  command->add_option("--urdf", options->urdf, "Robot, with its meshes; else the lab's own arm")->reads();
  command
      ->add_option("--triangles", options->triangles,
                   "Of each link and of what it carries: split or simplified; 0: as they are")
      ->check(from_to(0, 100'000))
      ->capture_default_str();
  command->add_option("--poses", options->poses, "Uniform joint vectors, and pictures in motion")
      ->check(from_to(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--peer-poses", options->peer_poses,
                   "How many of them Bullet gets for distances; FCL gets ten times as many")
      ->check(from_to(0, 1'000'000))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight bench prediction contact --urdf arm.urdf --json contact.json\n"
      "Exit code: 1 where FCL, used plainly, answers otherwise, or the arm that is shown touches.");
  command->callback([options, &action] { action = [options] { return bench_prediction_contact(*options); }; });
}

void add_prediction_head(Command& prediction, std::function<int()>& action) {
  auto* command = prediction.add_subcommand("head", "Where a head will be when its picture is seen");
  auto options = std::make_shared<PredictionHeadOptions>();
  command
      ->add_option("RECORDING", options->csv,
                   "CSV with time_s (or timestamp) and x y z qx qy qz qw, perhaps after the prefix head_")
      ->reads()
      ->required();
  command->add_option("--ahead-ms", options->ahead_ms, "How far ahead of the newest pose")
      ->check(from_to(1, 500))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(std::string(kTimes) + "Example: foresight bench prediction head head.csv --json head.json");
  command->callback([options, &action] { action = [options] { return bench_prediction_head(*options); }; });
}

void add_hand(Command& prediction, std::function<int()>& action) {
  auto* command =
      prediction.add_subcommand("hand", "What filtering takes from the noise of tracked hands, and its lag");
  auto options = std::make_shared<PredictionHandOptions>();
  command
      ->add_option("RECORDING", options->csv,
                   "CSV with time_s (or timestamp) and x y z qx qy qz qw after a prefix for each pose")
      ->reads()
      ->required();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(std::string(kTimes) + "Example: foresight bench prediction hand hands.csv --json hands.json");
  command->callback([options, &action] { action = [options] { return bench_prediction_hand(*options); }; });
}

void add_response(Command& prediction, std::function<int()>& action) {
  auto* command = prediction.add_subcommand("response", "Where commanded joints will be, with their drives' response");
  auto options = std::make_shared<PredictionResponseOptions>();
  command->add_option("--commands", options->commands, "CSV with time_s and q1, q2, ... (or dq1, dq2, ...)")
      ->reads()
      ->required();
  command->add_option("--states", options->states, "CSV with time_s and q1, q2, ... as measured, on the same clock")
      ->reads()
      ->required();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      std::string(kTimes) +
      "Example: foresight bench prediction response --commands command.csv --states state.csv --json response.json");
  command->callback([options, &action] { action = [options] { return bench_prediction_response(*options); }; });
}

void add_prediction_robot(Command& prediction, std::function<int()>& action) {
  auto* command = prediction.add_subcommand("robot", "Where a robot will be when set-points act that are on their way");
  auto options = std::make_shared<PredictionRobotOptions>();
  command->add_option("--rig", options->rig, "Rig; its drives are emulated")->reads()->required();
  command->add_option("--delay-ms", options->delay_ms, "Of the line, each way")
      ->check(from_to(0, 1400))
      ->capture_default_str();
  command->add_option("--jitter-ms", options->jitter_ms, "That each message may take more, evenly")
      ->check(from_to(0, 1000))
      ->capture_default_str();
  command->add_option("--loss", options->loss, "Share of messages that is lost")
      ->check(from_to(0, 0.9))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "Of motion that is judged, after 10 in which drives are learnt")
      ->check(from_to(1, 3600))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the motion and the line")->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight bench prediction robot --rig configs/minerva.yaml --json robot.json\n"
      "Exit code: 1 where nothing could be judged.");
  command->callback([options, &action] { action = [options] { return bench_prediction_robot(*options); }; });
}

void add_grasp(Command& prediction, std::function<int()>& action) {
  auto* command = prediction.add_subcommand("grasp", "Things that a hand takes along, over a delayed line");
  auto options = std::make_shared<PredictionGraspOptions>();
  command
      ->add_option("--rig", options->rig,
                   "Rig whose robot is the mock lab's arm (default configs/minerva.yaml); its drives are emulated")
      ->reads();
  command->add_option("--runs", options->runs, "Bricks to grasp, carry and set down")
      ->check(from_to(1, 10'000))
      ->capture_default_str();
  command
      ->add_option("--first-run", options->first_run,
                   "Number of the first: a run is drawn from its number and the seed, and can so be repeated alone")
      ->check(from_to(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--failing", options->failing, "Share of runs in which something goes wrong")
      ->check(from_to(0, 1))
      ->capture_default_str();
  command->add_option("--delay-ms", options->delay_ms, "Of the line, each way")
      ->check(from_to(0, 1400))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of places, masses, frictions, accidents and noise")
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight bench prediction grasp --runs 200 --json grasp.json\n"
      "Exit code: 1 where a grasp that failed was not noticed within the delay and 0.3 s.");
  command->callback([options, &action] { action = [options] { return bench_prediction_grasp(*options); }; });
}

void add_operators(Command& prediction, std::function<int()>& action) {
  auto* command =
      prediction.add_subcommand("operators", "A model operator with the newest image, and with the prediction");
  auto options = std::make_shared<PredictionOperatorsOptions>();
  command
      ->add_option("--rig", options->rig,
                   "Rig whose robot is the mock lab's arm (default configs/minerva.yaml); its drives are emulated")
      ->reads();
  command->add_option("--runs", options->runs, "Bricks to put into a tray, for each row")
      ->check(from_to(1, 10'000))
      ->capture_default_str();
  command->add_option("--delay-ms", options->delays_ms, "Of the line, each way (default 0 100 300 500 1000)")
      ->check(from_to(0, 1400));
  command
      ->add_option("--accident", options->accident,
                   "What happens to the brick: none, slips (out of the hand), moved (by 6 cm); default: each in turn")
      ->check(one_of({"none", "slips", "moved"}));
  command->add_option("--seed", options->seed, "Of places, masses, frictions and noise")
      ->check(from_to(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "A simulation and no more than that: the operator moves, waits for what comes of it, and corrects, as Ferrell\n"
      "(1965) found that people do.\n\n"
      "Example: foresight bench prediction operators --delay-ms 500 --runs 20 --json operators.json");
  command->callback([options, &action] { action = [options] { return bench_prediction_operators(*options); }; });
}

}  // namespace

void add_prediction_benches(Command& bench, std::function<int()>& action) {
  auto* prediction = bench.add_subcommand("prediction", "How well the robot that will be is predicted");
  prediction->require_subcommand();
  add_ik(*prediction, action);
  add_contact(*prediction, action);
  add_prediction_head(*prediction, action);
  add_hand(*prediction, action);
  add_response(*prediction, action);
  add_prediction_robot(*prediction, action);
  add_grasp(*prediction, action);
  add_operators(*prediction, action);
}

}  // namespace foresight
