// Subcommands, help, and what is said about a wrong one.
#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::command_line_test {
namespace {

using testing::HasSubstr;

TEST(CommandLine, HelpIsNoError) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"replay", "--help"}, {"export", "--help"}, {"synth", "--help"}}) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("Usage"));
    EXPECT_EQ(outcome.err, "");
  }
  const std::string help = run_program({"replay", "--help"}).out;
  for (const char* option :
       {"--scene", "--delay-frames", "--delay-ms", "--texels-per-metre", "--max-texture", "--texture-memory-mb",
        "--margin-px", "--out", "--report", "--html", "--window", "--real-time"})
    EXPECT_THAT(help, HasSubstr(option));
}

TEST(CommandLine, VersionIsANumber) {
  const Outcome outcome = run_program({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, testing::ContainsRegex("^[0-9]+\\.[0-9]+\\.[0-9]+"));
}

TEST(CommandLine, WrongWordsEndWithCode2AndTheWayToTheHelp) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> all = {
      {{}, "subcommand"},
      {{"replya"}, "did you mean 'replay'?"},
      {{"--frobnicate"}, "subcommand"},
      {{"replay"}, "RUN is required"},
      {{"export", "x"}, "--out is required"},
      {{"synth"}, "OUT is required"},
      {{"synth", "x", "--frobnicate"}, "--frobnicate"},
      {{"bench", "prediction", "grasp", "--seed", "-1"}, "--seed: '-1' is not a whole number from 0 on; give one"},
      {{"bench", "prediction", "grasp", "--runs", "1.5"}, "--runs: '1.5' is not a whole number; give one"},
      {{"synth", "x", "--frames", "99999999999"}, "--frames: '99999999999' is too large; give at most 2147483647"},
      {{"replay", "x", "y"}, "y"},
      {{"link", "raet"}, "did you mean 'rate'? See `foresight link --help`"},
      {{"link", "frobnicate"}, "there is no subcommand 'frobnicate'; see `foresight link --help`"},
      {{"link", "status", "--frobnicate"}, "see `foresight link status --help`"},
  };
  for (const auto& [arguments, what] : all) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.last_line(),
                testing::AllOf(testing::StartsWith("foresight: "), HasSubstr(what), HasSubstr("--help`")));
  }
}

TEST(CommandLine, SynthRefusesWhatItCannotWrite) {
  const TempFolder folder;
  folder.write("mine/diary.txt", "kept");
  const std::string out = folder / "out", mine = folder / "mine";
  const std::vector<std::pair<std::vector<std::string>, std::string>> all = {
      {{"synth", out, "--size", "0x0"}, "choose a value"},
      {{"synth", out, "--size", "64"}, "write it as WIDTHxHEIGHT"},
      {{"synth", out, "--frames", "0"}, "choose a value"},
      {{"synth", out, "--frames", "x"}, "--frames"},
      {{"synth", mine}, "choose a new or empty folder"},
      {{"synth", mine + "/diary.txt"}, "give another place"},
      {{"synth", "/proc/foresight"}, "give another place"},
  };
  for (const auto& [arguments, what] : all) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.last_line(), testing::AllOf(testing::StartsWith("foresight: "), HasSubstr(what)));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  }
  EXPECT_EQ(folder.read("mine/diary.txt"), "kept");
}

TEST(CommandLine, WhatAPictureHidesStandsBetweenCommasOrBlanks) {
  const TempFolder folder;
  const std::string rig = source_folder() / "configs/minerva.yaml", out = folder / "rig.png";
  for (const std::vector<std::string>& hidden :
       {std::vector<std::string>{"guards,names"}, {"guards", "names"}, {"guards,nmaes"}}) {
    std::vector<std::string> arguments{"rig", "view", rig, "--out", out, "--hide"};
    arguments.insert(arguments.end(), hidden.begin(), hidden.end());
    const Outcome outcome = run_program(arguments);
    if (hidden.front() == "guards,nmaes")
      EXPECT_THAT(outcome.last_line(), HasSubstr("'nmaes' is nothing that a picture shows; did you mean 'names'"));
    else
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
}

TEST(CommandLine, SynthStoppedByCtrlCLeavesNothing) {
  const TempFolder folder;
  Program program({"synth", folder / "out", "--frames", "10000", "--size", "64x48"});
  const auto begun = [&folder] {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().string().find(".partial-") != std::string::npos) return true;
    return false;
  };
  while (program.running() && !begun()) usleep(1000);
  usleep(200'000);
  program.interrupt();
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.last_line(), HasSubstr("stopped by Ctrl-C"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace foresight::command_line_test
