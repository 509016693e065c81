// `foresight synth` as it is used and misused.
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "scene/ground_truth.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::synth_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class Synth : public testing::Test {
 protected:
  Outcome synth(std::vector<std::string> options) const {
    std::vector<std::string> words{"synth", folder_ / "out", "--frames", "3", "--size", "64x48"};
    words.insert(words.end(), options.begin(), options.end());
    return run_program(words);
  }

  void expect_refused(const Outcome& outcome, int code, const std::string& where, const std::string& what,
                      const std::string& cure) const {
    EXPECT_EQ(outcome.exit_code, code);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.last_line(), AllOf(StartsWith("foresight: "), says(where, what, cure)));
  }

  TempFolder folder_;
};

TEST_F(Synth, EverythingAtOnceIsReadBack) {
  const Outcome outcome =
      synth({"--stereo", "--noise", "2", "--exposure-drift", "0.1", "--vignetting", "0.3", "--motion-blur", "5",
             "--rolling-shutter", "10", "--pose-error-px", "1", "--rate", "15", "--seed", "7"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, (folder_ / "out").string() + "\n");
  EXPECT_THAT(outcome.last_line(), testing::ContainsRegex("[0-9]+ polygons, [0-9]+ to [0-9]+ in view"));
  const RunFolder run = RunFolder::open(folder_ / "out", {});
  ASSERT_EQ(run.frames().size(), 3u);
  const GroundTruth truth = GroundTruth::open(run);
  for (const bool right : {false, true}) EXPECT_TRUE(truth.read(2, right).at(32, 24));
  EXPECT_FALSE(truth.T_world_camera(1, false).isApprox(run.frames()[1].left.T_world_camera, 1e-5));
  EXPECT_EQ(names_in(folder_.path()), std::vector<std::string>{"out"});
}

TEST_F(Synth, OptionsOutOfRangeAreRefused) {
  struct Case {
    std::vector<std::string> options;
    std::string where, what, cure;
  };
  const std::vector<Case> cases = {
      {{"--size", "0x48"}, "--size", "a width of 0", "choose a value"},
      {{"--size", "40000x48"}, "--size", "a width of 40000", "choose a value"},
      {{"--size", "64x40000"}, "--size", "a height of 40000", "choose a value"},
      {{"--size", "-64x48"}, "--size", "-64", "choose a value"},
      {{"--size", "99999999999x48"}, "--size", "not a size", "WIDTHxHEIGHT"},
      {{"--frames", "-1"}, "--frames", "-1", "choose a value"},
      {{"--rate", "0"}, "--rate", "0 is outside", "choose a value"},
      {{"--noise", "-1"}, "--noise", "-1", "choose a value"},
      {{"--vignetting", "1.5"}, "--vignetting", "1.5", "choose a value"},
      {{"--gloss", "2"}, "--gloss", "2 is outside", "choose a value"},
      {{"--exposure-drift", "nan"}, "--exposure-drift", "nan", "give one"},
      {{"--motion-blur", "-3"}, "--motion-blur", "-3", "choose a value"},
      {{"--rolling-shutter", "inf"}, "--rolling-shutter", "inf", "give one"},
      {{"--pose-error-px", "1000"}, "--pose-error-px", "1000", "choose a value"},
      {{"--pose-error-px", "-1"}, "--pose-error-px", "-1", "choose a value"},
      {{"--pose-error-px", "nan"}, "--pose-error-px", "nan", "give one"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(testing::PrintToString(c.options));
    std::vector<std::string> words{"synth", folder_ / "out"};
    words.insert(words.end(), c.options.begin(), c.options.end());
    const Outcome outcome = run_program(words);
    expect_refused(outcome, 2, c.where, c.what, c.cure);
    EXPECT_THAT(outcome.err, testing::Not(HasSubstr("lighting"))) << "nothing has begun";
    EXPECT_TRUE(fs::is_empty(folder_.path()));
  }
}

TEST_F(Synth, HeadPathsThatCannotBeAreRefused) {
  const std::string start = "0 -0.8 0 0.5 0.5 -0.5 0.5 -0.5\n";
  struct Case {
    std::string path, where, what, cure;
  };
  const std::vector<Case> cases = {
      {start + "0.1 -8 0 0.5 0.5 -0.5 0.5 -0.5\n", "head.txt", "has left the lab", "free space"},
      {start + "0.1 -0.8 0 -3 0.5 -0.5 0.5 -0.5\n", "head.txt", "has left the lab", "free space"},
      {"0 0.2 0.3 0.1 0.5 -0.5 0.5 -0.5\n0.1 0.2 0.3 0.1 0.5 -0.5 0.5 -0.5\n", "head.txt", "is inside 'carton'",
       "free space"},
      {start + "0.05 -0.8 0 0.5 0.5 -0.5 0.5 -0.5\n", "head.txt", "ends at 0.050 s", "fewer --frames"},
      {"0.01 -0.8 0 0.5 0.5 -0.5 0.5 -0.5\n", "head.txt", "starts at 0.010 s", "start at 0 s"},
      {start + "0.5 -0.8 0 0.5 0.5 -0.5 0.5 -0.5\n", "head.txt:2", "after the row before", "0.2 s apart"},
      {start + "0.1 -0.8 0 nan 0.5 -0.5 0.5 -0.5\n", "head.txt:2", "nan", ""},
      {start + "0.1 -0.8 0 0.5 0 0 0 0\n", "head.txt:2", "quaternion", "unit quaternion"},
      {start + "0.1 -0.8 0\n", "head.txt:2", "3 fields", ""},
      {"", "head.txt", "holds no row", ""},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.path);
    folder_.write("head.txt", c.path);
    expect_refused(synth({"--head-path", folder_ / "head.txt"}), 2, c.where, c.what, c.cure);
    EXPECT_EQ(names_in(folder_.path()), std::vector<std::string>{"head.txt"});
  }
  expect_refused(synth({"--head-path", folder_ / "nowhere.txt"}), 2, "nowhere.txt", "no such file", "");
}

TEST_F(Synth, FollowsAGivenHeadPath) {
  folder_.write("head.txt", "0 -0.8 0 0.5 0.5 -0.5 0.5 -0.5\n0.1 -0.8 0.2 0.5 0.5 -0.5 0.5 -0.5\n");
  ASSERT_EQ(synth({"--head-path", folder_ / "head.txt"}).exit_code, 0);
  const RunFolder run = RunFolder::open(folder_ / "out", {});
  EXPECT_NEAR(run.frames()[1].left.T_world_camera.translation().y(), 0.2 / 3, 1e-6);
}

// Its first seconds paint and light the lab.
TEST_F(Synth, ASignalEndsItAtOnceWhileTheLabIsMade) {
  Program program({"synth", folder_ / "out"});
  while (program.running() && program.said().find("lighting the lab") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  program.interrupt();
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.last_line(), "foresight: stopped by Ctrl-C") << "it had not begun to write";
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(Synth, RunsOfOthersAreKept) {
  const TestRun recorded;
  expect_refused(run_program({"synth", recorded.path(), "--frames", "1", "--size", "64x48"}), 2, recorded.path(),
                 "holds a run that was not made by this command", "new or empty folder");
  EXPECT_EQ(recorded.read("camera.yaml"), kCamera);
  EXPECT_FALSE(fs::exists(recorded / "truth"));
}

TEST_F(Synth, AnEarlierRunIsReplacedButOnlyByACompleteOne) {
  ASSERT_EQ(synth({}).exit_code, 0);
  EXPECT_EQ(synth({"--rate", "0"}).exit_code, 2);
  EXPECT_TRUE(fs::exists(folder_ / "out/rgb/000002.png"));
  ASSERT_EQ(synth({"--no-truth", "--seed", "2"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/truth"));
  EXPECT_THAT(folder_.read("out/synth.yaml"), HasSubstr("seed: 2"));
}

TEST_F(Synth, AFullDiskLeavesNothing) {
  const fs::path disk = folder_ / "disk";
  fs::create_directory(disk);
  if (::mount("foresight", disk.c_str(), "tmpfs", 0, "size=200k") != 0)
    GTEST_SKIP() << "no right to mount a small disk: " << std::strerror(errno);
  // Too much from the start, and too much only as it turns out.
  const Outcome known = run_program({"synth", disk / "out", "--frames", "320"});
  const Outcome found = run_program({"synth", disk / "out", "--frames", "3", "--size", "64x48"});
  const auto left = names_in(disk);
  ::umount(disk.c_str());
  expect_refused(known, 1, disk / "out", "needs at least", "fewer or smaller images");
  expect_refused(found, 1, disk / "out", "cannot write", "free some disk space");
  EXPECT_TRUE(left.empty());
}

}  // namespace
}  // namespace foresight::synth_test
