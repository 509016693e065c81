// `foresight record --line`, `play` and `export-run`, in a network of the test's own.
#include <fstream>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::line_recording_test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class LineRecording : public PrivateNetworkTest {
 protected:
  static std::string rig() { return (source_folder() / "configs" / "minerva.yaml").string(); }

  TempFolder folder_;
  std::string file_ = (folder_ / "line.mcap").string();
};

// A robot is recorded, which then has to go before it can be played; who listens cannot tell the two apart.
TEST_F(LineRecording, IsPlayedAsIfItWereTheRobotButNotBesideOne) {
  Program robot({"robot", rig(), "--mock", "--no-cameras", "--serve"});
  const Outcome listened = run_program({"link", "listen", "foresight/robot_state", "--count", "1"});
  EXPECT_EQ(listened.exit_code, 0) << listened.err;
  const Outcome recorded = run_program({"record", "--line", file_, "--rig", rig(), "--mock", "--seconds", "4"});
  EXPECT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_THAT(recorded.err,
              HasSubstr("record: /foresight/robot_state (foresight_msgs/msg/RobotState) of robot minerva"));
  EXPECT_THAT(recorded.err, HasSubstr("record: /tf_static (tf2_msgs/msg/TFMessage) of robot minerva"));
  EXPECT_EQ(recorded.out, file_ + "\n");
  const Outcome beside = run_program({"play", file_});
  EXPECT_EQ(beside.exit_code, 2);
  EXPECT_THAT(beside.err, HasSubstr("cannot be played beside 'robot minerva'"));
  const Outcome again = run_program({"record", "--line", file_, "--seconds", "1"});
  EXPECT_EQ(again.exit_code, 2) << "a recording is never written over";

  Program played({"play", file_, "--domain", "3"});
  const Outcome state = run_program({"link", "listen", "foresight/robot_state", "--count", "2", "--domain", "3"});
  EXPECT_EQ(state.exit_code, 0) << state.err;
  EXPECT_THAT(state.out, HasSubstr("rig: 'minerva'\nphase:\n  label: 'disabled'"));
  const Outcome end = played.wait();
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_THAT(end.err, HasSubstr("/foresight/control/robot/messages"));
  EXPECT_THAT(end.err, HasSubstr("not played"));

  const Outcome exported = run_program({"export-run", file_, "--out", (folder_ / "run").string()});
  EXPECT_EQ(exported.exit_code, 2);
  EXPECT_THAT(exported.err, HasSubstr("has no pair of images that can be used"));
  robot.interrupt();
  robot.wait();
}

TEST_F(LineRecording, WhatCannotBeIsRefused) {
  const Outcome silent = run_program({"record", "--line", file_, "--domain", "9", "--seconds", "0.3"});
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.err, HasSubstr("nothing came; see `foresight link status`"));
  const Outcome empty = run_program({"play", file_, "--domain", "9"});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("has nothing that a robot says"));
  fs::resize_file(file_, fs::file_size(file_) - 3);
  const Outcome cut = run_program({"play", file_, "--domain", "9"});
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_THAT(cut.err, HasSubstr("the file ends"));
  const auto refused = [](const std::vector<std::string>& arguments, const char* words) {
    const Outcome out = run_program(arguments);
    EXPECT_EQ(out.exit_code, 2) << arguments[0];
    EXPECT_THAT(out.err, HasSubstr(words));
  };
  refused({"play", rig()}, "is no MCAP");
  refused({"export-run", rig(), "--out", (folder_ / "run").string()}, "is no MCAP");
  refused({"record", "--line", (folder_ / "b.mcap").string(), (folder_ / "run").string()}, "OUT: stands beside --line");
  refused({"record"}, "OUT: is missing");
}

// A disk that is full from some size on: a word, exit code 1, and what came before opens.
TEST_F(LineRecording, AFullDiskIsToldAndWhatCameBeforeIsKept) {
  Program robot({"robot", rig(), "--mock", "--no-cameras", "--serve"});
  ProgramOptions options;
  options.shell = "ulimit -f 60";  // blocks of 512 bytes
  const Outcome full = run_program({"record", "--line", file_, "--seconds", "60"}, options);
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.last_line(), HasSubstr("line.mcap (File too large)"));
  EXPECT_THAT(full.last_line(), HasSubstr("; what came before is in " + file_));
  robot.interrupt();
  robot.wait();
  const Outcome played = run_program({"play", file_, "--rate", "10"});
  EXPECT_EQ(played.exit_code, 0) << played.err;
}

}  // namespace
}  // namespace foresight::line_recording_test
