#include "scene/run_writer.hpp"

#include "scene/run_folder.hpp"
#include "scene/scene_reader.hpp"
#include "scene/scene_writer.hpp"
#include "test_run.hpp"

namespace foresight::run_writer_test {
namespace {

/// One of each model, with numbers that need all their digits.
std::vector<Lens> every_lens() {
  Lens::Parameters p{LensModel::plumb_bob, 8, 6, 10.0 / 3, 11.1, 3.7, 2.3, {}};
  std::vector<Lens> out;
  p.d = {-0.1 / 3, 0.012, 0.0003, -0.0004, 1e-17};
  out.emplace_back(p);
  p.d = {-0.28, 0.09, 0.0006, -0.0005, 0.1 / 7, 0.2 / 3, -0.013, 1.0 / 3};
  p.model = LensModel::rational_polynomial;
  out.emplace_back(p);
  p.d = {-0.012, 0.003, -0.0006, 1.0 / 7};
  p.model = LensModel::equidistant;
  out.emplace_back(p);
  return out;
}

void expect_same(const Lens& a, const Lens& b) {
  const auto &p = a.parameters(), &q = b.parameters();
  EXPECT_EQ(p.model, q.model);
  EXPECT_EQ(std::tie(p.width, p.height, p.fx, p.fy, p.cx, p.cy), std::tie(q.width, q.height, q.fx, q.fy, q.cx, q.cy));
  EXPECT_EQ(p.d, q.d) << to_string(p.model);
}

Pose some_pose(double x) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(x, -1.0 / 3, 1e-7));
  pose.rotate(Eigen::AngleAxisd(0.1 + x, Eigen::Vector3d(1, 2, 3).normalized()));
  return pose;
}

TEST(CameraInfoText, GivesEveryLensBack) {
  const TempFolder folder;
  for (const Lens& lens : every_lens()) {
    expect_same(read_camera_info(folder.write("left.yaml", camera_info_text({lens, {}}, "left"))).lens, lens);
    const CameraInfo right = read_camera_info(folder.write("r.yaml", camera_info_text({lens, some_pose(0.065)}, "r")));
    expect_same(right.lens, lens);
    EXPECT_TRUE(right.T_left_right.value().isApprox(some_pose(0.065), 1e-11));
  }
}

TEST(RunWriter, WritesWhatRunFolderReads) {
  const auto lenses = every_lens();
  for (std::size_t k = 0; k < lenses.size(); ++k) {
    const TempFolder folder;
    const Lens &left = lenses[k], &right = lenses[(k + 1) % lenses.size()];
    RunWriter run(folder.path(), left, "left");
    run.add_right_camera(right, some_pose(0.065), "right");
    Mesh triangle;
    triangle.vertices = {{0.1F, 0, 1}, {1, 1.0F / 3, 1}, {0, 1, 1}};
    triangle.triangles = {{0, 1, 2}};
    const SceneModel scene({{"o'table", triangle, -1, some_pose(1)}, {"ball", triangle, 0, some_pose(2)}}, 0.007);
    write_model(folder.path(), scene);
    const std::vector<RobotTime> times{RobotTime{1}, RobotTime{33'000'000}, RobotTime{1'700'000'000'123'456'789}};
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto x = static_cast<double>(i);
      for (const bool eye : {false, true}) {
        const std::string name = RunWriter::image_name(eye, i);
        run.write_image(name, test_pixels());
        run.add_image(eye, times[i], name);
      }
      run.add_pose(times[i], some_pose(x));
      run.add_node(times[i], "ball", some_pose(-x));
      run.add_registration(times[i], "tags", 0.25 * x);
    }
    run.flush();

    const RunFolder read = RunFolder::open(folder.path(), {});
    expect_same(read.lens_left(), left);
    expect_same(read.lens_right().value(), right);
    EXPECT_TRUE(read.T_left_right().isApprox(some_pose(0.065), 1e-11));
    ASSERT_EQ(read.frames().size(), times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      const RunFrame& frame = read.frames()[i];
      const auto x = static_cast<double>(i);
      EXPECT_EQ(frame.left.time, times[i]) << "to the nanosecond";
      EXPECT_EQ(frame.right.value().time, times[i]);
      EXPECT_TRUE(frame.left.T_world_camera.isApprox(some_pose(x), 1e-11));
      EXPECT_EQ(frame.left.predicted_px, 0.25 * x);
      EXPECT_TRUE(read.state_at(times[i]).T_world_node[1].isApprox(some_pose(-x), 1e-11));
      EXPECT_EQ(cv::norm(read_run_image(frame.left, read.lens_left()), test_pixels(), cv::NORM_INF), 0);
    }
    EXPECT_EQ(read.scene()->accuracy(), 0.007);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read.scene()->nodes()[i].name, scene.nodes()[i].name);
      EXPECT_TRUE(read.scene()->nodes()[i].mesh.vertices == triangle.vertices) << "every float comes back";
      EXPECT_TRUE(read.scene()->rest_poses()[i].isApprox(scene.rest_poses()[i], 1e-11));
    }
  }
}

TEST(RunWriter, WritesNoFileForWhatIsNotThere) {
  const TempFolder folder;
  RunWriter run(folder.path(), every_lens()[0], "left");
  run.add_image(false, RobotTime{-1'500'000'000}, "rgb/a.png");
  run.flush();
  EXPECT_EQ(folder.read("rgb.txt"), "# time[s] file\n-1.500000000 rgb/a.png\n");
  for (const char* name : {"trajectory.txt", "nodes.txt", "registration.txt", "rgb_right.txt", "without_pose.txt"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
}

TEST(RunWriter, SaysWhereItCannotWrite) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TempFolder folder;
  RunWriter run(folder.path(), every_lens()[0], "left");
  std::filesystem::create_symlink("/dev/full", folder / "trajectory.txt");
  run.add_pose(RobotTime{}, Pose::Identity());
  try {
    run.flush();
    FAIL();
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(), testing::AllOf(testing::HasSubstr("trajectory.txt"), testing::HasSubstr("No space")));
  }
}

}  // namespace
}  // namespace foresight::run_writer_test
