#include "scene/run_folder.hpp"

#include "test_run.hpp"

namespace foresight::run_folder_test {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kUnix = 1'700'000'000'000'000'000;
constexpr std::int64_t kMs = 1'000'000;

std::string error(const TestRun& run) {
  return input_error([&] { RunFolder::open(run.path(), {}); });
}

// `file` with `content` in an otherwise good run.
std::string error(const std::string& file, const std::string& content) {
  TestRun run;
  run.write(file, content);
  return error(run);
}

TEST(RunFolder, ReadsAGoodRun) {
  TestRun folder;
  const RunFolder run = RunFolder::open(folder.path(), {});
  EXPECT_EQ(run.root(), folder.path());
  EXPECT_EQ(run.lens_left().width(), 8);
  EXPECT_FALSE(run.lens_right());
  ASSERT_EQ(run.frames().size(), 3u);
  const RunImage& a = run.frames()[0].left;
  EXPECT_EQ(a.time.ns, kUnix + 1);  // exact to the nanosecond
  EXPECT_EQ(a.file, folder / "rgb/a.png");
  EXPECT_EQ(a.stem, "a");
  EXPECT_EQ(a.pose_status, StateStatus::exact);
  EXPECT_EQ(run.frames()[2].left.T_world_camera.translation().x(), 2);
  EXPECT_FALSE(run.frames()[2].right);
  EXPECT_EQ(run.scene()->nodes()[0].name, "scene");
  EXPECT_EQ(run.scene()->triangle_count(), 1u);
  EXPECT_EQ(read_run_image(run.frames()[1].left, run.lens_left()).type(), CV_8UC1);
}

TEST(RunFolder, InterpolatesPosesBetweenSamples) {
  TestRun folder;
  folder.write("rgb.txt", "1700000000.025 rgb/a.png\n");
  const RunFolder run = RunFolder::open(folder.path(), {});
  EXPECT_EQ(run.frames()[0].left.pose_status, StateStatus::interpolated);
  EXPECT_NEAR(run.frames()[0].left.T_world_camera.translation().x(), 0.25, 1e-9);
}

TEST(RunFolder, NamesMissingFiles) {
  for (const char* name : {"camera.yaml", "rgb.txt", "trajectory.txt"}) {
    TestRun run;
    fs::remove(run / name);
    EXPECT_THAT(error(run), says(name, "is missing", "a run folder holds camera.yaml"));
  }
  TestRun run;
  fs::remove(run / "scene.ply");
  EXPECT_THAT(error(run), says("scene.ply", "is missing, and so is scene.yaml", "--scene"));
  fs::remove(run / "rgb/b.png");
  EXPECT_THAT(error(run), says("rgb.txt:3", "b.png is missing", "remove the entry"));
  fs::create_directory(run / "rgb/b.png");
  EXPECT_THAT(error(run), says("rgb.txt:3", "b.png is not a regular file", "name a file"));
}

TEST(RunFolder, RefusesWhatIsNoFolder) {
  TestRun run;
  EXPECT_THAT(input_error([&] { RunFolder::open(run / "camera.yaml", {}); }),
              says("camera.yaml", "is not a folder", "give the folder"));
  EXPECT_THAT(input_error([&] { RunFolder::open(run / "none", {}); }), says("none", "no such folder", "give the path"));
}

TEST(RunFolder, TwoScenesAreOneTooMany) {
  TestRun run;
  run.write("scene.yaml", "nodes:\n  - {name: box, mesh: scene.ply}\n");
  EXPECT_THAT(error(run),
              says(run.path().string(), "scene.ply and scene.yaml", "remove one, or choose one with --scene"));
  const RunFolder chosen = RunFolder::open(run.path(), {.scene = run / "scene.yaml"});
  EXPECT_EQ(chosen.scene()->nodes()[0].name, "box");
}

TEST(RunFolder, TakesASceneFromElsewhere) {
  TestRun run;
  TempFolder other;
  other.write("m.ply", kTriangle);
  const auto scene = other.write("other.yaml", "nodes:\n  - {name: far, mesh: m.ply}\n");
  EXPECT_EQ(RunFolder::open(run.path(), {.scene = scene}).scene()->nodes()[0].name, "far");
  EXPECT_THAT(input_error([&] { RunFolder::open(run.path(), {.scene = other / "none.ply"}); }),
              says("none.ply", "no such file", "correct"));
}

TEST(RunFolder, RefusesPathsThatLeaveIt) {
  TempFolder outside;
  outside.write("x.png", encoded(".png", test_pixels()));
  EXPECT_THAT(error("rgb.txt", "1700000000 " + (outside / "x.png").string() + "\n"),
              says("rgb.txt:1", "is absolute", "relative"));
  EXPECT_THAT(error("rgb.txt", "1700000000 ../" + outside.path().filename().string() + "/x.png\n"),
              says("rgb.txt:1", "leaves", "copy the file"));
  TestRun run;
  fs::create_symlink(outside / "x.png", run / "link.png");
  run.write("rgb.txt", "1700000000 link.png\n");
  EXPECT_THAT(error(run), says("rgb.txt:1", "leaves", "copy the file"));
  fs::create_directory_symlink(outside.path(), run / "folder");
  run.write("rgb.txt", "1700000000 folder/x.png\n");
  EXPECT_THAT(error(run), says("rgb.txt:1", "leaves", "copy the file"));
  fs::create_symlink("rgb/a.png", run / "inner.png");  // links inside are fine
  run.write("rgb.txt", "1700000000 rgb/../inner.png\n");
  EXPECT_EQ(error(run), "no error");
  fs::remove(run / "scene.ply");
  fs::create_symlink(outside / "x.png", run / "scene.ply");
  EXPECT_THAT(error(run), says("scene.ply", "leaves", "copy the file"));
  fs::remove(run / "scene.ply");
  fs::create_symlink("scene.ply", run / "scene.ply");  // to itself
  EXPECT_THAT(error(run), says("scene.ply", "cannot be followed", "correct the path"));
}

TEST(RunFolder, RefusesBadImageLists) {
  EXPECT_THAT(error("rgb.txt", "# none\n"), says("rgb.txt", "holds no row", "at least one line: time file"));
  EXPECT_THAT(error("rgb.txt", "1700000000 rgb/a.png x\n"), says("rgb.txt:1", "has 3 fields", "time file"));
  EXPECT_THAT(error("rgb.txt", "1700000000 rgb/a.png\n1700000000.0 rgb/b.png\n"),
              says("rgb.txt:2", "repeats the time", "remove one"));
  EXPECT_THAT(error("rgb.txt", "1700000000.1 rgb/a.png\n1700000000 rgb/b.png\n"),
              says("rgb.txt:2", "before an earlier row", "sort"));
  EXPECT_THAT(error("rgb.txt", "1700000000000 rgb/a.png\n"),
              says("rgb.txt:1", "time is '1700000000000'", "decimal seconds"));
  EXPECT_THAT(error("rgb.txt", "nan rgb/a.png\n"), says("rgb.txt:1", "time is 'nan'", "decimal seconds"));
  TestRun run;
  run.write("a.jpg", run.read("rgb/c.jpg"));
  run.write("rgb.txt", "1700000000 rgb/a.png\n\n1700000000.1 a.jpg\n");
  EXPECT_THAT(error(run), says("rgb.txt:3", "the image name 'a' is that of line 1", "rename one"));
}

TEST(RunFolder, RefusesBadTrajectories) {
  EXPECT_THAT(error("trajectory.txt", "1700000000 0 0 0 0 0 0 1\n"),
              says("rgb.txt:3", "no pose in trajectory.txt", "remove the line, or add poses"));
  EXPECT_THAT(error("trajectory.txt", "1699999999.85 0 0 0 0 0 0 1\n1700000000.051 0 0 0 0 0 0 1\n"),
              says("rgb.txt:2", "0.051000 s away", "0.2 s apart"));
  const std::string poses = "1.7 0 0 0 0 0 0 1\n1.75 0 0 0 0 0 0 1\n";
  TestRun run;
  run.write("trajectory.txt", poses);
  run.write("rgb.txt", "1700 rgb/a.png\n");
  EXPECT_THAT(error(run), says("rgb.txt:1", "no pose in trajectory.txt", "looks like milliseconds: write seconds"));
  run.write("rgb.txt", "1700000000 rgb/a.png\n");
  EXPECT_THAT(error(run), says("rgb.txt:1", "no pose in trajectory.txt", "looks like nanoseconds: write seconds"));
  run.write("trajectory.txt", "0 0 0 0 0 0 0 1\n0.1 0 0 0 0 0 0 1\n");
  run.write("rgb.txt", "0 rgb/a.png\n0.5 rgb/b.png\n");
  EXPECT_THAT(error(run), says("rgb.txt:2", "0.400000 s away", "remove the line, or add poses")) << "seconds, near 0";
  run.write("rgb.txt", "0.1 rgb/a.png\n0.6 rgb/b.png\n100 rgb/c.jpg\n");
  EXPECT_THAT(error(run), says("rgb.txt:2", "0.500000 s away", "looks like milliseconds")) << "as the last one tells";
  EXPECT_THAT(error("trajectory.txt", "1700000000 0 0 0 0 0 0\n"),
              says("trajectory.txt:1", "has 7 fields", "time tx ty tz qx qy qz qw"));
  EXPECT_THAT(error("trajectory.txt", "1700000000 0 0 0 0 0 0 2\n"),
              says("trajectory.txt:1", "the quaternion has length 2", "unit"));
  EXPECT_THAT(error("trajectory.txt", "1700000000 0 0 nan 0 0 0 1\n"),
              says("trajectory.txt:1", "tz is 'nan'", "correct"));
  EXPECT_THAT(error("trajectory.txt", "2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
              says("trajectory.txt:2", "repeats the time", "remove one"));
  EXPECT_THAT(error("trajectory.txt", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"),
              says("trajectory.txt:2", "before an earlier row", "sort"));
}

TEST(RunFolder, PassesOnTheFaultsOfTheOtherFiles) {
  EXPECT_THAT(error("camera.yaml", kCamera + "T_left_right: {xyz: [0, 0, 0]}\n"),
              says("camera.yaml", "T_left_right", "camera_right.yaml"));
  EXPECT_THAT(error("camera.yaml", kCamera + "focal: 3\n"), says("camera.yaml:7: focal", "unknown key", "known are "));
  EXPECT_THAT(error("scene.ply", "ply\n"), says("scene.ply:2", "without end_header", "export"));
}

class NodeTracks : public testing::Test {
 protected:
  // table (fixed) > cup (tracked) > spoon (moves along)
  NodeTracks() {
    run_.write("mesh.ply", run_.read("scene.ply"));
    fs::remove(run_ / "scene.ply");
    run_.write("scene.yaml",
               "nodes:\n  - {name: table, mesh: mesh.ply, pose: {xyz: [0, 0, 1]}}\n"
               "  - {name: cup, parent: table, mesh: mesh.ply}\n"
               "  - {name: spoon, parent: cup, pose: {xyz: [0, 1, 0]}}\n");
    run_.write("nodes.txt",
               "1700000000.0 cup 1 0 0 0 0 0 1\n1700000000.1 cup 2 0 0 0 0 0 1\n1700000001 cup 5 0 0 0 0 0 1\n");
  }
  SceneState state(double ms) { return RunFolder::open(run_.path(), {}).state_at({kUnix + std::llround(ms * kMs)}); }
  TestRun run_;
};

TEST_F(NodeTracks, AreFollowedByNodesAndTheirDescendants) {
  const SceneState s = state(50);
  ASSERT_EQ(s.T_world_node.size(), 3u);
  EXPECT_EQ(s.T_world_node[0].translation(), Eigen::Vector3d(0, 0, 1));
  EXPECT_TRUE(s.T_world_node[1].translation().isApprox(Eigen::Vector3d(1.5, 0, 0)));
  EXPECT_TRUE(s.T_world_node[2].translation().isApprox(Eigen::Vector3d(1.5, 1, 0)));
  EXPECT_EQ(s.status, StateStatus::interpolated);
  EXPECT_EQ(s.time.ns, kUnix + 50 * kMs);
  EXPECT_EQ(state(0.5).status, StateStatus::exact);
}

TEST_F(NodeTracks, AreHeldOutsideAndInLargeGaps) {
  for (const auto& [ms, x] : std::map<double, double>{{-100, 1}, {400, 2}, {900, 5}, {2000, 5}}) {
    const SceneState s = state(ms);
    EXPECT_EQ(s.status, StateStatus::predicted) << ms;
    EXPECT_EQ(s.T_world_node[1].translation().x(), x) << ms;
    EXPECT_EQ(s.T_world_node[2].translation().x(), x) << ms;
  }
}

TEST_F(NodeTracks, AreAbsentWithoutTheFile) {
  fs::remove(run_ / "nodes.txt");
  const SceneState s = state(400);
  EXPECT_EQ(s.status, StateStatus::exact);
  EXPECT_EQ(s.T_world_node[2].translation(), Eigen::Vector3d(0, 1, 1));
}

TEST_F(NodeTracks, AreCheckedPerNode) {
  run_.write("nodes.txt", "2 cup 1 0 0 0 0 0 1\n1 spoon 2 0 0 0 0 0 1\n");
  EXPECT_EQ(error(run_), "no error");
  run_.write("nodes.txt", "2 cup 1 0 0 0 0 0 1\n1 cup 2 0 0 0 0 0 1\n");
  EXPECT_THAT(error(run_), says("nodes.txt:2", "before an earlier row", "sort"));
  run_.write("nodes.txt", "2 cop 1 0 0 0 0 0 1\n");
  EXPECT_THAT(error(run_), says("nodes.txt:1", "the scene has no node 'cop'", "did you mean 'cup'?"));
  run_.write("nodes.txt", "2 cup 1 0 0 0 0 0 0.5\n");
  EXPECT_THAT(error(run_), says("nodes.txt:1", "the quaternion has length 0.5", "unit"));
}

class Stereo : public testing::Test {
 protected:
  Stereo() {
    // The right camera sits 0.1 m to the right of the left one; the rig is turned by 90 degrees about z.
    run_.write("camera_right.yaml", kCamera + "T_left_right: {xyz: [0.1, 0, 0]}\n");
    run_.write("trajectory.txt",
               "1700000000.0 0 0 0 0 0 0.70710678 0.70710678\n"
               "1700000000.1 1 0 0 0 0 0.70710678 0.70710678\n"
               "1700000000.2 2 0 0 0 0 0.70710678 0.70710678\n");
    for (const char* name : {"p", "q", "r", "s"})
      run_.write("right/" + std::string(name) + ".png", run_.read("rgb/a.png"));
  }
  RunFolder open(const std::string& rgb_right) {
    run_.write("rgb_right.txt", rgb_right);
    return RunFolder::open(run_.path(), {});
  }
  TestRun run_;
};

TEST_F(Stereo, PairsWithTheNearestAndCountsTheRest) {
  const RunFolder run = open(
      "1700000000.004 right/p.png\n1700000000.097 right/q.png\n1700000000.102 right/r.png\n"
      "1700000000.206 right/s.png\n");
  ASSERT_TRUE(run.frames()[0].right && run.frames()[1].right);
  EXPECT_EQ(run.frames()[0].right->stem, "p");
  EXPECT_EQ(run.frames()[1].right->stem, "r");  // nearer than q
  EXPECT_FALSE(run.frames()[2].right);          // s is 6 ms away
  EXPECT_EQ(run.unpaired_right(), 2u);
  EXPECT_TRUE(run.lens_right());
}

TEST_F(Stereo, PosesTheRightImageAtItsOwnTime) {
  const RunFolder run = open("1700000000.104 right/p.png\n");
  const RunImage& right = *run.frames()[1].right;
  EXPECT_EQ(right.pose_status, StateStatus::interpolated);
  // 0.04 m further along the path; the rig's x axis points along the world's y.
  EXPECT_TRUE(right.T_world_camera.translation().isApprox(Eigen::Vector3d(1.04, 0.1, 0), 1e-6))
      << right.T_world_camera.translation();
  EXPECT_EQ(run.T_left_right().translation(), Eigen::Vector3d(0.1, 0, 0));
}

TEST_F(Stereo, PairsWithinHalfAnIntervalOfFastCameras) {
  run_.write("rgb.txt", "1700000000.000 rgb/a.png\n1700000000.004 rgb/b.png\n1700000000.008 rgb/c.jpg\n");
  const RunFolder run = open("1700000000.0061 right/p.png\n1700000000.0101 right/q.png\n");
  EXPECT_FALSE(run.frames()[1].right);
  EXPECT_EQ(run.frames()[2].right->stem, "p");
  EXPECT_EQ(run.unpaired_right(), 1u);
}

TEST_F(Stereo, NeedsBothFilesAndThePlace) {
  EXPECT_THAT(error(run_), says("rgb_right.txt", "is missing", "a run folder holds"));
  run_.write("rgb_right.txt", "1700000000 right/p.png\n");
  run_.write("camera_right.yaml", kCamera);
  EXPECT_THAT(error(run_), says("camera_right.yaml: T_left_right", "is missing", "add T_left_right"));
  fs::remove(run_ / "camera_right.yaml");
  EXPECT_THAT(error(run_), says("camera_right.yaml", "is missing", "a run folder holds"));
}

}  // namespace
}  // namespace foresight::run_folder_test
